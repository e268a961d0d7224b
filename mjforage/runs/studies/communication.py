"""Variants of the study of communication: cost of a limited link for a fleet with common knowledge.

All lines but those of the relay begin or end at the ideal link. Without a limit, losses or latency
a disk is the ideal link, owner for owner, so that those points are not played a second time.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from mjforage.runs.studies.axes import OWN, Axis, Point, along
from mjforage.runs.studies.study import Variant
from mjforage.runs.studies.variants import COMPLETE
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Link, Scenario

RANGES_M = (16.0, 32.0, 64.0, 128.0)
QUAYS = "quays block"
PLAIN = ""  # name of an axis' only line
IDEAL = "ideal link"

RELAY = "relay-boat"
RELAY_RADIO = {"model": "two-ray", "tx_dbm": 0.0, "relay": False}
"""1 mW at 2.4 GHz: vessels with antennas a quarter of a metre above the water are in contact over
some 36 m; with one on a mast of five metres, over some 160 m, most of `comb-port`."""
LOW_M, MAST_M = 0.25, 5.0
RELAY_BOAT = Role(
    count=1, moves=1, radius=0.0, collects=False, energy=0.5, relays=False, antenna_m=LOW_M
)
"""Relay that sees its own node alone and lacks the energy of one move: it stays at its start."""


def _disk(value: float, name: str, title: str, **keys: object) -> Point:
    return Point(value, name, title, {"link": {"model": "disk", **keys}})


def _ranges(end: str, words: str, **keys: object) -> tuple[Point, ...]:
    return tuple(
        _disk(r, f"range-{r:g}{end}", f"{r:g} m{words}", range_m=r, **keys) for r in RANGES_M
    )


def _losses(burst: int) -> tuple[Point, ...]:
    end, words = (f"-burst-{burst}", f" in bursts of {burst}") if burst > 1 else ("", "")
    return (
        Point(0.0),
        *(
            _disk(
                loss, f"loss-{loss:g}{end}", f"loss {loss:g}{words}", loss=loss, burst=float(burst)
            )
            for loss in (0.3, 0.6, 0.9)
        ),
    )


def _relay(value: float, name: str, title: str, **keys: object) -> Point:
    """A point with the radio of the relays; `keys` are of the relay boat, or of the link."""
    link = {key: keys.pop(key) for key in ("relay",) if key in keys}
    return Point(value, f"relay-{name}", title, {"link": RELAY_RADIO | link, "team": {RELAY: keys}})


AXES = (
    Axis(
        "range",
        "range  [m]",
        "Range of a disk",
        {
            "no walls": (
                Point(0.0, "none", "no link", {"link": {"model": "none"}}),
                *_ranges("", ""),
                Point(inf),
            ),
            QUAYS: (
                Point(0.0, "none", "no link", {"link": {"model": "none"}}),
                *_ranges("-quays", f", {QUAYS}", wall_db=1.0),
                _disk(inf, "range-inf-quays", f"any distance, {QUAYS}", wall_db=1.0),
            ),
        },
        {0.0: "none", inf: "any"},
    ),
    Axis(
        "latency",
        "latency  [decisions]",
        "Latency",
        {
            PLAIN: (
                Point(0.0),
                *(_disk(n, f"latency-{n}", f"latency {n}", latency=n) for n in (1, 3, 10)),
            )
        },
    ),
    Axis(
        "loss",
        "loss",
        "Losses",
        {"independent": _losses(1), "bursts of 10": _losses(10)},
        even=False,
    ),
    Axis(
        "bytes",
        "budget  [B/decision]",
        "Budget of every sender",
        {
            PLAIN: (
                *(_disk(n, f"bytes-{n}", f"{n} bytes", bytes=n) for n in (12, 20, 32, 51)),
                Point(inf),
            )
        },
        {inf: "any"},
    ),
    Axis(
        "relay",
        "who passes on",
        "A relay, over a radio of 1 mW",
        {
            PLAIN: (
                _relay(0.0, "nobody", "nobody passes on"),
                _relay(1.0, "low", "a boat at the start does", relays=True),
                _relay(2.0, "mast", "it has a mast", relays=True, antenna_m=MAST_M),
                _relay(3.0, "all", "all pass on, no mast", relay=True),
            )
        },
        {0.0: "none", 1.0: "boat", 2.0: "mast", 3.0: "all"},
        against="relay-nobody",
    ),
)
"""Axes of the study; every point replaces the scenario's own link."""


def ideal(scenario: Scenario) -> Scenario:
    """The scenario with one mind; roles that relay have nothing to relay."""
    team = {name: replace(role, relays=False) for name, role in scenario.team.items()}
    return replace(scenario, link=Link(), team=team)


def _with_relay(scenario: Scenario) -> Scenario:
    """The scenario with low antennas, and a vessel that stays at a start."""
    team = {name: replace(role, antenna_m=LOW_M) for name, role in scenario.team.items()}
    order = scenario.rules.order
    rules = replace(scenario.rules, order=(*order, RELAY) if order else ())
    return replace(scenario, rules=rules, team=team | {RELAY: RELAY_BOAT})


def communication(scenario: Scenario, policies: Sequence[str]) -> tuple[Variant, ...]:
    """The ideal link, every point of the axes, and the scenario's own link if that is another."""
    base = ideal(scenario)
    variants = [Variant(COMPLETE, IDEAL, base, tuple(policies))]
    for axis in AXES:
        variants += along([axis], _with_relay(base) if axis.name == "relay" else base, policies)
    if scenario.link.model != "ideal":
        variants.append(Variant(OWN, "the scenario's own link", scenario, tuple(policies)))
    return tuple(variants)
