"""How long foragers take to collect what is in a node: in the graph no time, with hulls some.

A hull takes one item after the other, comes in slowly where quays are near, and into a corner of
two only after a stand-off. It also has to turn: a move back the way it came takes it longer.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.shore import Shore
from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array

BESIDE = 0.15  # a quay nearer than that to an item is beside it [node]
CORNER = 2  # quays beside an item in a corner


class Taking(NamedTuple):
    """Decisions that collecting takes beyond the one that ends in the node."""

    each: float  # decisions for an item
    corner: float  # and for a corner in which there is one
    turn: float  # and for turning right round first

    @classmethod
    def of(cls, certain: bool) -> "Taking":
        """In the graph, or with hulls.

        Those of hulls: 0.8 items in a decision in the node, in corners 0.5 of the decisions take
        any, and of those with an item astern in the next node 0.05 (`comb-port-weather`, 25
        episodes of `belief`).
        """
        return cls(0.0, 0.0, 0.0) if certain else cls(1.2, 1.5, 0.9)


class LastMoves:
    """How agents last moved."""

    def __init__(self, shore: Shore, episodes: int, agents: int) -> None:
        self._shore = shore
        self._at = np.full((episodes, agents), -1, np.int32)
        self._way = np.zeros((episodes, agents, 2))

    def of(self, e: int, at: Int32Array) -> NDArray[np.float64]:
        """(agent, 2) rows and columns of each one's last move that was none of staying, 0 for none.

        Parameters
        ----------
        e : episode, asked at every decision
        at : (agent,) nodes now
        """
        before, shore = self._at[e], self._shore
        moved = (at != before) & (before >= 0)
        self._way[e, moved, 0] = (shore.rows[at] - shore.rows[before])[moved]
        self._way[e, moved, 1] = (shore.cols[at] - shore.cols[before])[moved]
        self._at[e] = at
        return self._way[e]


@kernel
def quays_beside(shore: Shore, row: float, col: float, node: int) -> int:
    """How many quays (0 to 2) lie beside a position in a node."""
    count = 0
    for axis in range(2):
        off = row - shore.rows[node] if axis == 0 else col - shore.cols[node]
        walls = shore.room[node, axis]
        count += walls[1 if off > 0.0 else 0] == 0 and abs(off) > 0.5 - BESIDE
    return count


@kernel
def dwell(taking: Taking, weight: float, cornered: bool) -> float:
    """Decisions that taking so many items takes beyond the first."""
    return float(max(0.0, taking.each * weight + taking.corner * cornered - min(1.0, weight)))


@kernel
def turning(taking: Taking, down: float, right: float, way_down: float, way_right: float) -> float:
    """Decisions that a hull loses by turning to a stop: none ahead or abeam, all of it astern.

    Parameters
    ----------
    down, right : from the hull to the stop [node]
    way_down, way_right : its last move that was none of staying, 0 where there was none
    """
    size = math.hypot(down, right) * math.hypot(way_down, way_right)
    if size == 0.0:
        return 0.0
    return float(taking.turn * max(0.0, -(down * way_down + right * way_right) / size))
