"""The constant part of wind, current and drift of an episode, from its key alone."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import Stream, UInt64Array, stream_key, uniform
from mjforage.scenario.bearings import flow_direction, wind_direction
from mjforage.scenario.scenario import Weather

LEEWAY = 0.03  # of the wind, at which an item drifts by the paper's rule
_DIRECTION = 1000  # step of a drawn direction in its stream, away from the other draws
_SPEED = 1001  # step of a drawn speed
FloatArray = NDArray[np.float64]


class SteadyWind(NamedTuple):
    """Mean wind of episodes, and the drift of an item by the paper's rule: one vector twice."""

    wind_mps: FloatArray  # (episode, 2) in (x, y)
    drift_rc: FloatArray  # (episode, 2) in (row, column) [node/step]


@kernel
def steady_vector(
    key: np.uint64, stream: int, mean: float, spread: float, direction: float
) -> tuple[float, float]:
    """Vector (x, y) of an episode, of a speed uniform in `mean` times 1 +- `spread`.

    A direction that is NaN is drawn, uniform over the circle.
    """
    own = stream_key(key, stream)
    angle, draw = direction, uniform(own, 0, _SPEED)
    speed = mean * (1.0 + spread * (2.0 * draw - 1.0))
    if math.isnan(angle):
        angle = 2.0 * math.pi * uniform(own, 0, _DIRECTION)
    return speed * math.cos(angle), speed * math.sin(angle)


@kernel
def _steady_vectors(
    keys: UInt64Array, stream: int, mean: float, spread: float, direction: float
) -> FloatArray:
    """Vectors (episode, 2) in (x, y), see `steady_vector`."""
    result = np.empty((keys.size, 2))
    for e in range(keys.size):
        result[e, 0], result[e, 1] = steady_vector(keys[e], stream, mean, spread, direction)
    return result


@kernel
def _drawn(keys: UInt64Array) -> FloatArray:
    """Vectors (episode, 2) in (row, column), uniform in +-1 on each axis."""
    result = np.empty((keys.size, 2))
    for e in range(keys.size):
        for axis in range(2):
            draw = uniform(stream_key(keys[e], Stream.WEATHER), axis, 0)
            result[e, axis] = 2.0 * draw - 1.0
    return result


def to_xy(rc: FloatArray) -> FloatArray:
    """Vectors (..., 2) in (row, column) as (x, y)."""
    return np.stack((rc[..., 1], -rc[..., 0]), axis=-1)


def to_rc(xy: FloatArray) -> FloatArray:
    """Vectors (..., 2) in (x, y) as (row, column)."""
    return np.stack((-xy[..., 1], xy[..., 0]), axis=-1)


def steady_wind(
    keys: UInt64Array, weather: Weather, node_mps: float, north_deg: float = 0.0
) -> SteadyWind:
    """Mean wind that a scenario gives, or the one that drives the paper's drift.

    Parameters
    ----------
    keys : (episode,)
    node_mps : speed of a node per decision [m/s]
    north_deg : bearing of the map's y axis, clockwise from true north
    """
    speed, origin = weather.wind_speed_mps, weather.wind_from_deg
    if speed is not None:
        toward = math.nan if origin is None else wind_direction(origin - north_deg)
        wind = _steady_vectors(keys, Stream.WEATHER, speed, weather.wind_spread, toward)
        return SteadyWind(wind, LEEWAY / node_mps * to_rc(wind))
    least, largest = np.array(weather.drift_ranges, np.float64).T
    half, middle, drawn = (largest - least) / 2, (largest + least) / 2, _drawn(keys)
    wind_rc = (middle * node_mps + half * node_mps * drawn) / LEEWAY
    return SteadyWind(to_xy(wind_rc), middle + half * drawn)


def steady_current(keys: UInt64Array, weather: Weather, north_deg: float = 0.0) -> FloatArray:
    """(episode, 2) constant part of the free stream in (x, y) [m/s]; see `steady_wind`."""
    to = weather.current_to_deg
    toward = math.nan if to is None else flow_direction(to - north_deg)
    about = weather.current_speed_mps, weather.current_spread, toward
    return _steady_vectors(keys, Stream.CURRENT, *about)
