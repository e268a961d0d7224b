"""Satellite positioning, Doppler log, gyro and compass, with the errors that such sensors have.

A fix is off by a Gauss-Markov error (atmosphere, satellites, echoes: minutes long) and white noise.
Now and then there are outages, in which the receiver repeats its last fix and says so. The log
measures the velocity over ground in the vessel's axes, so that the compass turns it into world
axes. The gyro's rate of turn is exact. All of it is known a latency later.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, normal, stream_key, uniform
from mjforage.base.wholes import floor
from mjforage.controllers.navigation import SensorErrors
from mjforage.forcing.gauss_markov import gauss_markov_pair
from mjforage.physics.positioning.model import POSITIONING, FloatArray, Measured
from mjforage.scenario.sensors import Sensors


class Outages(NamedTuple):
    """One outage in every stretch of time, at a drawn moment."""

    length_s: float  # 0: none
    every_s: float
    tick_s: float


class Memory(NamedTuple):
    """Memory of the model, from tick to tick."""

    past: FloatArray  # (episode, tick, vessel, 6) poses and velocities, by the tick's remainder
    fix: FloatArray  # (episode, vessel, 2) last fix [m]


@kernel
def in_outage(outages: Outages, key: np.uint64, v: int, tick: int) -> bool:
    """True if vessel `v` has no fix at a tick; `key` is that of the stream of outages."""
    if outages.length_s == 0.0:
        return False
    period = round(outages.every_s / outages.tick_s)
    length = round(outages.length_s / outages.tick_s)
    start = 1 + floor((period - length) * uniform(key, v, tick // period))
    return bool(start <= tick % period < start + length)


@kernel
def _measure(
    e: SensorErrors,
    outages: Outages,
    memory: Memory,
    keys: UInt64Array,
    tick: NDArray[np.int64],
    pose: FloatArray,
    velocity: FloatArray,
    seen: Measured,
) -> None:
    """Write the measurements of a tick into `seen`."""
    slots = memory.past.shape[1]
    for k in range(keys.size):
        noise, log = stream_key(keys[k], Stream.SENSORS), stream_key(keys[k], Stream.LOG)
        drift, gaps = stream_key(keys[k], Stream.POSITION), stream_key(keys[k], Stream.OUTAGES)
        compass, then = stream_key(keys[k], Stream.COMPASS), max(tick[k] - e.latency, 0)
        for v in range(pose.shape[1]):
            for axis in range(3):
                memory.past[k, tick[k] % slots, v, axis] = pose[k, v, axis]
                memory.past[k, tick[k] % slots, v, 3 + axis] = velocity[k, v, axis]
            x, y, yaw, vx, vy, rate = memory.past[k, then % slots, v]
            out = in_outage(outages, gaps, v, then)
            if not out:
                off_x, off_y = gauss_markov_pair(stream_key(drift, v), then * e.tick_s / e.memory_s)
                at_x = x + e.wander_m * off_x + e.position_m * normal(noise, 3 * v, then)
                at_y = y + e.wander_m * off_y + e.position_m * normal(noise, 3 * v + 1, then)
                memory.fix[k, v, 0], memory.fix[k, v, 1] = at_x, at_y
            seen.fix[k, v] = not out and (tick[k] == 0 or tick[k] > e.latency)
            turn = e.bias_rad * normal(compass, v, 0) + e.heading_rad * normal(
                noise, 3 * v + 2, then
            )
            seen.pose[k, v, 0], seen.pose[k, v, 1] = memory.fix[k, v]
            seen.pose[k, v, 2] = yaw + turn
            vx += e.velocity_mps * normal(log, 2 * v, then)
            vy += e.velocity_mps * normal(log, 2 * v + 1, then)
            c, s = math.cos(turn), math.sin(turn)
            seen.velocity[k, v, 0], seen.velocity[k, v, 1] = c * vx - s * vy, s * vx + c * vy
            seen.velocity[k, v, 2] = rate


MEASURE = Launch(_measure)


@POSITIONING.register("gnss")
class Gnss:
    """Satellite positioning with slow errors, outages and latency; Doppler log, gyro, compass."""

    def __init__(self, sensors: Sensors, shape: tuple[int, int], tick_s: float) -> None:
        """Take the errors.

        Raises `UserError` if times are no whole number of ticks, or outages longer than the time
        between them.
        """
        latency = round(sensors.latency_s / tick_s)
        if abs(latency * tick_s - sensors.latency_s) > 1e-9:
            raise UserError(
                f"sensors.latency_s = {sensors.latency_s:g}: give a multiple of {tick_s:g} s"
            )
        if 0.0 < sensors.outage_s > sensors.outage_every_s - 2.0 * tick_s:
            raise UserError(
                f"sensors.outage_s = {sensors.outage_s:g} every {sensors.outage_every_s:g} s leaves"
                " no fix; give a longer sensors.outage_every_s"
            )
        self._errors = SensorErrors(
            sensors.position_noise_m,
            sensors.position_wander_m,
            sensors.position_memory_s,
            sensors.velocity_noise_mps,
            math.radians(sensors.heading_noise_deg),
            math.radians(sensors.compass_bias_deg),
            latency,
            tick_s,
        )
        self.errors = self._errors if sensors.filter else None
        self._outages = Outages(sensors.outage_s, sensors.outage_every_s, tick_s)
        past = np.zeros((shape[0], latency + 1, shape[1], 6))
        self._memory = Memory(past, np.zeros((*shape, 2)))

    def reset(self, rows: NDArray[np.int64]) -> None:
        """Forget some episodes."""
        for each in self._memory:
            each[rows] = 0.0

    def on_device(
        self,
        bind: Bind,
        keys: UInt64Array,
        tick: NDArray[np.int64],
        pose: FloatArray,
        velocity: FloatArray,
    ) -> tuple[tuple[Call, ...], Measured]:
        """`measure` by a kernel on a device: calls, and what they write."""
        pose_seen, velocity_seen = np.zeros((2, *pose.shape))
        seen = Measured(pose_seen, velocity_seen, np.zeros(pose.shape[:2], np.bool_))
        about = self._errors, self._outages, self._memory, keys, tick
        return (bind(MEASURE, *about, pose, velocity, seen),), seen

    def measure(
        self, keys: UInt64Array, tick: NDArray[np.int64], pose: FloatArray, velocity: FloatArray
    ) -> Measured:
        """Measurements at a tick."""
        seen = Measured(
            np.empty(pose.shape), np.empty(pose.shape), np.empty(pose.shape[:2], np.bool_)
        )
        _measure(self._errors, self._outages, self._memory, keys, tick, pose, velocity, seen)
        return seen
