"""Items as bodies: how they are placed, read back, and taken aboard."""

import math

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.navigation import Water
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.walls import into_water
from mjforage.core.dynamics import Transition

MOUTH_DEPTH_M = 0.3  # how far behind the bow the mouth reaches, and the item's radius ahead of it
MOUTH_REACH_M = 0.12  # an item of radius 0.1 m that touches the bow is in
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


@kernel
def take_at_mouth(
    active: NDArray[np.bool_],
    collects: NDArray[np.bool_],
    size: FloatArray,
    pose: FloatArray,
    xy: FloatArray,
    room_left: NDArray[np.int64],
    state: Transition,
) -> int:
    """Capture rule `intake`: an item in a forager's mouth is taken, while there is room.

    The mouth is as wide as the hull, at the bow.

    Parameters
    ----------
    size : (vessel, 2) half length, half beam [m]
    pose : (episode, vessel, 3); xy : (episode, item, 2) [m]

    Returns
    -------
    How many items were taken.
    """
    item_node, collected_by, taken = state.item_node, state.collected_by, 0
    for e in range(active.size):
        if not active[e]:
            continue
        for agent in range(collects.size):
            if not collects[agent]:
                continue
            c, s = math.cos(pose[e, agent, 2]), math.sin(pose[e, agent, 2])
            bow, half = size[agent, 0], size[agent, 1]
            for k in range(item_node.shape[1]):
                if item_node[e, k] < 0 or room_left[e, agent] <= 0:
                    continue
                dx, dy = xy[e, k, 0] - pose[e, agent, 0], xy[e, k, 1] - pose[e, agent, 1]
                ahead, aside = c * dx + s * dy, c * dy - s * dx
                if -MOUTH_DEPTH_M <= ahead - bow <= MOUTH_REACH_M and abs(aside) <= half:
                    item_node[e, k] = -1
                    collected_by[e, k] = agent
                    room_left[e, agent] -= 1
                    taken += 1
    return taken


@kernel
def nearest_items(
    active: NDArray[np.bool_],
    collects: NDArray[np.bool_],
    room_left: NDArray[np.int64],
    pose: FloatArray,
    xy: FloatArray,
    node_xy: FloatArray,
    pitch_m: float,
    item_node: Int32Array,
    out: FloatArray,
) -> None:
    """The item nearest to each forager within the square of its target node; NaN if none.

    Parameters
    ----------
    node_xy : (episode, vessel, 2) centre of the target node [m]
    out : (episode, vessel, 2) written
    """
    out[:] = np.nan
    for e in range(active.size):
        if not active[e]:
            continue
        for agent in range(collects.size):
            if not collects[agent] or room_left[e, agent] <= 0:
                continue
            least = np.inf
            for k in range(item_node.shape[1]):
                off_x, off_y = (
                    xy[e, k, 0] - node_xy[e, agent, 0],
                    xy[e, k, 1] - node_xy[e, agent, 1],
                )
                inside = max(abs(off_x), abs(off_y)) <= 0.5 * pitch_m
                if item_node[e, k] < 0 or not inside:
                    continue
                away = math.hypot(xy[e, k, 0] - pose[e, agent, 0], xy[e, k, 1] - pose[e, agent, 1])
                if away < least:
                    least = away
                    out[e, agent, 0], out[e, agent, 1] = xy[e, k, 0], xy[e, k, 1]
