"""Where foragers wait before anything is known: near to where the hotspot may be."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.ways import UNREACHED, Ways, row_to
from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array

UNREACHABLE = 500.0  # decisions charged for a landmark out of reach


@kernel
def meeting_node(
    ways: Ways, landmarks: Int32Array, mass: NDArray[np.float64], at: int
) -> int:
    """The node from which the landmarks are fewest decisions away, weighted by mass.

    Parameters
    ----------
    landmarks : (landmark,) nodes
    mass : (landmark,)
    at : node of the forager, which settles ties: the nearest wins
    """
    n = ways.ends.shape[0]
    cost = np.zeros(n)
    for i in range(landmarks.size):
        if mass[i] <= 0.0:
            continue
        row = ways.decisions[row_to(ways, landmarks[i])]
        for v in range(n):
            there = UNREACHABLE if row[v] == UNREACHED else float(row[v])
            cost[v] += mass[i] * there
    return int(np.argmin(cost))
