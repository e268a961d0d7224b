"""Moves that a policy has decided on itself, end nodes of others included."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
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


@kernel
def is_taken(ends: Int32Array, chosen: int, node: int) -> bool:
    """True if a node is among the first `chosen` end nodes (agent,)."""
    found = False
    for i in range(chosen):
        found |= ends[i] == node
    return found


@kernel
def squared_distance(rows: Int32Array, cols: Int32Array, one: int, other: int) -> int:
    """Squared Euclidean distance of two nodes, across land [node^2]."""
    down, right = np.int64(rows[one] - rows[other]), np.int64(cols[one] - cols[other])
    return int(down * down + right * right)
