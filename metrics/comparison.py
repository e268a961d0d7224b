"""Two policies against each other: paired difference and probability of improvement."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metrics import statistics
from metrics._checks import FloatArray, IntArray, ratio, same_shape
from metrics.resampling import (
    LEVEL,
    RESAMPLES,
    Interval,
    Statistic,
    bootstrap,
    percentiles,
    resampled,
)


@dataclass(frozen=True, eq=False)
class Improvement:
    """Probability that a run of X beats one of Y, with its interval; every array is (...).

    Attributes
    ----------
    value : P(X > Y) + P(X = Y) / 2, in [0, 1]; NaN without a defined episode on both sides
    low, high : ends of the percentile interval; NaN with fewer than two episodes on a side
    n_x, n_y : number of defined episodes
    """

    value: FloatArray
    low: FloatArray
    high: FloatArray
    n_x: IntArray
    n_y: IntArray


def paired_difference(
    x: ArrayLike,
    y: ArrayLike,
    seed: int,
    *,
    statistic: Statistic = statistics.mean,
    strata: ArrayLike | None = None,
    resamples: int = RESAMPLES,
    level: float = LEVEL,
) -> Interval:
    """Interval of x - y where entry i of both is the same episode.

    Parameters
    ----------
    x, y : (..., episode), NaN = undefined; a pair needs both
    seed, statistic, strata, resamples, level : as in `bootstrap`, of the differences

    Raises
    ------
    ValueError
        the shapes differ, or as `bootstrap`.
    """
    first, second = statistics.defined(x), statistics.defined(y)
    same_shape("x", first, "y", second)
    return bootstrap(
        first - second,
        seed,
        statistic=statistic,
        strata=strata,
        resamples=resamples,
        level=level,
    )


def probability_of_improvement(
    x: ArrayLike,
    y: ArrayLike,
    seed: int,
    *,
    resamples: int = RESAMPLES,
    level: float = LEVEL,
) -> Improvement:
    """P(X > Y) + P(X = Y) / 2 over all pairs of runs, whichever episodes they are.

    Agarwal et al. 2021, "Deep Reinforcement Learning at the Edge of the Statistical Precipice",
    section 4.3; the interval resamples both sides independently.

    Parameters
    ----------
    x, y : (..., episode) with equal leading axes, NaN = undefined, left out
    seed, resamples, level : as in `bootstrap`

    Raises
    ------
    ValueError
        the leading axes differ, or as `bootstrap`.
    """
    first, second = statistics.defined(x), statistics.defined(y)
    if first.shape[:-1] != second.shape[:-1]:
        raise ValueError(f"x {first.shape} and y {second.shape}: leading axes must be equal")
    value = np.full(first.shape[:-1], np.nan)
    low, high = value.copy(), value.copy()
    for row in np.ndindex(value.shape):
        ranks_x, ranks_y, size = _ranks(first[row], second[row])
        value[row] = _wins(ranks_x[None], ranks_y[None], size)[0]
        if min(len(ranks_x), len(ranks_y)) < 2:
            continue
        draws_x = resampled([np.arange(len(ranks_x))], [seed, 0], resamples)
        draws_y = resampled([np.arange(len(ranks_y))], [seed, 1], resamples)
        picks_x, picks_y = np.concatenate(list(draws_x)), np.concatenate(list(draws_y))
        replicates = _wins(ranks_x[picks_x], ranks_y[picks_y], size)
        low[row], high[row] = percentiles(replicates, level)
    return Improvement(value, low, high, statistics.count(first), statistics.count(second))


def _ranks(x: FloatArray, y: FloatArray) -> tuple[IntArray, IntArray, int]:
    """Dense ranks of the defined values within both lists together, and their number."""
    kept_x, kept_y = x[~np.isnan(x)], y[~np.isnan(y)]
    levels, ranks = np.unique(np.concatenate([kept_x, kept_y]), return_inverse=True)
    ranks = ranks.astype(np.int64)
    return ranks[: kept_x.size], ranks[kept_x.size :], len(levels)


def _wins(x: IntArray, y: IntArray, size: int) -> FloatArray:
    """Share of pairs that x wins, a tie counting half: ranks (resample, episode) -> (resample,)."""
    pairs = x.shape[1] * y.shape[1]
    of_x, of_y = _histograms(x, size), _histograms(y, size)
    beaten = np.cumsum(of_y, axis=1) - 0.5 * of_y
    return ratio(np.sum(of_x * beaten, axis=1), pairs)


def _histograms(ranks: IntArray, size: int) -> IntArray:
    """How often each rank occurs in each resample, (resample, size)."""
    rows = np.arange(len(ranks))[:, None] * size
    counts = np.bincount((ranks + rows).ravel(), minlength=len(ranks) * size)
    return counts.reshape(len(ranks), size)
