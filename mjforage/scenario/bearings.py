"""Directions in degrees, signed or not; a wind's is where it is from, a current's where it goes."""

import math
from typing import Annotated

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
