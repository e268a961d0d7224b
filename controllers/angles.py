"""Angles on the circle."""

import math

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor


@kernel
def wrapped(angle: float) -> float:
    """The same angle in [-pi, pi] [rad]."""
    return angle - 2.0 * math.pi * floor(angle / (2.0 * math.pi) + 0.5)


@kernel
def clipped(value: float, low: float, high: float) -> float:
    """The value inside [low, high]."""
    return min(max(value, low), high)
