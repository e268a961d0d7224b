"""Measured position and heading of vessels, with noise."""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, UInt64Array, normal, stream_key
from mjforage.scenario.scenario import Sensors

FloatArray = NDArray[np.float64]


@kernel
def _noisy(
    keys: UInt64Array,
    tick: NDArray[np.int64],
    position_m: float,
    heading_rad: float,
    pose: FloatArray,
) -> FloatArray:
    """Poses with noise drawn from (episode, vessel, axis, tick)."""
    result = np.empty_like(pose)
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.SENSORS)
        for v in range(pose.shape[1]):
            for axis in range(3):
                spread = heading_rad if axis == 2 else position_m
                noise = spread * normal(key, 3 * v + axis, tick[e])
                result[e, v, axis] = pose[e, v, axis] + noise
    return result


def measured_poses(
    sensors: Sensors, keys: UInt64Array, tick: NDArray[np.int64], pose: FloatArray
) -> FloatArray:
    """Poses as the controllers see them: independent normal noise at every tick.

    Parameters
    ----------
    keys, tick : (episode,) episode keys, control ticks since the start
    pose : (episode, vessel, 3) x, y [m], yaw [rad]
    """
    heading = math.radians(sensors.heading_noise_deg)
    if sensors.position_noise_m == 0.0 and heading == 0.0:
        return pose
    return np.asarray(_noisy(keys, tick, sensors.position_noise_m, heading, pose))
