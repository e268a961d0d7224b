"""Preferences over the nine moves, from a target."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Ways, row_to

ON_THE_WAY = 0.45  # most that items beside the way are worth, in decisions
NOT_HERE = 0.25  # decisions by which staying is worse than a move that leaves equally much to go


@kernel
def towards(
    ways: Ways, at: int, target: int, worth: NDArray[np.float64], preferences: NDArray[np.float64]
) -> None:
    """Prefer moves by the decisions left to the target after them, then by items passed.

    Parameters
    ----------
    at, target : nodes
    worth : (node,) items expected in each node now
    preferences : (9,) filled; -inf where a move is illegal
    """
    row = ways.decisions[row_to(ways, target)]
    for move in range(9):
        end = ways.ends[at, move]
        preferences[move] = -np.inf
        if end < 0:
            continue
        left = 1e5 if row[end] == UNREACHED else float(row[end])
        passed = worth[end]
        if end == at and at != target:
            left += NOT_HERE
            passed = 0.0
        preferences[move] = ON_THE_WAY * min(1.0, passed) - left
