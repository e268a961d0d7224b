"""Directions in degrees, signed or not; a wind's is where it is from, a current's where it goes."""

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from mjforage.base.fields import Within

Bearing = Annotated[float, Within(-360, 360, "deg")]
"""A direction in a file; -90 is 270."""


def direction(degrees: float) -> float:
    """The direction of so many degrees [rad], from 0 on and below a turn: one for -90 and 270."""
    return math.radians(degrees % 360.0)


def wind_direction(from_deg: float) -> float:
    """Direction, counter-clockwise from east [rad], of a wind from a compass bearing [deg]."""
    return math.radians(270.0 - from_deg % 360.0)


def flow_direction(to_deg: float) -> float:
    """Direction, counter-clockwise from east [rad], of a current to a compass bearing [deg]."""
    return wind_direction(to_deg + 180.0)


def bearing_of(xy: NDArray[np.float64], north_deg: float = 0.0) -> NDArray[np.float64]:
    """(...,) compass bearing [deg] to which vectors (..., 2) point, NaN for one of no length.

    `north_deg`: bearing of the y axis.
    """
    bearing = (np.degrees(np.arctan2(xy[..., 0], xy[..., 1])) + north_deg) % 360.0
    found: NDArray[np.float64] = np.where(xy.any(axis=-1), bearing, np.nan)
    return found
