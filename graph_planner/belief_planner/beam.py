"""Beam: the few best of many candidates, in order, for all searches.

Every candidate has a slot; `order` lists the slots of those kept, the cheapest first, and `cost`
holds what is in each slot. Of two equally dear candidates the earlier one comes first.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined


@inlined
def limit(order: NDArray[np.int64], cost: NDArray[np.float64], count: int) -> float:
    """A candidate is taken in only if it costs less: inf while there is room."""
    return float(np.inf if count < order.size else cost[order[count - 1]])


@inlined
def free_slot(order: NDArray[np.int64], count: int) -> int:
    """The slot for the next candidate: a new one, or that of the dearest if all are taken."""
    return int(count if count < order.size else order[count - 1])


@inlined
def insert(order: NDArray[np.int64], cost: NDArray[np.float64], count: int, slot: int) -> int:
    """Give an admitted candidate its place in the order; the dearest goes if there is no room.

    Returns: candidates kept now.
    """
    place = min(count, order.size - 1)
    while place > 0 and cost[order[place - 1]] > cost[slot]:
        order[place] = order[place - 1]
        place -= 1
    order[place] = slot
    return min(count + 1, order.size)
