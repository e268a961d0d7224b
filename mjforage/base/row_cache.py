"""Cache of rows of a table too large to be computed whole: the latest rows stay."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel

MEMORY = 1 << 27  # bytes of rows
FEWEST_ROWS = 64


def rows_worth_keeping(nodes: int, value_bytes: int) -> int:
    """Number of rows to cache, each of so many nodes with values of so many bytes."""
    return min(nodes, max(FEWEST_ROWS, MEMORY // (value_bytes * nodes)))


class RowCache(NamedTuple):
    """Cache of a table's rows by node. The oldest row makes room."""

    slot: NDArray[np.int32]  # (node,) its row, -1 none now
    owner: NDArray[np.int32]  # (row,) the node whose row it is, -1 free
    following: NDArray[np.int64]  # (1,) row to be filled next

    @classmethod
    def of(cls, nodes: int, rows: int) -> "RowCache":
        """Empty cache of a table with so many rows."""
        return cls(
            slot=np.full(nodes, -1, np.int32),
            owner=np.full(rows, -1, np.int32),
            following=np.zeros(1, np.int64),
        )


@kernel
def row_of(cache: RowCache, node: int) -> tuple[int, bool]:
    """Row of a node, and True if it must be filled first. The next request may overwrite it."""
    slot, owner, following = cache.slot, cache.owner, cache.following
    if slot[node] >= 0:
        return int(slot[node]), False
    row = following[0]
    following[0] = (row + 1) % owner.size
    if owner[row] >= 0:
        slot[owner[row]] = -1
    owner[row], slot[node] = node, row
    return int(row), True
