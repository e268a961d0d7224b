"""docs/sensing.md."""

from collections.abc import Iterator

from tests.evidence.piece import Cell, Column, Piece, Row, average, beside, mean
from tests.evidence.pieces import communication
from tests.evidence.playing import Runs

_BOTH = "mjforage evaluate comb-port --policy greedy --policy belief --episodes 100 --seed 7"
_BELIEF = "mjforage evaluate comb-port --policy belief --episodes 100 --seed 7"


def _seen(**keys: float | str) -> str:
    return "".join(f" --set sensors.{key}={value}" for key, value in keys.items())


def _told(**keys: float) -> str:
    return "".join(f" --set prior.{key}={value}" for key, value in keys.items())


_FILTERED = " --set 'sensors.map=\"filtered\"'"
_NEAR = {"half_range_node": 2, "slope_node": 0.5}
_SETTINGS = {
    **{f"*p* .{p}": _seen(detection=p / 10) + _told(detection=p / 10) for p in (9, 7, 5, 3)},
    "*p* .7, persistence .3": _seen(detection=0.7, persistence=0.3) + _told(detection=0.7),
    "half at 2 nodes, slope .5": _seen(**_NEAR) + _told(**_NEAR),
    "ghosts .002": _seen(false_rate=0.002) + _told(false_rate=0.002),
    "ghosts .002, for 20 decisions": _seen(false_rate=0.002, false_hold=20)
    + _told(false_rate=0.002),
    "120°": _seen(fov_deg=120),
    "*p* .5, filtered map": _seen(detection=0.5) + _FILTERED + _told(detection=0.5),
}
_MISTAKEN = {
    "*p* .7, taken for 1": _seen(detection=0.7),
    "*p* .5, taken for 1": _seen(detection=0.5),
    "*p* .5, filtered map, taken for 1": _seen(detection=0.5) + _FILTERED,
    "*p* .5, taken for .9": _seen(detection=0.5) + _told(detection=0.9),
    "*p* .9, taken for .5": _seen(detection=0.9) + _told(detection=0.5),
    "ghosts .002, taken for none": _seen(false_rate=0.002),
}
EYES = {
    **{name: _BOTH + flags for name, flags in _SETTINGS.items()},
    **{name: _BELIEF + flags for name, flags in _MISTAKEN.items()},
}
RADIO = "mjforage evaluate comb-port-radio --policy belief --policy greedy --episodes 100 --seed 7"
RADIO_HULLS = (
    "mjforage evaluate comb-port-radio --world physics --policy belief --policy greedy"
    " --episodes 50 --seed 7"
)


def _eyes(runs: Runs) -> Iterator[Row]:
    perfect = runs["perfect"]
    first: list[Cell] = ["perfect"]
    for policy in ("greedy", "belief"):
        first += [average(perfect.values(policy, key)) for key in ("pta_c", "nt90")]
    yield [*first, average(perfect.values("belief", "brier_skill")), None]
    for name in EYES:
        row: list[Cell] = [name]
        for policy in ("greedy", "belief"):
            for key in ("pta_c", "nt90"):
                if policy == "greedy" and name in _MISTAKEN:
                    row.append(None)
                else:
                    found = runs[name].values(policy, key)
                    row.append(beside(found, perfect.values(policy, key)))
        keys = ("brier_skill", "calibration_error")
        yield [*row, *(average(runs[name].values("belief", key)) for key in keys)]


def _radio(runs: Runs) -> Iterator[Row]:
    for policy, name in (("belief", "`belief`"), ("greedy", "Greedy")):
        for run, words in (("graph", "graph, 100 episodes"), ("hulls", "MuJoCo, 50 episodes")):
            keys = ("pta_c", "nt50", "nt90", "handover")
            yield [f"{name}, {words}", *(mean(runs[run].values(policy, key)) for key in keys)]


PIECES = (
    Piece(
        "eyes",
        {"perfect": communication.LINKS["ideal"], **EYES},
        (
            *(Column("eyes"), Column("Greedy: PTA_C [%]", 2), Column("NT90", 3)),
            *(Column("`belief`: PTA_C [%]", 2), Column("NT90", 3)),
            *(Column("Brier skill", 2), Column("calibration error", 4)),
        ),
        _eyes,
    ),
    Piece(
        "comb-port-radio",
        {"graph": RADIO, "hulls": RADIO_HULLS},
        (
            *(Column("`comb-port-radio`"), Column("PTA_C [%]", 2)),
            *(Column("NT50", 3), Column("NT90", 3), Column("handover", 3)),
        ),
        _radio,
    ),
)
