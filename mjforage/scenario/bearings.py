"""Directions in degrees, signed or not."""

import math
from typing import Annotated

from mjforage.base.fields import Within

Bearing = Annotated[float, Within(-360, 360, "deg")]
"""A direction in a file; -90 is 270."""


def direction(degrees: float) -> float:
    """The direction of so many degrees [rad], from 0 on and below a turn: one for -90 and 270."""
    return math.radians(degrees % 360.0)
