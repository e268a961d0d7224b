"""Overshoots and period of a zigzag, from the heading alone (IMO MSC.137(76), section 5.3.3)."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Float64Array = NDArray[np.float64]


def zigzag_figures(
    times: Float64Array, heading: Float64Array, angle: float
) -> tuple[list[float], float]:
    """Overshoots in their order, and the mean period.

    Parameters
    ----------
    times : (rows,) [s]
    heading : (rows,) from the heading at the first execute on [rad]
    angle : heading at which the thrust is reversed, either side [rad]

    Returns
    -------
    overshoots : angle of each swing beyond the ordered one [rad]; a swing that had not come back to
        a heading of 0 by the end does not count
    period : mean time between passing a heading of 0 in the same direction [s]; nan if it did not
        happen twice
    """
    passed = np.flatnonzero(heading[1:] * heading[:-1] < 0.0)
    before, after = heading[passed], heading[passed + 1]
    zeros = times[passed] - before * (times[passed + 1] - times[passed]) / (after - before)
    edges = np.concatenate(([0], passed + 1))
    swings = [heading[a:b] for a, b in pairwise(edges)]
    overshoots = [_peak(np.abs(swing)) - angle for swing in swings]
    reached = [size for size in overshoots if size >= 0.0]
    periods = zeros[2:] - zeros[:-2]
    return reached, float(periods.mean()) if periods.size else math.nan


def _peak(values: Float64Array) -> float:
    """Largest value, through the parabola of the three rows around it."""
    i = int(values.argmax())
    if not 0 < i < values.size - 1:
        return float(values[i])
    left, top, right = (float(value) for value in values[i - 1 : i + 2])
    bend = left - 2.0 * top + right
    return top - (right - left) ** 2 / (8.0 * bend) if bend else top
