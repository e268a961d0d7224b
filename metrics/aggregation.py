"""Many runs of several tasks in one number or curve: normalised scores, profiles, Pareto fronts.

After Agarwal et al. 2021, "Deep Reinforcement Learning at the Edge of the Statistical Precipice",
NeurIPS 34, sections 4.1 to 4.3; intervals resample runs within their task.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, IntArray, ratio, same_shape
from mjforage.metrics.intervals import LEVEL, Interval
from mjforage.metrics.resampling import RESAMPLES, percentiles, resampled


def normalised(values: ArrayLike, floor: ArrayLike, ceiling: ArrayLike) -> FloatArray:
    """(value - floor) / (ceiling - floor): 0 at the floor, 1 at the ceiling, on any scale.

    Agarwal et al. 2021, section 2; where less is better the ceiling is the smaller number.

    Parameters
    ----------
    values, floor, ceiling : (...) that broadcast, in one unit; NaN = undefined

    Returns
    -------
    (...) NaN where floor and ceiling are equal
    """
    bottom = np.asarray(floor, dtype=np.float64)
    span = np.asarray(ceiling, dtype=np.float64) - bottom
    return ratio(np.asarray(values, dtype=np.float64) - bottom, np.where(span == 0, np.nan, span))


def resampled_means(
    values: ArrayLike, seed: int | list[int], *, resamples: int = RESAMPLES
) -> FloatArray:
    """Means over resampled episodes, the same ones in every row, so that rows stay paired.

    Parameters
    ----------
    values : (..., episode), NaN = undefined, left out of the means

    Returns
    -------
    (..., resample) NaN where a resample has no defined episode

    Raises
    ------
    ValueError
        an infinite value, or no resample.
    """
    given = statistics.defined(values)
    valid, filled = ~np.isnan(given), np.nan_to_num(given)
    times = _times(np.zeros(given.shape[-1], np.int64), seed, resamples)
    sums = np.einsum("...e,re->...r", filled, times)
    return ratio(sums, np.einsum("...e,re->...r", valid.astype(np.float64), times))


def performance_profile(
    values: ArrayLike,
    thresholds: ArrayLike,
    better: int,
    seed: int,
    *,
    strata: ArrayLike,
    resamples: int = RESAMPLES,
    level: float = LEVEL,
) -> Interval:
    """Share of runs that are as good as each threshold, with pointwise stratified intervals.

    Agarwal et al. 2021, section 4.2 (score distributions, also Dolan and More 2002); all runs weigh
    the same. A run without a value is as good as no threshold.

    Parameters
    ----------
    values : (run,), NaN = undefined
    thresholds : (threshold,) in the unit of the values
    better : 1 where more is better: share with value >= threshold; -1: share with value <= it
    strata : (run,) labels of the tasks; runs are resampled within theirs
    seed, resamples, level : of the percentile interval

    Returns
    -------
    Interval of (threshold,); n is the number of runs, those without a value included

    Raises
    ------
    ValueError
        values and strata differ in shape, better is neither 1 nor -1, an infinite value, no
        resample, or a level outside (0, 1).
    """
    runs, tau = statistics.defined(values), np.asarray(thresholds, dtype=np.float64)
    labels = np.asarray(strata)
    if runs.ndim != 1:
        raise ValueError(f"values of shape {runs.shape}: a flat list (run,) is needed")
    same_shape("values", runs, "strata", labels)
    if better not in (1, -1):
        raise ValueError(f"better {better}: give 1 where more is better, -1 where less is")
    reached = (better * runs[:, None] >= better * tau).astype(np.float64)
    number = np.full(tau.shape, runs.size, dtype=np.int64)
    value = ratio(reached.sum(axis=0), number)
    low, high = np.full(tau.shape, np.nan), np.full(tau.shape, np.nan)
    if runs.size > 1:
        groups = np.unique(labels, return_inverse=True)[1].astype(np.int64)
        shares = np.einsum("re,et->rt", _times(groups, seed, resamples), reached) / runs.size
        ends = [percentiles(column, level) for column in shares.T]
        low, high = np.array(ends, dtype=np.float64).reshape(-1, 2).T
    return Interval(value, low, high, number)


def _times(labels: IntArray, seed: int | list[int], resamples: int) -> FloatArray:
    """Counts of how often each run is drawn in each resample, within its group: (resample, run)."""
    groups = [np.flatnonzero(labels == label) for label in np.unique(labels)]
    rows = [
        np.bincount(picks, minlength=labels.size)
        for block in resampled(groups, seed, resamples)
        for picks in block
    ]
    return np.array(rows, dtype=np.float64)


def pareto_front(cost: ArrayLike, quality: ArrayLike) -> NDArray[np.bool_]:
    """Pareto front: True for those that no other dominates (no dearer, no worse, and different).

    Parameters
    ----------
    cost : (one,) less is better
    quality : (one,) more is better; one that is undefined (NaN) in either is on no front

    Raises
    ------
    ValueError
        the shapes differ.
    """
    spent, worth = np.asarray(cost, np.float64), np.asarray(quality, np.float64)
    same_shape("cost", spent, "quality", worth)
    known = ~(np.isnan(spent) | np.isnan(worth))
    cheaper = spent[None, :] <= spent[:, None]  # [i, j]: j costs no more than i
    as_good = worth[None, :] >= worth[:, None]
    unlike = (spent[None, :] < spent[:, None]) | (worth[None, :] > worth[:, None])
    return np.asarray(known & ~(cheaper & as_good & unlike).any(axis=1))
