"""How long foragers take to collect what is in a node: in the graph no time, with hulls some.

A hull takes one item after the other, comes in slowly where quays are near, and into a corner of
two only after a stand-off.
"""

from typing import NamedTuple

from graph_planner.belief_planner.shore import Shore
from graph_planner.compiled import kernel

BESIDE = 0.15  # a quay nearer than that to an item is beside it [node]
CORNER = 2  # quays beside an item in a corner


class Taking(NamedTuple):
    """Decisions that collecting takes beyond the one that ends in the node."""

    each: float  # decisions for an item
    corner: float  # and for a corner in which there is one

    @classmethod
    def of(cls, certain: bool) -> "Taking":
        """In the graph, or with hulls.

        Those of hulls: 0.8 items in a decision in the node, in corners 0.5 of the decisions take
        any (`comb-port-weather`, 25 episodes of `belief`).
        """
        return cls(0.0, 0.0) if certain else cls(1.2, 1.5)


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
