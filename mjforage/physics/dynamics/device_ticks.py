"""Kernels between those of a tick on a device: what `HostPeriod` does with arrays of numpy."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.dynamics import Transition
from mjforage.mission.moves import Moves
from mjforage.mission.task import IDLE
from mjforage.physics.dynamics.collecting import Sent
from mjforage.physics.dynamics.period_monitor import Motion, PeriodRecord
from mjforage.physics.dynamics.ticks import CONTROL_S

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


class Berths(NamedTuple):
    """Berths of vessels in each node, and its middle, (node, 2) each [m]."""

    berth_xy: FloatArray
    centre_xy: FloatArray


@kernel
def _note(
    pose: FloatArray,
    velocity: FloatArray,
    shift_s: float,
    before: Motion,
    now: Motion,
    giving_way: BoolArray,
) -> None:
    """Write motions before and after a tick, from poses as MuJoCo has them."""
    for e in range(pose.shape[0]):
        for v in range(pose.shape[1]):
            for axis in range(3):
                before.pose[e, v, axis] = now.pose[e, v, axis]
                before.velocity[e, v, axis] = now.velocity[e, v, axis]
                now.velocity[e, v, axis] = velocity[e, v, axis]
                now.pose[e, v, axis] = pose[e, v, axis] - shift_s * velocity[e, v, axis]


@kernel
def _count(active: BoolArray, tick: NDArray[np.int64], more: int, now_s: FloatArray) -> None:
    """Count ticks of the active episodes, and write their times [s]."""
    for e in range(active.size):
        if active[e]:
            tick[e] += more
        now_s[e] = tick[e] * CONTROL_S


@kernel
def _read_places(q: FloatArray, v: FloatArray, shift_s: float, xy: FloatArray) -> None:
    """Write places of items (episode, item, 2), from those ahead of their velocities."""
    for e in range(q.shape[0]):
        for k in range(q.shape[1]):
            for axis in range(2):
                xy[e, k, axis] = q[e, k, axis] - shift_s * v[e, k, axis]


@kernel
def _shift(pose: FloatArray, ashore: FloatArray, shifted: FloatArray) -> None:
    """Write poses from which the item that each vessel collects lies in the water."""
    for e in range(pose.shape[0]):
        for v in range(pose.shape[1]):
            for axis in range(3):
                more = ashore[e, v, axis] if axis < 2 else 0.0
                shifted[e, v, axis] = pose[e, v, axis] + more


@kernel
def _add(current: FloatArray, noise: FloatArray, water: FloatArray) -> None:
    """Write the velocity of an item's water, (episode, item, 2)."""
    for e in range(water.shape[0]):
        for k in range(water.shape[1]):
            for axis in range(2):
                water[e, k, axis] = current[e, k, axis] + noise[e, k, axis]


@kernel
def _show_all(xy: FloatArray, known: FloatArray) -> None:
    """Let every vessel know the places of all items, (episode, vessel, item, 2)."""
    for e in range(known.shape[0]):
        for v in range(known.shape[1]):
            for k in range(known.shape[2]):
                known[e, v, k, 0], known[e, v, k, 1] = xy[e, k, 0], xy[e, k, 1]


@kernel
def _remove(
    item_node: Int32Array,
    parking: FloatArray,
    kind: FloatArray,
    q: FloatArray,
    v: FloatArray,
) -> None:
    """Take collected items off the water."""
    for e in range(item_node.shape[0]):
        for k in range(item_node.shape[1]):
            if item_node[e, k] < 0 and kind[e, k] >= 0.0:
                kind[e, k] = -1.0
                for axis in range(2):
                    q[e, k, axis], v[e, k, axis] = parking[k, axis], 0.0


@kernel
def _send(
    berths: Berths,
    active: BoolArray,
    moves: Moves,
    state: Transition,
    origin: FloatArray,
    target: FloatArray,
    sent: Sent,
    record: PeriodRecord,
) -> None:
    """Write the orders of a decision, and begin its record."""
    for e in range(active.size):
        for v in range(origin.shape[1]):
            to, here = moves.target[e, v], state.agent_node[e, v]
            sent.stay[e, v] = moves.direction[e, v] == STAY
            for axis in range(2):
                origin[e, v, axis] = berths.berth_xy[here, axis]
                target[e, v, axis] = berths.berth_xy[to, axis]
                sent.node_xy[e, v, axis] = berths.centre_xy[to, axis]
            if active[e]:
                state.pickup[e, v] = IDLE
                record.arrived[e, v] = record.blocked[e, v] = False
                record.hindered_s[e, v] = record.travelled_m[e, v] = record.impact_mps[e, v] = 0.0


SEND = Launch(_send, shared="berths")
NOTE, COUNT, READ_PLACES = Launch(_note), Launch(_count), Launch(_read_places)
SHIFT, ADD, SHOW_ALL = Launch(_shift), Launch(_add), Launch(_show_all)
REMOVE = Launch(_remove, shared="parking")
