"""How long foragers take to collect what is in a node: in the graph no time, with hulls some.

A hull takes one item after the other, comes in slowly where quays are near, and into a corner of
two only after a stand-off. It turns slowly: what lies behind it in the next node takes a decision
more; on the way to one farther away there is time for that.
"""

import math
from typing import NamedTuple

from graph_planner.belief_planner.shore import Shore
from graph_planner.compiled import kernel

BESIDE = 0.15  # a quay nearer than that to an item is beside it [node]
CORNER = 2  # quays beside an item in a corner
FREE_RAD = math.radians(60.0)  # turned within what a decision leaves over


class Taking(NamedTuple):
    """Decisions that collecting takes beyond the one that ends in the node."""

    each: float  # decisions for an item
    corner: float  # and for a corner in which there is one
    behind: float  # and for a first item right behind the bow, in a node next to the hull's

    @classmethod
    def of(cls, certain: bool) -> "Taking":
        """In the graph, or with hulls.

        Those of hulls are the best of a handful tried on missions of `belief` in
        `comb-port-weather`: of decisions with one item in the next node, .97 take it if it bears up
        to 60 degrees from the bow, .9 up to 100 and .3 beyond; .6 of those with one in a corner do.
        """
        return cls(0.0, 0.0, 0.0) if certain else cls(0.5, 1.5, 1.2)


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
def turning(taking: Taking, off: float) -> float:
    """Decisions lost to turning to what lies `off` [rad] the bow: none up to `FREE_RAD`."""
    share = (abs(off) - FREE_RAD) / (math.pi - FREE_RAD)
    return taking.behind * max(share, 0.0)
