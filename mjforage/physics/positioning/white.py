"""White noise: independent errors of position and heading at every tick; velocity is exact."""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.base.randomness import Stream, UInt64Array, normal, stream_key
from mjforage.physics.positioning.model import POSITIONING, FloatArray, Measured
from mjforage.scenario.sensors import Sensors


@kernel
def _noisy(
    keys: UInt64Array,
    tick: NDArray[np.int64],
    position_m: float,
    heading_rad: float,
    pose: FloatArray,
    noisy: FloatArray,
) -> None:
    """Write poses with noise drawn from (episode, vessel, axis, tick)."""
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.SENSORS)
        for v in range(pose.shape[1]):
            for axis in range(3):
                spread = heading_rad if axis == 2 else position_m
                noise = spread * normal(key, 3 * v + axis, tick[e])
                noisy[e, v, axis] = pose[e, v, axis] + noise


NOISY = Launch(_noisy)


@POSITIONING.register("white")
class White:
    """Independent normal noise of position and heading at every tick."""

    errors = None

    def __init__(self, sensors: Sensors, shape: tuple[int, int], tick_s: float) -> None:
        """Take the noise."""
        self._position = sensors.position_noise_m
        self._heading_rad = math.radians(sensors.heading_noise_deg)
        self._exact = self._position == self._heading_rad == 0.0
        self._fix = np.ones(shape, np.bool_)

    def reset(self, rows: NDArray[np.int64]) -> None:
        """Nothing is remembered."""

    def on_device(
        self,
        bind: Bind,
        keys: UInt64Array,
        tick: NDArray[np.int64],
        pose: FloatArray,
        velocity: FloatArray,
    ) -> tuple[tuple[Call, ...], Measured]:
        """`measure` by a kernel on a device: calls, and what they write."""
        if self._exact:
            return (), Measured(pose, velocity, self._fix)
        noise, noisy = (self._position, self._heading_rad), np.zeros_like(pose)
        return (bind(NOISY, keys, tick, *noise, pose, noisy),), Measured(noisy, velocity, self._fix)

    def measure(
        self, keys: UInt64Array, tick: NDArray[np.int64], pose: FloatArray, velocity: FloatArray
    ) -> Measured:
        """Measurements at a tick."""
        if self._exact:
            return Measured(pose, velocity, self._fix)
        noisy = np.empty_like(pose)
        _noisy(keys, tick, self._position, self._heading_rad, pose, noisy)
        return Measured(noisy, velocity, self._fix)
