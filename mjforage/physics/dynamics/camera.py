"""Bow camera by which a vessel sees items to collect: errors, frames, field of view.

The error of an item's place has two parts: a normal one of the same size at any range, for where
the middle of a floating item is, and along the line of sight one that grows with the square of the
range, as a stereo pair's depth does for an error in disparity.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, normal, stream_key
from mjforage.physics.dynamics.ticks import CONTROL_S, whole_times
from mjforage.scenario.sensors import Sensors

FloatArray = NDArray[np.float64]


class Camera(NamedTuple):
    """Field of view and errors of a camera, and errors of its vessel's own pose."""

    noise_m: float  # standard deviation per axis, at any range
    depth_per_m: float  # times the range squared: of the range, beyond that [1/m]
    half_view_rad: float  # about the bow
    range_m: float
    position_m: float  # standard deviation of the vessel's own fix, per axis
    heading_rad: float  # and of its compass
    period: int  # control ticks from frame to frame
    latency: int  # control ticks from a frame to what was seen in it


def camera_of(sensors: Sensors, period: int, latency: int) -> Camera:
    """The camera of a scenario; `period`, `latency`: [control ticks]."""
    return Camera(
        sensors.camera_noise_m,
        sensors.camera_range_noise_per_m,
        math.radians(0.5 * sensors.camera_fov_deg),
        sensors.camera_range_m,
        sensors.position_noise_m,
        math.radians(sensors.heading_noise_deg),
        period,
        latency,
    )


def ticked_camera(sensors: Sensors) -> Camera:
    """The camera of a scenario; raises `UserError` if its times are no whole numbers of ticks."""
    period, latency = sensors.camera_period_s, sensors.camera_latency_s
    return camera_of(
        sensors,
        whole_times(period, CONTROL_S, f"sensors.camera_period_s = {period:g} s"),
        whole_times(latency, CONTROL_S, f"sensors.camera_latency_s = {latency:g} s", 0),
    )


@kernel
def variance(camera: Camera, far: float) -> float:
    """Variance of a sighting at a range, mean of both axes [m2], own fix and compass included."""
    depth, turn = camera.depth_per_m * far * far, camera.heading_rad * far
    return camera.noise_m**2 + camera.position_m**2 + 0.5 * (depth * depth + turn * turn)


@kernel
def sight_items(
    camera: Camera,
    key: np.uint64,
    tick: int,
    v: int,
    true_pose: FloatArray,
    pose: FloatArray,
    xy: FloatArray,
    item_node: NDArray[np.int32],
    seen: FloatArray,
) -> None:
    """One frame of vessel `v`: places of the items in view, errors drawn from (vessel, item, tick).

    Parameters
    ----------
    key : of the episode
    true_pose, pose : (vessel, 3) as it is and as the vessel measures it [m], [rad]
    xy, item_node : (item, 2) [m], (item,) below 0 if not afloat
    seen : (vessel, item, 2) written: where the vessel takes them to be [m], NaN if not in view
    """
    stream, vessels = stream_key(key, Stream.CAMERA), true_pose.shape[0]
    c, s = math.cos(pose[v, 2]), math.sin(pose[v, 2])
    bow_x, bow_y = math.cos(true_pose[v, 2]), math.sin(true_pose[v, 2])
    for k in range(item_node.size):
        seen[v, k] = np.nan
        dx, dy = xy[k, 0] - true_pose[v, 0], xy[k, 1] - true_pose[v, 1]
        far = math.hypot(dx, dy)
        if item_node[k] < 0 or far > camera.range_m:
            continue
        off = math.atan2(bow_x * dy - bow_y * dx, bow_x * dx + bow_y * dy)
        if abs(off) > camera.half_view_rad:
            continue
        number = 2 * (k * vessels + v)
        depth = math.hypot(camera.noise_m, camera.depth_per_m * far * far)
        ahead = far + depth * normal(stream, number, tick)
        aside = camera.noise_m * normal(stream, number + 1, tick)
        along, across = math.cos(off), math.sin(off)
        x, y = ahead * along - aside * across, ahead * across + aside * along
        seen[v, k, 0] = pose[v, 0] + c * x - s * y
        seen[v, k, 1] = pose[v, 1] + s * x + c * y
