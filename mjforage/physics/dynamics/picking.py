"""Picking up: which item each forager goes for, what enters its mouth, and when it gives one up.

An attempt at an item has failed when the bow was near it and is away from it again without having
taken it. After `ATTEMPTS` of them the item is left for `LATER_S`; others are sought instead.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import inlined, kernel
from graph_planner.task import IDLE, MISSED, TAKEN, UNREACHABLE
from mjforage.core.dynamics import Transition

MOUTH_DEPTH_M = 0.3  # how far behind the bow the mouth reaches, and the item's radius ahead of it
MOUTH_REACH_M = 0.12  # an item of radius 0.1 m that touches the bow is in
ATTEMPTS = 2  # that may fail before an item is left for later
NEAR_M, AWAY_M = 0.6, 1.2  # from the middle of the bow: an attempt begins, and has failed
LATER_S = 60.0  # until an item that was given up is sought again
FloatArray = NDArray[np.float64]


class Attempts(NamedTuple):
    """What foragers seek, and what they have tried."""

    item: NDArray[np.int64]  # (episode, vessel) sought now, -1 none
    near: NDArray[np.bool_]  # (episode, vessel) whether the bow has been near it since
    failed: NDArray[np.int8]  # (episode, vessel, item) attempts that failed
    later_s: FloatArray  # (episode, vessel, item) time from which it is sought again [s]

    @classmethod
    def of(cls, vessels: int, items: NDArray[np.int32]) -> Self:
        """Nothing sought yet, of `items` (episode, item)."""
        pairs = (items.shape[0], vessels)
        every = (*pairs, items.shape[1])
        return cls(
            np.full(pairs, -1), np.zeros(pairs, np.bool_), np.zeros(every, np.int8), np.zeros(every)
        )


class Sent(NamedTuple):
    """Where hulls are sent."""

    node: NDArray[np.int32]  # (episode, vessel)
    xy: FloatArray  # (episode, vessel, 2) its centre [m]


class Goal(NamedTuple):
    """What pilots are told."""

    xy: FloatArray  # (episode, vessel, 2) item to pick up, NaN for none [m]
    look: NDArray[np.bool_]  # (episode, vessel) whether to look round for one


class Reach(NamedTuple):
    """Who collects and where from."""

    collects: NDArray[np.bool_]  # (vessel,)
    size: FloatArray  # (vessel, 2) half length, half beam [m]
    pitch_m: float  # side of a node


@inlined
def _note_attempt(
    attempts: Attempts, e: int, v: int, away_m: float, now_s: float, pickup: NDArray[np.int8]
) -> None:
    """Note how far the bow is from the item sought; two failed attempts end the search for it."""
    k = attempts.item[e, v]
    if attempts.near[e, v] and away_m > AWAY_M:
        attempts.near[e, v] = False
        attempts.failed[e, v, k] += 1
        if attempts.failed[e, v, k] >= ATTEMPTS:
            attempts.failed[e, v, k], attempts.later_s[e, v, k] = 0, now_s + LATER_S
            if pickup[e, v] != TAKEN:
                pickup[e, v] = UNREACHABLE


@kernel
def seek(
    reach: Reach,
    attempts: Attempts,
    active: NDArray[np.bool_],
    room_left: NDArray[np.int64],
    pose: FloatArray,
    xy: FloatArray,
    sent: Sent,
    now_s: FloatArray,
    state: Transition,
    goal: Goal,
) -> None:
    """The nearest item to each forager within the square of its target node.

    A forager that has sought none in this period, though one lay in the node as the period began,
    shall look round: the fleet told it of the node, but its own camera has not found the item.

    Parameters
    ----------
    room_left : (episode, vessel) items
    pose : (episode, vessel, 3)
    xy : (episode, vessel, item, 2) where each vessel takes items to be, NaN if it knows none [m]
    now_s : (episode,) [s]
    state : `pickup` is written
    goal : written
    """
    out, look, node, node_xy = goal.xy, goal.look, sent.node, sent.xy
    out[:], look[:] = np.nan, False
    item_node, pickup = state.item_node, state.pickup
    for e in range(active.size):
        if not active[e]:
            continue
        for v in range(reach.collects.size):
            if not reach.collects[v] or room_left[e, v] <= 0:
                continue
            x, y, half = pose[e, v, 0], pose[e, v, 1], reach.size[v, 0]
            c, s = math.cos(pose[e, v, 2]), math.sin(pose[e, v, 2])
            bow_x, bow_y, sought = x + half * c, y + half * s, attempts.item[e, v]
            if sought >= 0 and item_node[e, sought] >= 0:
                away = math.hypot(xy[e, v, sought, 0] - bow_x, xy[e, v, sought, 1] - bow_y)
                _note_attempt(attempts, e, v, away, now_s[e], pickup)
            least, best, unseen = np.inf, -1, False
            for k in range(item_node.shape[1]):
                at_x, at_y = xy[e, v, k, 0], xy[e, v, k, 1]
                off = max(abs(at_x - node_xy[e, v, 0]), abs(at_y - node_xy[e, v, 1]))
                inside = off <= 0.5 * reach.pitch_m
                unseen = unseen or (item_node[e, k] == node[e, v] and math.isnan(at_x))
                if item_node[e, k] < 0 or not inside or now_s[e] < attempts.later_s[e, v, k]:
                    continue
                away = math.hypot(at_x - x, at_y - y)
                if away < least:
                    least, best = away, k
            if best != sought:
                attempts.item[e, v], attempts.near[e, v] = best, False
            look[e, v] = best < 0 and unseen and pickup[e, v] == IDLE
            if best >= 0:
                bow_off = math.hypot(xy[e, v, best, 0] - bow_x, xy[e, v, best, 1] - bow_y)
                attempts.near[e, v] |= bow_off < NEAR_M
                out[e, v, 0], out[e, v, 1] = xy[e, v, best, 0], xy[e, v, best, 1]
                if pickup[e, v] == IDLE:
                    pickup[e, v] = MISSED


@kernel
def take_at_mouth(
    reach: Reach,
    active: NDArray[np.bool_],
    pose: FloatArray,
    xy: FloatArray,
    room_left: NDArray[np.int64],
    state: Transition,
) -> int:
    """Capture rule `intake`: an item in a forager's mouth is taken, while there is room.

    The mouth is as wide as the hull, at the bow.

    Parameters
    ----------
    pose : (episode, vessel, 3); xy : (episode, item, 2) [m]

    Returns
    -------
    How many items were taken.
    """
    collects, size = reach.collects, reach.size
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
                    state.pickup[e, agent] = TAKEN
                    taken += 1
    return taken
