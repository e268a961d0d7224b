"""Capture by chance: foragers collect items with the capture probability measured in trials.

The nearest item of a forager's node is taken with the chance of its cell (see `capture`), once one
is taken the next with the chance of a second one, until one is missed or there is no room.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.capture_chances import Chances
from mjforage.mission.dynamics import Transition
from mjforage.mission.task import IDLE, MISSED, TAKEN
from mjforage.scenario.capture import BESIDE_M, DECISIONS, FROM_DEG, FROM_M

FloatArray = NDArray[np.float64]


class Stays(NamedTuple):
    """Steps since which foragers have been trying for the items in their node."""

    node: Int32Array  # (episode, agent) at the end of the last decision
    last: FloatArray  # (episode, agent, 3) row, column [node] and yaw [rad] then
    begun: FloatArray  # (episode, agent, 3) the same when the first try began
    tries: NDArray[np.int64]  # (episode, agent) decisions that took nothing there

    @classmethod
    def of(cls, state: Transition) -> Self:
        """No tries yet."""
        last = np.concatenate((state.agent_rc, state.agent_yaw[..., None]), axis=-1)
        return cls(state.agent_node.copy(), last, last.copy(), np.zeros(last.shape[:2], np.int64))


@kernel
def capture_cell(east_m: float, north_m: float, yaw: float) -> tuple[int, int]:
    """Bins of distance and bearing of an item east and north of midships, seen along `yaw`."""
    far, off = math.hypot(east_m, north_m), math.atan2(north_m, east_m) - yaw
    bearing = math.degrees(abs(math.atan2(math.sin(off), math.cos(off))))
    i = j = 0
    for begin in FROM_M[1:]:
        i += far >= begin
    for begin in FROM_DEG[1:]:
        j += bearing >= begin
    return i, j


@kernel
def quays_beside(framed: Int32Array, pitch_m: float, row: float, col: float) -> int:
    """Number of quays beside an item (row, column) [node]: 0, 1, or 2 that meet."""
    reach, row, col = BESIDE_M / pitch_m, row + 1.5, col + 1.5
    i, j = int(row), int(col)
    along = framed[int(row - reach), j] < 0 or framed[int(row + reach), j] < 0
    across = framed[i, int(col - reach)] < 0 or framed[i, int(col + reach)] < 0
    return int(along) + int(across)


@inlined
def _nearest(state: Transition, e: int, node: int, pose: FloatArray) -> int:
    """The item of a node nearest to a pose, -1 without any; ties go to the lowest number."""
    best, least = -1, np.inf
    for k in range(state.item_node.shape[1]):
        if state.item_node[e, k] == node:
            off_row, off_col = state.item_rc[e, k, 0] - pose[0], state.item_rc[e, k, 1] - pose[1]
            squared = off_row * off_row + off_col * off_col
            if squared < least:
                best, least = k, squared
    return best


@inlined
def _chance(
    chances: Chances,
    framed: Int32Array,
    agent: int,
    again: bool,
    pose: FloatArray,
    tries: int,
    rc: FloatArray,
) -> float:
    """Chance of the item at `rc`; `again`: the agent has taken one in this decision."""
    quays = quays_beside(framed, chances.pitch_m, rc[0], rc[1])
    if again:
        return float(chances.follow[agent, quays])
    east, north = chances.pitch_m * (rc[1] - pose[1]), chances.pitch_m * (pose[0] - rc[0])
    i, j = capture_cell(east, north, pose[2])
    return float(chances.first[agent, quays, i, j, min(tries, DECISIONS - 1)])


@inlined
def _take(
    chances: Chances,
    stays: Stays,
    framed: Int32Array,
    key: np.uint64,
    e: int,
    a: int,
    step: int,
    room_left: NDArray[np.int64],
    state: Transition,
) -> int:
    """One forager takes items of its node until it misses one; how its collecting ended."""
    pose, ended = stays.begun[e, a], IDLE
    while room_left[e, a] > 0:
        k = _nearest(state, e, state.agent_node[e, a], pose)
        if k < 0:
            break
        place, again = state.item_rc[e, k], ended == TAKEN
        chance = _chance(chances, framed, a, again, pose, stays.tries[e, a], place)
        if uniform(key, k * state.agent_node.shape[1] + a, step) >= chance:
            return TAKEN if again else MISSED
        state.item_node[e, k], state.collected_by[e, k], ended = -1, a, TAKEN
        room_left[e, a] -= 1
    return ended


@kernel
def collect_by_chance(
    chances: Chances,
    stays: Stays,
    framed: Int32Array,
    keys: UInt64Array,
    active: NDArray[np.bool_],
    step: Int32Array,
    collects: NDArray[np.bool_],
    room_left: NDArray[np.int64],
    state: Transition,
) -> None:
    """Let every forager try for the items in its node, in index order, while it has room."""
    for e in range(active.size):
        if not active[e]:
            continue
        key = stream_key(keys[e], Stream.CAPTURE)
        for a in range(collects.size):
            if not collects[a]:
                continue
            if state.agent_node[e, a] != stays.node[e, a]:
                stays.tries[e, a] = 0
            if stays.tries[e, a] == 0:
                stays.begun[e, a] = stays.last[e, a]
            ended = _take(chances, stays, framed, key, e, a, step[e], room_left, state)
            state.pickup[e, a] = ended
            stays.tries[e, a] = stays.tries[e, a] + 1 if ended == MISSED else 0
            stays.node[e, a] = state.agent_node[e, a]
            stays.last[e, a, :2] = state.agent_rc[e, a]
            stays.last[e, a, 2] = state.agent_yaw[e, a]
