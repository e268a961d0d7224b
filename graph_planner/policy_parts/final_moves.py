"""Moves that a policy has decided on itself, end nodes of others included."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.moves import FINAL

FARTHEST = 2**62  # above every squared distance [node^2]


@kernel
def make_final(preferences: NDArray[np.float64], move: int) -> None:
    """Set preferences (9,) to one of the moves 0-7; where it is illegal, any but staying put."""
    preferences[:] = 0.0
    preferences[STAY] = -1.0
    preferences[move] = FINAL


@inlined
def is_taken(ends: Int32Array, chosen: int, node: int) -> bool:
    """True if a node is among the first `chosen` end nodes (agent,)."""
    found = False
    for i in range(chosen):
        found |= ends[i] == node
    return found


@kernel
def squared_to_nearest(
    rows: Int32Array, cols: Int32Array, nodes: Int32Array, ends: Int32Array, out: NDArray[np.int64]
) -> None:
    """Squared Euclidean distance to the nearest of some nodes, across land [node^2].

    Parameters
    ----------
    rows, cols : (node,) of the map
    ends : (end,) from where; of -1 the result means nothing
    out : (end,) the result, `FARTHEST` without nodes
    """
    row, col = np.empty(ends.size, np.int64), np.empty(ends.size, np.int64)
    for i in range(ends.size):
        row[i], col[i], out[i] = rows[ends[i]], cols[ends[i]], FARTHEST
    for node in nodes:
        its_row, its_col = np.int64(rows[node]), np.int64(cols[node])
        for i in range(ends.size):
            down, right = row[i] - its_row, col[i] - its_col
            out[i] = min(out[i], down * down + right * right)
