"""Variants of the study of communication: cost of a limited link for a fleet with common knowledge.

All lines but those of the relay begin or end at the ideal link. Without a limit, losses or latency
a disk is the ideal link, owner for owner, so that those points are not played a second time.
"""

from collections.abc import Sequence
from dataclasses import replace

from mjforage.runs.studies.axes import OWN, along, axes_of
from mjforage.runs.studies.study import Variant
from mjforage.runs.studies.variants import COMPLETE
from mjforage.scenario.link import Link
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Scenario

IDEAL = "ideal link"

RELAY = "relay-boat"
LOW_M = 0.25  # antennas
RELAY_BOAT = Role(
    count=1, moves=1, radius=0.0, collects=False, energy=0.5, relays=False, antenna_m=LOW_M
)
"""Relay that sees its own node alone and lacks the energy of one move: it stays at its start."""


AXES = axes_of("communication")
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
