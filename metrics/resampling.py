"""Bootstrap percentile intervals over episodes, plain or stratified.

Each row of a batch draws as if from its own generator with the same seed, so that an interval
depends neither on the other rows nor on their number.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, IntArray

Statistic = Callable[[FloatArray], FloatArray]
"""(..., episode) -> (...), such as `statistics.mean` or `statistics.iqm`."""

RESAMPLES = 2000
LEVEL = 0.95
_BLOCK = 1_000_000  # draws held in memory at once


@dataclass(frozen=True, eq=False)
class Interval:
    """An estimate with its interval; every array is (...).

    Attributes
    ----------
    value : the statistic of the defined episodes
    low, high : ends of the percentile interval; NaN with n < 2
    n : number of defined episodes (or pairs of episodes)
    """

    value: FloatArray
    low: FloatArray
    high: FloatArray
    n: IntArray


def bootstrap(
    values: ArrayLike,
    seed: int,
    *,
    statistic: Statistic = statistics.mean,
    strata: ArrayLike | None = None,
    resamples: int = RESAMPLES,
    level: float = LEVEL,
) -> Interval:
    """Percentile interval of a statistic (Efron and Tibshirani 1993, chapter 13).

    Parameters
    ----------
    values : (..., episode), NaN = undefined, left out
    seed : of the numpy Generator that draws the resamples
    statistic : of the last axis
    strata : (episode,) labels, for instance of maps; each stratum is resampled within itself
    resamples : number, at least 1
    level : coverage of the interval, in (0, 1)

    Raises
    ------
    ValueError
        an infinite value, strata of another length, no resample, or a level outside (0, 1).
    """
    given = statistics.defined(values)
    labels = _labels(strata, given.shape[-1])
    low, high = np.full(given.shape[:-1], np.nan), np.full(given.shape[:-1], np.nan)
    alike: dict[bytes, list[tuple[int, ...]]] = {}  # rows defined in the same episodes draw alike
    for row in np.ndindex(given.shape[:-1]):
        alike.setdefault((~np.isnan(given[row])).tobytes(), []).append(row)
    for mask, rows in alike.items():
        valid = np.frombuffer(mask, np.bool_)
        if valid.sum() < 2:
            continue
        found: dict[tuple[int, ...], list[FloatArray]] = {row: [] for row in rows}
        for block in resampled(_groups(labels[valid]), seed, resamples):
            for row in rows:
                found[row].append(statistic(given[row][valid][block]))
        for row in rows:
            low[row], high[row] = percentiles(np.concatenate(found[row]), level)
    return Interval(statistic(given), low, high, statistics.count(given))


def resampled(groups: list[IntArray], seed: int | list[int], resamples: int) -> Iterator[IntArray]:
    """Yield blocks (resample, episode) of indices, drawn with replacement within each group.

    `groups` holds the indices of each stratum. Raises ValueError without a resample.
    """
    if resamples < 1:
        raise ValueError(f"resamples {resamples}: at least 1 is needed")
    rng = np.random.default_rng(seed)
    block = max(1, _BLOCK // max(1, sum(len(group) for group in groups)))
    for start in range(0, resamples, block):
        rows = min(block, resamples - start)
        picks = [group[rng.integers(len(group), size=(rows, len(group)))] for group in groups]
        yield np.concatenate(picks, axis=1)


def percentiles(replicates: FloatArray, level: float = LEVEL) -> tuple[float, float]:
    """Central interval with the share `level` of (resample,); ValueError if not in (0, 1)."""
    if not 0.0 < level < 1.0:
        raise ValueError(f"level {level}: a share between 0 and 1 is needed, such as 0.95")
    low, high = np.quantile(replicates, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def _labels(strata: ArrayLike | None, episodes: int) -> IntArray:
    """Stratum number of each episode, (episode,)."""
    if strata is None:
        return np.zeros(episodes, dtype=np.int64)
    labels = np.asarray(strata)
    if labels.shape != (episodes,):
        raise ValueError(f"strata of shape {labels.shape}: one label per episode ({episodes},)")
    return np.unique(labels, return_inverse=True)[1].astype(np.int64)


def _groups(labels: IntArray) -> list[IntArray]:
    return [np.flatnonzero(labels == label) for label in np.unique(labels)]
