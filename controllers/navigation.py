"""Navigation filter: position, heading and what the sensors are off by, with their covariance.

An extended Kalman filter in error-state form (Groves, "Principles of GNSS, Inertial, and
Multisensor Integrated Navigation Systems", 2nd ed., 2013, chapters 3 and 14). Log and gyro carry
position and heading on; fixes and compass correct them. A fix is off by a Gauss-Markov error and
white noise, a compass by a constant and white noise: the errors are states as well. The track that
the fixes show against the one that log and compass show tells the compass's error.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Launch
from mjforage.controllers.allocation import thrust_of
from mjforage.controllers.angles import wrapped
from mjforage.controllers.estimate import surge_after, sway_after
from mjforage.controllers.propulsion import thrust_under_way
from mjforage.controllers.state import FleetArray
from mjforage.controllers.vessel_model import FloatArray, ModelArray, ModelRecord

X, Y, YAW, OFF_X, OFF_Y, TURN = range(6)  # states; the last three are errors of fix and compass
STATES = 6
MARGIN = 3.5  # standard deviations of the position that are kept free
LEAST_M, LEAST_RAD = 1e-3, 1e-4  # of white noise: what numbers are rounded to, so to say
LEAST_MPS = 0.01  # of the log's noise: steps of time
GYRO_RAD2PS = 1e-8  # variance that the heading gains per second


class SensorErrors(NamedTuple):
    """Errors of a vessel's sensors: standard deviations, of positions per axis."""

    position_m: float  # white noise of a fix
    wander_m: float  # its Gauss-Markov error
    memory_s: float  # time constant of that
    velocity_mps: float  # white noise of the log, per axis
    heading_rad: float  # white noise of the compass
    bias_rad: float  # its constant error
    latency: int  # from a measurement to its use [ticks]
    tick_s: float


class Filters(NamedTuple):
    """Filters of a batch of fleets, and what they tell."""

    state: FloatArray  # (episode, vessel, STATES) [m], [rad]
    covariance: FloatArray  # (episode, vessel, STATES, STATES)
    log: FloatArray  # (episode, vessel, 3) last velocity ahead, to port [m/s], rate [rad/s]
    thrust: FloatArray  # (episode, vessel, latency + 1, 2) moored, port and starboard of late [N]
    ticks: NDArray[np.int64]  # (episode, vessel) measurements so far
    pose: FloatArray  # (episode, vessel, 3) as of now [m], [rad]
    velocity: FloatArray  # (episode, vessel, 3) world axes [m/s], [rad/s]
    surprise: FloatArray  # (episode, vessel) normalised innovation squared of the tick
    measured: FloatArray  # (episode, vessel) measurements in that
    seen: FloatArray  # (episode, vessel, STATES) memory of `correct`

    @classmethod
    def of(cls, episodes: int, vessels: int, latency: int) -> "Filters":
        """Filters before the first measurement."""
        n = (episodes, vessels)
        x, thrust = (STATES,), (latency + 1, 2)
        shapes = (x, (STATES, STATES), (3,), thrust, (), (3,), (3,), (), (), x)
        kinds = ("d", "d", "d", "d", "q", "d", "d", "d", "d", "d")
        return cls(*(np.zeros((*n, *s), k) for s, k in zip(shapes, kinds, strict=True)))


@kernel
def begin(x: FloatArray, p: FloatArray, pose: FloatArray, of: SensorErrors) -> None:
    """Take the first fix and heading: off by as much as the errors that it is off by."""
    x[:], p[:] = 0.0, 0.0
    for i, noise, slow in (
        (X, of.position_m, of.wander_m),
        (Y, of.position_m, of.wander_m),
        (YAW, of.heading_rad, of.bias_rad),
    ):
        x[i], j = pose[i], i + OFF_X
        p[i, i] = noise * noise + slow * slow
        p[j, j] = slow * slow
        p[i, j] = p[j, i] = -slow * slow


@kernel
def carry_on(
    x: FloatArray,
    p: FloatArray,
    before: tuple[float, float, float],
    log: FloatArray,
    of: SensorErrors,
) -> None:
    """A tick of dead reckoning by the velocities [m/s], [rad/s] at its start and end.

    F = I + the heading's share in the way; the slow error of a fix fades by exp(-t / memory).
    """
    t, yaw = of.tick_s, x[YAW]
    x[YAW] += 0.5 * t * (before[2] + log[2])
    c0, s0, c, s = math.cos(yaw), math.sin(yaw), math.cos(x[YAW]), math.sin(x[YAW])
    dx = 0.5 * t * (c0 * before[0] - s0 * before[1] + c * log[0] - s * log[1])
    dy = 0.5 * t * (s0 * before[0] + c0 * before[1] + s * log[0] + c * log[1])
    x[X], x[Y] = x[X] + dx, x[Y] + dy
    fades = math.exp(-t / of.memory_s)
    for i in range(STATES):
        p[X, i] -= dy * p[YAW, i]
        p[Y, i] += dx * p[YAW, i]
        p[OFF_X, i] *= fades
        p[OFF_Y, i] *= fades
    for i in range(STATES):
        p[i, X] -= dy * p[i, YAW]
        p[i, Y] += dx * p[i, YAW]
        p[i, OFF_X] *= fades
        p[i, OFF_Y] *= fades
    way = t * max(of.velocity_mps, LEAST_MPS)
    for i in (X, Y):
        x[i + OFF_X] *= fades
        p[i, i] += way * way
        p[i + OFF_X, i + OFF_X] += of.wander_m**2 * (1.0 - fades * fades)
    p[YAW, YAW] += t * GYRO_RAD2PS


@kernel
def correct(
    x: FloatArray, p: FloatArray, seen: FloatArray, i: int, measured: float, noise: float
) -> float:
    """Take in a measurement of state `i` plus its error; its innovation squared over variance."""
    j = i + OFF_X
    off = measured - x[i] - x[j]
    if i == YAW:
        off = wrapped(off)
    variance = p[i, i] + 2.0 * p[i, j] + p[j, j] + noise * noise
    for k in range(STATES):
        seen[k] = p[i, k] + p[j, k]
    for k in range(STATES):
        x[k] += seen[k] * off / variance
        for m in range(STATES):
            p[k, m] -= seen[k] * seen[m] / variance
    return float(off * off / variance)


@kernel
def deviation(p: FloatArray) -> float:
    """Standard deviation of the position in the direction in which it is largest [m]."""
    mean, half = 0.5 * (p[X, X] + p[Y, Y]), 0.5 * (p[X, X] - p[Y, Y])
    return math.sqrt(mean + math.sqrt(half * half + p[X, Y] * p[X, Y]))


@kernel
def spin_after(p: ModelRecord, rate: float, moment: float, step_s: float) -> float:
    """Turn rate [rad/s] after a step under a moment [N m], as `surge_after`."""
    drag, inertia = p.linear_yaw + p.quadratic_yaw * abs(rate), p.inertia_yaw_kgm2
    return float((inertia * rate + step_s * moment) / (inertia + step_s * drag))


@kernel
def tell(f: Filters, p: ModelRecord, e: int, v: int, of: SensorErrors) -> None:
    """Write pose and velocity as of now.

    Since the measurements, a latency ago, the vessel has moved on as its model says under the
    thrusts of that time.
    """
    x, y, yaw = f.state[e, v, X], f.state[e, v, Y], f.state[e, v, YAW]
    ahead, aside, rate = f.log[e, v]
    slots, t = of.latency + 1, of.tick_s
    for k in range(min(of.latency, f.ticks[e, v])):
        moored, beside = f.thrust[e, v, (f.ticks[e, v] + 2 + k) % slots], p.lever_m * rate
        port = thrust_under_way(moored[0], ahead - beside, p.disc_kgpm)
        starboard = thrust_under_way(moored[1], ahead + beside, p.disc_kgpm)
        ahead = surge_after(p, ahead, port + starboard, t)
        moment = p.lever_m * (starboard - port) - p.munk_kg * ahead * aside
        aside = sway_after(p, aside, ahead, rate, t)
        rate = spin_after(p, rate, moment, t)
        yaw += t * rate
        c, s = math.cos(yaw), math.sin(yaw)
        x, y = x + t * (c * ahead - s * aside), y + t * (s * ahead + c * aside)
    c, s = math.cos(yaw), math.sin(yaw)
    f.pose[e, v, 0], f.pose[e, v, 1], f.pose[e, v, 2] = x, y, yaw
    f.velocity[e, v, 0], f.velocity[e, v, 1] = c * ahead - s * aside, s * ahead + c * aside
    f.velocity[e, v, 2] = rate


@kernel
def navigate(
    f: Filters,
    models: ModelArray,
    state: FleetArray,
    of: SensorErrors,
    active: NDArray[np.bool_],
    pose: FloatArray,
    velocity: FloatArray,
    fix: NDArray[np.bool_],
) -> None:
    """Take the measurements of a tick into the filters of the active episodes."""
    position, heading = max(of.position_m, LEAST_M), max(of.heading_rad, LEAST_RAD)
    for e in range(active.size):
        if not active[e]:
            continue
        for v in range(f.ticks.shape[1]):
            x, p, log, seen = f.state[e, v], f.covariance[e, v], f.log[e, v], pose[e, v]
            c, s = math.cos(seen[2]), math.sin(seen[2])
            before = log[0], log[1], log[2]
            log[0] = c * velocity[e, v, 0] + s * velocity[e, v, 1]
            log[1] = c * velocity[e, v, 1] - s * velocity[e, v, 0]
            log[2] = velocity[e, v, 2]
            slot = f.ticks[e, v] % (of.latency + 1)
            s = state[e, v]
            port = thrust_of(models[v], s.port, 0.0)
            starboard = thrust_of(models[v], s.starboard, 0.0)
            f.thrust[e, v, slot, 0] = port * (1.0 - s.port_loss)
            f.thrust[e, v, slot, 1] = starboard * (1.0 - s.starboard_loss)
            f.surprise[e, v] = f.measured[e, v] = 0.0
            if f.ticks[e, v] == 0:
                begin(x, p, seen, of)
            elif f.ticks[e, v] > of.latency:  # before that, measurements are those of the first
                carry_on(x, p, before, log, of)
                f.surprise[e, v] = correct(x, p, f.seen[e, v], YAW, seen[2], heading)
                f.measured[e, v] = 1.0
                if fix[e, v]:
                    f.surprise[e, v] += correct(x, p, f.seen[e, v], X, seen[0], position)
                    f.surprise[e, v] += correct(x, p, f.seen[e, v], Y, seen[1], position)
                    f.measured[e, v] = 3.0
            tell(f, models[v], e, v, of)
            state[e, v].margin = MARGIN * deviation(p)
            f.ticks[e, v] += 1


NAVIGATE = Launch(navigate, shared="models")


class Navigator:
    """The navigation filters of a batch of fleets."""

    def __init__(self, errors: SensorErrors, models: ModelArray, state: FleetArray) -> None:
        """Take the errors, the models (vessel,) and the pilot's memory (episode, vessel).

        Of that memory it reads the thrusters' state and writes the margin.
        """
        episodes, vessels = state.shape
        self.filters = Filters.of(episodes, vessels, errors.latency)
        self._navigate = BoundKernel(navigate, self.filters, models, state, errors)

    @property
    def fixed(self) -> tuple[object, ...]:
        """Arguments of `navigate` that stay."""
        return self._navigate.fixed

    def reset(self, rows: NDArray[Any] | slice) -> None:
        """Forget some episodes (row,)."""
        for each in self.filters:
            each[rows] = 0

    def update(
        self,
        active: NDArray[np.bool_],
        pose: FloatArray,
        velocity: FloatArray,
        fix: NDArray[np.bool_],
    ) -> Filters:
        """Take in the measurements of a tick, as of `Pilot.locate`."""
        self._navigate(active, pose, velocity, fix)
        return self.filters
