"""docs/published-rules.md."""

from collections.abc import Iterator
from itertools import pairwise

from tests.evidence.piece import Column, Piece, Row, gap, mean
from tests.evidence.pieces.results import COOPERATION, PRIMARY
from tests.evidence.playing import Runs

WALLS = {
    walls: "mjforage evaluate published --policy greedy --policy levy --policy wanderer"
    f" --episodes 1000 --set rules.walls={walls}"
    for walls in ("clip", "project", "published")
}
_KEYS = PRIMARY | COOPERATION


def _walls(runs: Runs) -> Iterator[Row]:
    """Each policy by `clip`, then what each rule changes beside the one before it."""
    order = list(WALLS)
    for policy in ("greedy", "levy", "wanderer"):
        found = {walls: {key: runs[walls].values(policy, key) for key in _KEYS} for walls in order}
        yield [policy, order[0], *(mean(values) for values in found[order[0]].values())]
        for before, after in pairwise(order):
            gaps = (gap(found[after][key], found[before][key]) for key in _KEYS)
            yield ["", f"{after} − {before}", *gaps]


PIECES = (
    Piece(
        "walls",
        WALLS,
        (Column("policy"), Column("`rules.walls`"), *_KEYS.values()),
        _walls,
    ),
)
