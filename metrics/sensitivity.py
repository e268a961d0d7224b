"""Cooperation Sensitivity under Stochastic Corruption: how performance falls with corruption.

Equations: paper, "Inter-team metrics", "CSSC". The Sensitivity Slope is that of a least-squares
line through the means per corruption level; a continuous line of two segments shows whether
the decline begins, or steepens, at a critical level. Both fit batches at once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, first, ratio
from mjforage.metrics.resampling import RESAMPLES, percentiles, resampled


@dataclass(frozen=True, eq=False)
class Line:
    """A fitted straight line; every array is (...).

    Attributes
    ----------
    slope : Sensitivity Slope [performance per unit of corruption]
    intercept : fitted performance at level 0
    low, high : 95 % confidence interval of the slope (Student t, levels - 2 degrees)
    sse : sum of squared residuals
    """

    slope: FloatArray
    intercept: FloatArray
    low: FloatArray
    high: FloatArray
    sse: FloatArray


@dataclass(frozen=True, eq=False)
class TwoSegments:
    """A fitted continuous line of two segments; every array is (...).

    Attributes
    ----------
    break_point : level where the segments meet, strictly inside the levels
    height : fitted performance there
    slope_before, slope_after : [performance per unit of corruption]
    sse : sum of squared residuals
    """

    break_point: FloatArray
    height: FloatArray
    slope_before: FloatArray
    slope_after: FloatArray
    sse: FloatArray


def sensitivity_slope(levels: ArrayLike, means: ArrayLike) -> Line:
    """Least-squares line through the means, paper "SS".

    Parameters
    ----------
    levels : (level,) corruption eps, rising, at least 3
    means : (..., level) mean performance at each level

    Raises
    ------
    ValueError
        too few levels, levels that do not rise, shapes that do not fit, or an undefined mean.
    """
    x, y = _checked(levels, means, at_least=3)
    slope, intercept, sse = _line(x, y)
    spread = np.sum((x - x.mean()) ** 2)
    half = stdtrit(x.size - 2, 0.975) * np.sqrt(sse / (x.size - 2) / spread)
    return Line(slope, intercept, slope - half, slope + half, sse)


def two_segment_fit(levels: ArrayLike, means: ArrayLike) -> TwoSegments:
    """Best continuous two-segment line in the least-squares sense.

    Exact (Hudson 1966, J. Am. Stat. Assoc. 61): between two neighbouring levels the best break
    is where the separate lines of both sides cross, if they cross there; else it is on a level.
    Of equally good breaks the first is taken.

    Parameters
    ----------
    levels : (level,) corruption eps, rising, at least 5
    means : (..., level) mean performance at each level

    Raises
    ------
    ValueError
        as `sensitivity_slope`.
    """
    x, y = _checked(levels, means, at_least=5)
    found = [_crossing(x, y, i) for i in range(2, x.size - 1)]
    found += [_bent_at(x, y, i) for i in range(1, x.size - 1)]
    candidates = np.stack(found)  # (candidate, 5, ...)
    best = np.argmin(candidates[:, 4], axis=0)
    best_fit = np.take_along_axis(candidates, best[None, None], axis=0)[0]
    return TwoSegments(*best_fit)


@dataclass(frozen=True)
class SensitivityIntervals:
    """Bootstrap 95 % percentile intervals (low, high) of both fits; units as in those."""

    slope: tuple[float, float]
    break_point: tuple[float, float]
    slope_before: tuple[float, float]
    slope_after: tuple[float, float]


def bootstrap_sensitivity(
    levels: ArrayLike,
    values: ArrayLike,
    seed: int,
    *,
    same_episodes: bool = True,
    resamples: int = RESAMPLES,
) -> SensitivityIntervals:
    """Intervals of the slopes and the break point from resampled episodes.

    Parameters
    ----------
    levels : (level,) corruption eps, rising, at least 5
    values : (level, episode) performance, NaN = undefined, left out of the means
    seed : of the numpy Generator that draws the resamples
    same_episodes : True if episode i is the same world at every level; then a resample takes
        the same episodes at all levels
    resamples : number, at least 1; those without a defined episode at some level are left out

    Returns
    -------
    Intervals, NaN with a single episode, which says nothing of how far another would lie

    Raises
    ------
    ValueError
        as `two_segment_fit`, `values` is not (level, episode), or no resample is defined.
    """
    given = statistics.defined(values)
    if given.ndim != 2:
        raise ValueError(f"values of shape {given.shape}: (level, episode) is needed")
    _checked(levels, statistics.mean(given), at_least=5)
    means = _resampled_means(given, seed, same_episodes, resamples)
    line, bent = sensitivity_slope(levels, means), two_segment_fit(levels, means)
    if given.shape[1] < 2:
        return SensitivityIntervals(*[(np.nan, np.nan)] * 4)
    return SensitivityIntervals(
        percentiles(line.slope),
        percentiles(bent.break_point),
        percentiles(bent.slope_before),
        percentiles(bent.slope_after),
    )


def _resampled_means(
    values: FloatArray, seed: int, same_episodes: bool, resamples: int
) -> FloatArray:
    """Means (resample, level) of the resamples that are defined at every level."""
    episodes = [np.arange(values.shape[1])]
    means = np.empty((resamples, len(values)))
    for place, row in enumerate(values):
        # One seed for all levels draws the same episodes at each; else a stream per level.
        stream = seed if same_episodes else [seed, place]
        blocks = resampled(episodes, stream, resamples)
        means[:, place] = np.concatenate([statistics.mean(row[block]) for block in blocks])
    usable = means[np.isfinite(means).all(axis=1)]
    if len(usable) == 0:
        raise ValueError("no resample has a defined episode at every level; run more episodes")
    return usable


def _checked(levels: ArrayLike, means: ArrayLike, at_least: int) -> tuple[FloatArray, FloatArray]:
    x, y = np.asarray(levels, dtype=np.float64), np.asarray(means, dtype=np.float64)
    if x.ndim != 1 or x.size < at_least:
        raise ValueError(f"levels of shape {x.shape}: a list of at least {at_least} is needed")
    if not np.isfinite(x).all() or (np.diff(x) <= 0).any():
        raise ValueError(f"levels {x.tolist()}: finite and rising levels are needed")
    if y.ndim == 0 or y.shape[-1] != x.size:
        raise ValueError(f"means of shape {y.shape} do not fit {x.size} levels on the last axis")
    if not np.isfinite(y).all():
        where = first(~np.isfinite(y))
        raise ValueError(f"means{list(where)} is {y[where]}; leave undefined levels out")
    return x, y


def _line(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Slope, intercept and sum of squared residuals, each (...)."""
    centred = x - x.mean()
    slope = np.asarray(np.sum(y * centred, axis=-1) / np.sum(centred**2))
    intercept = np.asarray(y.mean(axis=-1) - slope * x.mean())
    residual = y - intercept[..., None] - slope[..., None] * x
    return slope, intercept, np.sum(residual**2, axis=-1)


def _crossing(x: FloatArray, y: FloatArray, i: int) -> FloatArray:
    """Separate lines of the first `i` points and the rest, (5, ...); sse inf if they miss."""
    before, start, sse_before = _line(x[:i], y[..., :i])
    after, end, sse_after = _line(x[i:], y[..., i:])
    at = ratio(start - end, after - before)
    between = (at >= x[i - 1]) & (at <= x[i])
    sse = np.where(between, sse_before + sse_after, np.inf)
    return np.stack([at, start + before * at, before, after, sse])


def _bent_at(x: FloatArray, y: FloatArray, i: int) -> FloatArray:
    """Best continuous line that bends at level `i`, (5, ...)."""
    left, right = np.minimum(x - x[i], 0), np.maximum(x - x[i], 0)  # orthogonal
    left_mean, right_mean = left.sum() / np.sum(left**2), right.sum() / np.sum(right**2)
    rest = 1.0 - left_mean * left - right_mean * right  # of a constant: orthogonal to both
    height = np.sum(y * rest, axis=-1) / np.sum(rest)
    slopes = []
    for side in (left, right):
        slopes.append(np.sum((y - height[..., None]) * side, axis=-1) / np.sum(side**2))
    before, after = slopes
    fit = height[..., None] + before[..., None] * left + after[..., None] * right
    sse = np.sum((y - fit) ** 2, axis=-1)
    return np.stack([np.full_like(sse, x[i]), height, before, after, sse])
