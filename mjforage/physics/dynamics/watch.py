"""What is noted at every control tick of a period: arrivals, hindrances, touches, way, energy.

Semantics of a period (physics section 1): a hull *arrived* if midships came within `ARRIVAL_M` of
the target's centre; it is *blocked* if it was slower than `SLOW_MPS` for `BLOCKED_S` because of
contact or giving way; otherwise it is *late*.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import inlined, kernel
from graph_planner.geodesics import Int32Array
from mjforage.core.dynamics import ARRIVED, BLOCKED, LATE
from mjforage.physics.dynamics.touch import touches
from mjforage.physics.hydrodynamics.parameters import HullArray
from mjforage.physics.hydrodynamics.thruster import thrust

ARRIVAL_M = 1.0
SLOW_MPS = 0.1
BLOCKED_S = 2.0
PROPELLER_DISC_M2 = math.pi / 4 * 0.2**2  # of one side, 0.2 m across: an estimate for both classes
WATER_DENSITY_KGPM3 = 1025.0
FloatArray = NDArray[np.float64]


class Watched(NamedTuple):
    """What the ticks of a period add up to; (episode, vessel) each."""

    arrived: NDArray[np.bool_]
    hindered_s: FloatArray  # how long it has been slow for a reason, without a break
    blocked: NDArray[np.bool_]
    travelled_m: FloatArray
    impact_mps: FloatArray
    touching: NDArray[np.bool_]  # at the last tick
    collisions: Int32Array  # so far in the episode
    work_j: FloatArray  # so far in the episode

    @classmethod
    def of(cls, shape: tuple[int, int]) -> "Watched":
        """Nothing yet."""
        yes, number = np.zeros(shape, np.bool_), np.zeros(shape)
        return cls(
            yes,
            number,
            yes.copy(),
            number.copy(),
            number.copy(),
            yes.copy(),
            np.zeros(shape, np.int32),
            number.copy(),
        )

    def begin(self, active: NDArray[np.bool_]) -> None:
        """Start a period."""
        for entry in (self.arrived, self.hindered_s, self.blocked, self.travelled_m):
            entry[active] = 0
        self.impact_mps[active] = 0.0


@inlined
def propeller_power(force: float, inflow_mps: float) -> float:
    """Least power [W] that makes a thrust T in an inflow u: T (u + sqrt(u^2 + 2 T / (rho A))) / 2.

    Momentum theory of an actuator disc (Carlton, Marine Propellers and Propulsion, chapter 8).
    Inflow against the thrust counts as none.
    """
    size, along = abs(force), max(0.0, inflow_mps if force > 0.0 else -inflow_mps)
    wash = math.sqrt(along * along + 2.0 * size / (WATER_DENSITY_KGPM3 * PROPELLER_DISC_M2))
    return 0.5 * size * (along + wash)


@kernel
def watch(
    active: NDArray[np.bool_],
    tick_s: float,
    pose: FloatArray,
    velocity: FloatArray,
    pose_before: FloatArray,
    velocity_before: FloatArray,
    target: FloatArray,
    giving_way: NDArray[np.bool_],
    water: FloatArray,
    lagged: FloatArray,
    parameters: HullArray,
    size: FloatArray,
    framed: Int32Array,
    pitch_m: float,
    seen: Watched,
) -> None:
    """Note one tick.

    Parameters
    ----------
    pose, velocity : (episode, vessel, 3) at its end, world axes
    pose_before, velocity_before : the same at its start
    target : (episode, vessel, 2) [m]
    giving_way : (episode, vessel) whether the controller holds back for another hull or a quay
    water : (episode, vessel, 2) current at the hulls [m/s]
    lagged : (episode, vessel, 2) state of the thrusters [rad/s] or [N]
    parameters : (vessel,) of `hydrodynamics.parameters.pack_fleet`
    size : (vessel, 2) half length, half beam [m]
    framed : cells in a frame of land
    seen : written
    """
    arrived, hindered_s, blocked, travelled_m, impact_mps, touching, collisions, work_j = seen
    vessels = pose.shape[1]
    now, closing = np.zeros(vessels, np.bool_), np.zeros(vessels)
    for e in range(active.size):
        if not active[e]:
            continue
        touches(pose[e], velocity_before[e], size, framed, pitch_m, now, closing)
        for v in range(vessels):
            vx, vy = velocity[e, v, 0], velocity[e, v, 1]
            speed = math.hypot(vx, vy)
            travelled_m[e, v] += math.hypot(
                pose[e, v, 0] - pose_before[e, v, 0], pose[e, v, 1] - pose_before[e, v, 1]
            )
            collisions[e, v] += now[v] and not touching[e, v]
            touching[e, v] = now[v]
            impact_mps[e, v] = max(impact_mps[e, v], closing[v])
            c, s = math.cos(pose[e, v, 2]), math.sin(pose[e, v, 2])
            surge = c * (vx - water[e, v, 0]) + s * (vy - water[e, v, 1])
            for side in range(2):
                force = thrust(parameters[v], lagged[e, v, side])
                work_j[e, v] += tick_s * propeller_power(force, surge)
            off_x, off_y = pose[e, v, 0] - target[e, v, 0], pose[e, v, 1] - target[e, v, 1]
            if math.hypot(off_x, off_y) <= ARRIVAL_M:
                arrived[e, v] = True
            if speed < SLOW_MPS and (now[v] or giving_way[e, v]):
                hindered_s[e, v] += tick_s
                if hindered_s[e, v] >= BLOCKED_S - 0.5 * tick_s:
                    blocked[e, v] = True
            else:
                hindered_s[e, v] = 0.0


@kernel
def judge(
    active: NDArray[np.bool_],
    no_move: NDArray[np.bool_],
    seen: Watched,
    outcome: NDArray[np.int8],
) -> None:
    """How each move of a period ended.

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
