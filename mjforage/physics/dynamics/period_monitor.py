"""Period monitor: arrivals, hindrances, contacts, path and energy at every control tick.

In a period a vessel *arrived* if midships came within `ARRIVAL_M` of the target's centre. It is
*blocked* if it was slower than `SLOW_MPS` for `BLOCKED_S` because of contact or giving way.
Otherwise it is *late*.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.device import Launch
from mjforage.controllers.chart import LandArray
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.dynamics import ARRIVED, BLOCKED, LATE
from mjforage.physics.dynamics.touch import touches
from mjforage.physics.hydrodynamics.parameters import VesselArray
from mjforage.physics.hydrodynamics.power import drawn_power

ARRIVAL_M, SLOW_MPS, BLOCKED_S = 1.0, 0.1, 2.0  # of the definitions above; estimates
FloatArray = NDArray[np.float64]


class PeriodRecord(NamedTuple):
    """Sums over the ticks of a period; (episode, vessel) each."""

    arrived: NDArray[np.bool_]
    hindered_s: FloatArray  # how long it has been slow for a reason, without a break
    blocked: NDArray[np.bool_]
    travelled_m: FloatArray
    impact_mps: FloatArray
    touching: NDArray[np.bool_]  # at the last tick
    collisions: Int32Array  # so far in the episode
    work_j: FloatArray  # electrical energy drawn so far in the episode
    touches: NDArray[np.bool_]  # memory of a tick
    closing: FloatArray  # the same

    @classmethod
    def of(cls, shape: tuple[int, int]) -> "PeriodRecord":
        """Record before the first period."""
        kinds = ("?", "d", "?", "d", "d", "?", "i", "d", "?", "d")
        return cls(*(np.zeros(shape, kind) for kind in kinds))

    def forget(self, rows: NDArray[np.int64]) -> None:
        """Put episodes back to before their first period."""
        for entry in self:
            entry[rows] = 0

    def begin(self, active: NDArray[np.bool_]) -> None:
        """Start a period."""
        for entry in self[:5]:
            entry[active] = 0


class Motion(NamedTuple):
    """Poses and velocities of vessels, (episode, vessel, 3) each, world axes."""

    pose: FloatArray  # x, y [m], yaw [rad] of midships
    velocity: FloatArray  # over ground [m/s], [rad/s]


class Known(NamedTuple):
    """Poses and velocities as the vessels know them, (episode, vessel, 3) each, world axes."""

    pose: FloatArray  # [m], [rad]
    velocity: FloatArray  # [m/s], [rad/s]
    seeking: FloatArray  # pose from which items are chosen: exact without a filter


class Tick(NamedTuple):
    """One control tick."""

    before: Motion
    after: Motion
    target: FloatArray  # (episode, vessel, 2) [m]
    giving_way: NDArray[np.bool_]  # (episode, vessel) held back for another vessel or a quay
    met: FloatArray  # (episode, vessel, 3) poses in which vessels met, `Simulation.contact_pose`
    lagged: FloatArray  # (episode, vessel, 2) state of the thrusters [rad/s] or [N]


class MonitorSetup(NamedTuple):
    """Vessels and quays, which no tick changes."""

    vessels: VesselArray  # (vessel,)
    size: FloatArray  # (vessel, 2) half length, half beam [m]
    land: LandArray  # of the chart
    pitch_m: float
    tick_s: float


@inlined
def _note_work(tick: Tick, setup: MonitorSetup, e: int, v: int, work_j: FloatArray) -> None:
    """Add the electrical energy drawn over the tick."""
    port, starboard = tick.lagged[e, v, 0], tick.lagged[e, v, 1]
    work_j[e, v] += setup.tick_s * drawn_power(setup.vessels[v], port, starboard)


@inlined
def _note_hindrance(slow: bool, tick_s: float, seen: PeriodRecord, e: int, v: int) -> None:
    """Count the time that a vessel has been slow for a reason; `slow`: it is, now."""
    if not slow:
        seen.hindered_s[e, v] = 0.0
        return
    seen.hindered_s[e, v] += tick_s
    if seen.hindered_s[e, v] >= BLOCKED_S - 0.5 * tick_s:
        seen.blocked[e, v] = True


@kernel
def monitor(setup: MonitorSetup, seen: PeriodRecord, active: NDArray[np.bool_], tick: Tick) -> None:
    """Note one tick of the active episodes in `seen`."""
    pose, before, velocity = tick.after.pose, tick.before.pose, tick.after.velocity
    vessels, size = pose.shape[1], setup.size
    for e in range(active.size):
        if not active[e]:
            continue
        start, now, closing = tick.before.velocity[e], seen.touches[e], seen.closing[e]
        touches(tick.met[e], start, size, setup.land, setup.pitch_m, now, closing)
        for v in range(vessels):
            x, y = pose[e, v, 0], pose[e, v, 1]
            seen.travelled_m[e, v] += math.hypot(x - before[e, v, 0], y - before[e, v, 1])
            seen.collisions[e, v] += now[v] and not seen.touching[e, v]
            seen.touching[e, v] = now[v]
            seen.impact_mps[e, v] = max(seen.impact_mps[e, v], closing[v])
            _note_work(tick, setup, e, v, seen.work_j)
            if math.hypot(x - tick.target[e, v, 0], y - tick.target[e, v, 1]) <= ARRIVAL_M:
                seen.arrived[e, v] = True
            slow = math.hypot(velocity[e, v, 0], velocity[e, v, 1]) < SLOW_MPS
            hindered = slow and (now[v] or tick.giving_way[e, v])
            _note_hindrance(hindered, setup.tick_s, seen, e, v)


@kernel
def judge(
    active: NDArray[np.bool_],
    no_move: NDArray[np.bool_],
    seen: PeriodRecord,
    outcome: NDArray[np.int8],
) -> None:
    """Write the outcome of each move of a period.

    Parameters
    ----------
    no_move : (episode, vessel) no legal move was left
    outcome : (episode, vessel) written: ARRIVED, LATE or BLOCKED
    """
    arrived, blocked = seen.arrived, seen.blocked
    for e in range(active.size):
        if not active[e]:
            continue
        for v in range(outcome.shape[1]):
            if no_move[e, v]:
                outcome[e, v] = BLOCKED
            elif arrived[e, v]:
                outcome[e, v] = ARRIVED
            else:
                outcome[e, v] = BLOCKED if blocked[e, v] else LATE


MONITOR, JUDGE = Launch(monitor, shared="setup"), Launch(judge)
