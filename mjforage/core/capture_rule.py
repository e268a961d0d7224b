"""Capture by chance: foragers take what is in their node as surely as their hulls did in trials.

The nearest item of a forager's node is taken with the chance of its cell (see `capture`), once one
is taken the next with the chance of a second one, until one is missed or there is no room.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from controllers.quayside import BESIDE_M
from graph_planner.compiled import inlined, kernel
from graph_planner.fleet import Fleet
from graph_planner.geodesics import Int32Array
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.rows import put_rows
from graph_planner.task import IDLE, MISSED, TAKEN
from mjforage.core.capture import DECISIONS, FROM_DEG, FROM_M, QUAYS, Capture, load_capture
from mjforage.core.dynamics import Transition
from mjforage.core.errors import UserError
from mjforage.core.scenario import Scenario
from mjforage.core.vessel_files import hull_names

FloatArray = NDArray[np.float64]
_CELLS = len(QUAYS), len(FROM_M), len(FROM_DEG)


class Chances(NamedTuple):
    """How surely each agent takes an item."""

    first: FloatArray  # (agent, quays, distance, bearing, decision) not taken before
    follow: FloatArray  # (agent, quays) after another one in the same decision
    pitch_m: float  # side of a node


class Stays(NamedTuple):
    """Since when foragers have been trying for what is in their node."""

    node: Int32Array  # (episode, agent) at the end of the last decision
    last: FloatArray  # (episode, agent, 3) row, column [node] and yaw [rad] then
    begun: FloatArray  # (episode, agent, 3) the same when the first try began
    tries: NDArray[np.int64]  # (episode, agent) decisions that took nothing there

    @classmethod
    def of(cls, state: Transition) -> Self:
        """No tries yet."""
        last = np.concatenate((state.agent_rc, state.agent_yaw[..., None]), axis=-1)
        return cls(state.agent_node.copy(), last, last.copy(), np.zeros(last.shape[:2], np.int64))

    def with_rows(self, rows: NDArray[np.int64], other: Self) -> Self:
        """Those of a batch with episodes (row,) replaced by those of another one."""
        pairs = zip(self, other, strict=True)
        return type(self)(*(put_rows(mine, rows, theirs) for mine, theirs in pairs))


def chances_of(fleet: Fleet, scenario: Scenario) -> Chances | None:
    """How surely each agent takes an item, or None where all take everything.

    Raises
    ------
    UserError
        If a collecting vessel has no capture model, or one for another period.
    """
    if scenario.rules.capture == "certain":
        return None
    first, follow = np.zeros((len(fleet), *_CELLS, DECISIONS)), np.zeros((len(fleet), len(QUAYS)))
    names = hull_names(fleet, scenario.physics)
    for agent in fleet.collectors:
        capture = load_capture(names[agent])
        if capture.period_s != scenario.period_s:
            raise UserError(
                f"rules.capture = 'calibrated': vessel {names[agent]} was calibrated for decisions "
                f"of {capture.period_s:g} s; set period_s={capture.period_s:g}"
            )
        first[agent], follow[agent] = chances_from(capture)
    return Chances(first, follow, scenario.map.pitch_m)


def chances_from(capture: Capture) -> tuple[FloatArray, FloatArray]:
    """Chances of a hull, (quays, distance, bearing, decision) and (quays,), from counts.

    By the rule of succession (Laplace 1814), (taken + 1) / (trials + 2): never quite 0 or 1.
    """
    first, follow = np.zeros((*_CELLS, DECISIONS)), np.zeros(len(QUAYS))
    for cell in capture.cells:
        place = QUAYS.index(cell.quays), FROM_M.index(cell.from_m), FROM_DEG.index(cell.from_deg)
        taken = np.array(cell.taken)
        left = cell.trials - np.cumsum(taken) + taken
        first[place] = (taken + 1) / (left + 2)
    for both in capture.follows:
        follow[QUAYS.index(both.quays)] = (both.taken + 1) / (both.trials + 2)
    return first, follow


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
    """How many quays lie beside an item (row, column) [node]: 0, 1, or 2 that meet."""
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
    """Every forager tries for what is in its node, in index order, while it has room."""
    agents, item_node, pickup = collects.size, state.item_node, state.pickup
    for e in range(active.size):
        if not active[e]:
            continue
        key = stream_key(keys[e], Stream.CAPTURE)
        for a in range(agents):
            if not collects[a]:
                continue
            node, tries, pickup[e, a] = state.agent_node[e, a], stays.tries[e, a], IDLE
            if node != stays.node[e, a]:
                tries = 0
            if tries == 0:
                stays.begun[e, a] = stays.last[e, a]
            pose = stays.begun[e, a]
            while room_left[e, a] > 0:
                k = _nearest(state, e, node, pose)
                if k < 0:
                    break
                again, place = pickup[e, a] == TAKEN, state.item_rc[e, k]
                chance = _chance(chances, framed, a, again, pose, tries, place)
                if uniform(key, k * agents + a, step[e]) >= chance:
                    pickup[e, a] = TAKEN if again else MISSED
                    break
                item_node[e, k], state.collected_by[e, k], pickup[e, a] = -1, a, TAKEN
                room_left[e, a] -= 1
            stays.tries[e, a] = tries + 1 if pickup[e, a] == MISSED else 0
            stays.node[e, a], stays.last[e, a, 2] = node, state.agent_yaw[e, a]
            stays.last[e, a, :2] = state.agent_rc[e, a]
