"""Intervals of means of bounded, skewed values, and the tail of such values.

A t interval of a share such as PTA_C takes a rare failure that the sample lacks for impossible.
`mean_interval` allows for more episodes at either end of the metric.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import betaincinv, stdtrit

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, IntArray

LEVEL = 0.95
EXTRA = 1.5
"""Episodes at an end that a sample may lack: the least half that covers in the coverage table."""
TAIL = 0.05
"""Share of the episodes whose mean is `worst_mean`."""


class Interval(NamedTuple):
    """An estimate with its interval; every array is (...).

    Attributes
    ----------
    value : the statistic of the defined episodes
    low, high : ends of the interval; NaN where it is undefined
    n : number of defined episodes (or pairs of episodes)
    """

    value: FloatArray
    low: FloatArray
    high: FloatArray
    n: IntArray


def mean_interval(
    values: ArrayLike, least: ArrayLike = -np.inf, most: ArrayLike = np.inf
) -> Interval:
    """Mean with its 95 % interval, within the ends of the metric.

    The t interval (Student 1908), drawn out: each half width is the root of the sum of the squares
    of its own and of what `EXTRA` more episodes at that end would move the mean. Where all n
    episodes are alike, a share of 1 - 0.05^(1/n) of all may be at an end and go unseen (rule of
    three: Hanley and Lippman-Hand 1983, JAMA 249, 1743-1745). Values at both ends and nowhere else
    have the exact binomial interval (Clopper and Pearson 1934, Biometrika 26, 404-413).
    `tests/evidence/coverage.py` measures how often it covers.

    Parameters
    ----------
    values : (..., episode), NaN = undefined, left out
    least, most : (...) ends of the metric; infinite: unknown, and not drawn out there. A value
        beyond an end is the end

    Returns
    -------
    Interval, NaN with n < 2

    Raises
    ------
    ValueError
        an infinite value.
    """
    given = statistics.defined(values)
    n, mean = statistics.count(given), statistics.mean(given)
    bottom = np.fmin(least, np.fmin.reduce(given, axis=-1, initial=np.nan))
    top = np.fmax(most, np.fmax.reduce(given, axis=-1, initial=np.nan))
    half = stdtrit(np.maximum(n - 1, 1), (1 + LEVEL) / 2) * statistics.sem(given)
    unseen = np.where(half > 0, EXTRA / (n + 1), 1 - (1 - LEVEL) ** (1 / np.maximum(n, 1)))
    with np.errstate(invalid="ignore"):  # inf - inf
        down, up = (np.where(np.isfinite(x), unseen * (mean - x), 0.0) for x in (bottom, top))
        low = np.maximum(mean - np.hypot(half, down), bottom)
        high = np.minimum(mean + np.hypot(half, up), top)
    at_ends = (given == bottom[..., None]) | (given == top[..., None]) | np.isnan(given)
    binary = at_ends.all(axis=-1) & (half > 0) & np.isfinite(bottom) & np.isfinite(top)
    few, many = _shares(np.sum(given == top[..., None], axis=-1), n)
    with np.errstate(invalid="ignore"):
        low = np.where(binary, bottom + (top - bottom) * few, low)
        high = np.where(binary, bottom + (top - bottom) * many, high)
    low, high = (np.where(n < 2, np.nan, end) for end in (low, high))
    return Interval(mean, low, high, n)


def _shares(times: IntArray, n: IntArray) -> tuple[FloatArray, FloatArray]:
    """Clopper-Pearson ends (...) of a share seen `times` of n, not never or always."""
    k, tail = np.clip(times, 1, np.maximum(n - 1, 1)), (1 - LEVEL) / 2
    rest = np.maximum(n - k, 1)
    ends = betaincinv(k, rest + 1, tail), betaincinv(k + 1, rest, 1 - tail)
    return np.asarray(ends[0], np.float64), np.asarray(ends[1], np.float64)


def worst_mean(values: ArrayLike, better: int) -> FloatArray:
    """Mean (...) of the worst 5 % of (..., episode), at least of one; NaN with n = 0.

    Expected shortfall (Acerbi and Tasche 2002, J. Bank. Finance 26, 1487-1503).

    Parameters
    ----------
    better : 1 more, -1 less is better, 0 neither: NaN

    Raises
    ------
    ValueError
        an infinite value.
    """
    given = statistics.defined(values)
    number = np.ceil(TAIL * statistics.count(given))[..., None]
    worst = np.sort(better * given, axis=-1)  # NaN last
    kept = np.where(np.arange(given.shape[-1]) < number, better * worst, np.nan)
    return statistics.mean(kept) if better else np.full(given.shape[:-1], np.nan)
