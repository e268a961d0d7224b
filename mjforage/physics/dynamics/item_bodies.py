"""Items as bodies: reading them back."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.graph_planner.graph.navigation import Water
from mjforage.graph_planner.graph.walls import into_water
from mjforage.mission.dynamics import Transition

FloatArray = NDArray[np.float64]


@kernel
def read_items(
    active: NDArray[np.bool_],
    xy: FloatArray,
    water: Water,
    pitch_m: float,
    state: Transition,
) -> None:
    """Positions and nodes of the items that are left, from where their bodies are.

    `xy`: (episode, item, 2) [m]; `state`: `item_rc` and `item_node` are written.
    """
    item_rc, item_node = state.item_rc, state.item_node
    height = water.framed.shape[0] - 2
    for e in range(active.size):
        if not active[e]:
            continue
        for k in range(item_node.shape[1]):
            if item_node[e, k] < 0:
                continue
            row, col = height - 1 - xy[e, k, 1] / pitch_m, xy[e, k, 0] / pitch_m
            item_rc[e, k, 0], item_rc[e, k, 1] = row, col
            _, _, item_node[e, k] = into_water(water, 0, row, col)


READ_ITEMS = Launch(read_items, shared="water")
