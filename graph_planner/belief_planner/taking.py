"""Time that foragers need to collect the items in a node: none in the graph world.

A hull takes one item after the other, needs a stand-off for one in a corner of two quays, and turns
slowly: what lies behind it in the next node takes a decision more. On the way to a node farther
away there is time to turn. How long all that takes was measured of each hull (`task.Pickup`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary
from mjforage.mission.task import Task

BESIDE = 0.15  # a quay nearer than that to an item is beside it [node]
QUARTER_RAD = 0.25 * math.pi  # of half a circle


class Taking(NamedTuple):
    """Decisions that collecting takes beyond the one that ends in the node."""

    first: NDArray[np.float64]  # (agent, quays, quarter) see `task.Pickup`
    usual: NDArray[np.float64]  # (quays,) mean over foragers and the quarters before the beam
    more: float  # for every item but the first

    @classmethod
    def of(cls, task: Task) -> "Taking":
        """Collecting times of the fleet; none where a forager collects all at once."""
        pickup, foragers = task.pickup, task.fleet.collectors
        if pickup is None or foragers.size == 0:
            return cls(np.zeros((len(task.fleet), 3, 4)), np.zeros(3), 0.0)
        usual = pickup.first[foragers, :, :2].mean(axis=(0, 2))
        return cls(pickup.first, usual, float(pickup.more[foragers].mean()))


@kernel
def quays_beside(boundary: Boundary, row: float, col: float, node: int) -> int:
    """Number of quays (0 to 2) beside a position in a node."""
    count = 0
    for axis in range(2):
        off = row - boundary.rows[node] if axis == 0 else col - boundary.cols[node]
        walls = boundary.room[node, axis]
        count += walls[1 if off > 0.0 else 0] == 0 and abs(off) > 0.5 - BESIDE
    return count


@kernel
def dwell(taking: Taking, weight: float) -> float:
    """Decisions that taking so many items takes beyond the first."""
    return float(taking.more * max(0.0, weight - 1.0))


@kernel
def turning(taking: Taking, agent: int, quays: int, off: float) -> float:
    """Decisions lost over the first item, with so many quays beside it, `off` [rad] the bow."""
    folded = abs(math.atan2(math.sin(off), math.cos(off)))
    return float(taking.first[agent, quays, min(int(folded / QUARTER_RAD), 3)])
