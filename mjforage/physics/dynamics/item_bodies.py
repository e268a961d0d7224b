"""Items as bodies: placing them and reading them back."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.forcing import LEEWAY
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import Water
from mjforage.graph_planner.graph.walls import into_water
from mjforage.mission.dynamics import Transition
from mjforage.physics.scene.debris import load_debris

_CLASS = 3  # step of a drawn class in the stream of items, away from the other draws
FloatArray = NDArray[np.float64]


@kernel
def draw_classes(
    keys: UInt64Array, item_node: Int32Array, choices: NDArray[np.int64]
) -> NDArray[np.int64]:
    """(episode, item) class of each item, one of `choices` with equal chances; -1 for padding."""
    result = np.full(item_node.shape, -1, np.int64)
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.ITEMS)
        for k in range(item_node.shape[1]):
            if item_node[e, k] >= 0:
                result[e, k] = choices[int(uniform(key, k, _CLASS) * choices.size)]
    return result


@kernel
def read_items(
    active: NDArray[np.bool_],
    xy: FloatArray,
    water: Water,
    pitch_m: float,
    state: Transition,
) -> None:
    """Positions and nodes of the items that are left, from where their bodies are.

    Parameters
    ----------
    xy : (episode, item, 2) [m]
    state : `item_rc` and `item_node` are written
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


def leeways(classes: FloatArray) -> FloatArray:
    """(episode, item) leeway of items of some classes, the paper's where an item is no more."""
    known = np.array([kind.leeway for kind in load_debris()] + [LEEWAY])
    found: FloatArray = known[np.where(classes < 0, len(known) - 1, classes).astype(np.int64)]
    return found
