"""The same forces as a plain ordinary differential equation: an oracle without MuJoCo.

Velocities relative to the water are integrated by the classical fourth-order Runge-Kutta method;
the thrusters' lag is solved exactly, as commands are constant within a step.
"""

import math
from itertools import pairwise

import numpy as np

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.conditions import Conditions, State, to_body
from mjforage.physics.hydrodynamics.motion import acceleration
from mjforage.physics.hydrodynamics.parameters import Float64Array, HullParameters, pack
from mjforage.physics.hydrodynamics.thruster import lagged
from mjforage.physics.vessels import Vessel

X, Y, YAW, SURGE, SWAY, RATE, PORT, STARBOARD = range(8)


@kernel
def _slope(
    p: HullParameters,
    state: Float64Array,
    thrusters: tuple[float, float],
    current: Float64Array,
    wind: Float64Array,
) -> Float64Array:
    """d(x, y, yaw, u_r, v_r, r)/dt."""
    c, s = math.cos(state[YAW]), math.sin(state[YAW])
    u, v, r = state[SURGE], state[SWAY], state[RATE]
    east, north = wind[0] - current[0], wind[1] - current[1]
    air = (c * east + s * north, c * north - s * east)
    surge, sway, turn = acceleration(p, (u, v, r), thrusters, air)
    return np.array(
        [c * u - s * v + current[0], s * u + c * v + current[1], r, surge, sway, turn],
    )


@kernel
def rk4_step(
    p: HullParameters,
    state: Float64Array,
    command: Float64Array,
    current: Float64Array,
    wind: Float64Array,
    step_s: float,
) -> Float64Array:
    """State after one step.

    Parameters
    ----------
    state : (8,) x, y [m], yaw [rad], velocity RELATIVE TO THE WATER u_r, v_r [m/s], yaw rate
        [rad/s], lagged commands of port and starboard
    command : (2,) port, starboard [rad/s or N]
    current, wind : (2,) east, north [m/s], over ground
    """
    moving, port, starboard = state[:PORT], state[PORT], state[STARBOARD]
    half, whole = 0.5 * step_s, step_s
    middle = (lagged(p, port, command[0], half), lagged(p, starboard, command[1], half))
    end = (lagged(p, port, command[0], whole), lagged(p, starboard, command[1], whole))
    k1 = _slope(p, moving, (port, starboard), current, wind)
    k2 = _slope(p, moving + half * k1, middle, current, wind)
    k3 = _slope(p, moving + half * k2, middle, current, wind)
    k4 = _slope(p, moving + whole * k3, end, current, wind)
    result = np.empty(8)
    result[:PORT] = moving + whole / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    result[PORT], result[STARBOARD] = end
    return result


class OdeHull:
    """A `Hull` moved by `rk4_step`."""

    def __init__(self, vessel: Vessel, conditions: Conditions) -> None:
        self._parameters = pack(vessel)
        self._current = np.array(conditions.current_mps)
        self._wind = np.array(conditions.wind_mps)
        flow = to_body(conditions.current_mps, conditions.heading_rad)
        x, y, yaw, u, v, r = conditions.start
        self._state = np.array([x, y, yaw, u - flow[0], v - flow[1], r, 0.0, 0.0])

    def step(self, port: float, starboard: float, step_s: float) -> None:
        """Advance by one Runge-Kutta step under constant commands [rad/s or N]."""
        command = np.array([port, starboard], np.float64)
        self._state = rk4_step(
            self._parameters, self._state, command, self._current, self._wind, step_s
        )

    def state(self) -> State:
        """Position, yaw, velocity over ground in body axes, yaw rate."""
        x, y, yaw, u, v, r = (float(value) for value in self._state[:PORT])
        flow = to_body((float(self._current[0]), float(self._current[1])), yaw)
        return x, y, yaw, u + flow[0], v + flow[1], r


def simulate(
    vessel: Vessel, conditions: Conditions, times_s: Float64Array, commands: Float64Array
) -> Float64Array:
    """Integrate one hull, a step per interval of the given times.

    Parameters
    ----------
    times_s : (rows,) increasing
    commands : (rows - 1, 2) port, starboard [rad/s or N], constant within each interval

    Returns
    -------
    ndarray, shape (rows, 6)
        x, y [m], yaw [rad], surge, sway [m/s] over ground in body axes, yaw rate [rad/s].
    """
    hull = OdeHull(vessel, conditions)
    states = [hull.state()]
    for (before, after), (port, starboard) in zip(pairwise(times_s), commands, strict=True):
        hull.step(float(port), float(starboard), float(after - before))
        states.append(hull.state())
    return np.array(states)
