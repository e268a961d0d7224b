"""docs/communication.md."""

from collections.abc import Iterator

from mjforage.runs.variants import without
from tests.evidence.piece import Cell, Column, Piece, Row, average, beside, gap
from tests.evidence.playing import Runs

POLICIES = {"greedy": "Greedy", "levy": "Lévy", "ddqn": "`ddqn`", "belief": "`belief`"}
_BASE = (
    "mjforage evaluate comb-port --policy greedy --policy levy --policy ddqn --policy belief"
    " --episodes 100 --seed 7"
)
HEARD = "oracle(heard=true)"


def _disk(**keys: float) -> str:
    return "".join(f" --set link.{key}={value:g}" for key, value in keys.items())


SETTINGS = {
    "ideal": "",
    "32 nodes (128 m), quays block": _disk(range_m=128, wall_db=1),
    "16 nodes": _disk(range_m=64),
    "16 nodes, quays block": _disk(range_m=64, wall_db=1),
    "8 nodes": _disk(range_m=32),
    "8 nodes, quays block": _disk(range_m=32, wall_db=1),
    "4 nodes": _disk(range_m=16),
    "none": "",
    "latency 1 (disk without an end)": _disk(latency=1),
    "latency 3": _disk(latency=3),
    "latency 10": _disk(latency=10),
    "loss 0.9": _disk(loss=0.9),
    "51 bytes": _disk(bytes=51),
    "16 nodes, quays block, latency 1, loss 0.3, 51 bytes": _disk(
        range_m=64, wall_db=1, latency=1, loss=0.3, bytes=51
    ),
}
_MODELS = {"ideal": "", "none": " --set link.model=none"}


def over(base: str, link: str) -> str:
    """A command over one of the links of `SETTINGS`."""
    return base + _MODELS.get(link, " --set link.model=disk") + SETTINGS[link]


LINKS = {link: over(_BASE, link) for link in SETTINGS}

_BOUND = f'mjforage evaluate comb-port --policy "{HEARD}" --episodes 100 --seed 7'
BOUNDED = (
    "16 nodes, quays block",
    "4 nodes",
    "none",
    "16 nodes, quays block, latency 1, loss 0.3, 51 bytes",
)

_ALONE = "--policy belief --episodes 100 --seed 1"
TOUCH = {
    "16 nodes, quays block": f"mjforage evaluate comb-port {_ALONE} --set link.model=disk"
    " --set link.range_m=64 --set link.wall_db=30",
    "4 nodes": f"mjforage evaluate comb-port {_ALONE} --set link.model=disk --set link.range_m=16",
    "none": f"mjforage evaluate comb-port {_ALONE} --set link.model=none",
    "`comb-port-radio`": f"mjforage evaluate comb-port-radio {_ALONE}",
}
PARTS = {"report": ("pta_c", "nt90", "handover"), "alone": ("pta_c", "nt90")}
_HEADS = {"pta_c": Column("PTA_C", 2), "nt90": Column("NT90", 3), "handover": Column("handover", 3)}


def _links(runs: Runs) -> Iterator[Row]:
    for link in LINKS:
        row: list[Cell] = [link]
        for policy in POLICIES:
            found, ideal = (runs[name].values(policy, "pta_c") for name in (link, "ideal"))
            row.append(average(found) if link == "ideal" else beside(found, ideal))
            row.append(average(runs[link].values(policy, "nt90")))
        yield row


def _bound(runs: Runs) -> Iterator[Row]:
    for link in BOUNDED:
        keys = ("pta_c", "nt90")
        told = [runs[f"{link}, told"].values(HEARD, key) for key in keys]
        own = [runs[link].values("belief", key) for key in keys]
        yield [link, *map(beside, told, own)]


def _touch(runs: Runs) -> Iterator[Row]:
    for link in TOUCH:
        row: list[Cell] = [link, average(runs[link].values("belief", "pta_c"))]
        for part, keys in PARTS.items():
            for key in keys:
                lesser = runs[f"{link}, without {part}"].values(without(part), key)
                row.append(gap(lesser, runs[link].values("belief", key)))
        yield row


PIECES = (
    Piece(
        "links",
        LINKS,
        (
            Column("link"),
            *(
                column
                for name in POLICIES.values()
                for column in (Column(f"{name}: PTA_C", 2), Column("NT90", 3))
            ),
        ),
        _links,
    ),
    Piece(
        "links-bound",
        {f"{link}, told": over(_BOUND, link) for link in BOUNDED}
        | {link: LINKS[link] for link in BOUNDED},
        (Column("link"), Column("bound: PTA_C", 2), Column("NT90", 3)),
        _bound,
    ),
    Piece(
        "in-touch",
        {
            f"{link}{name}": command + flag
            for link, command in TOUCH.items()
            for name, flag in (
                ("", ""),
                *((f", without {part}", f" --set policy.belief.{part}=false") for part in PARTS),
            )
        },
        (
            Column("link"),
            Column("whole: PTA_C", 2),
            *(
                Column(f"without `{part}`: PTA_C" if key == "pta_c" else head, digits)
                for part, keys in PARTS.items()
                for key in keys
                for head, digits, _ in [_HEADS[key]]
            ),
        ),
        _touch,
    ),
)
