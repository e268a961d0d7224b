"""Resampled episodes, and percentile intervals of what is made from them."""

from collections.abc import Iterator

import numpy as np

from mjforage.metrics._checks import FloatArray, IntArray
from mjforage.metrics.intervals import LEVEL

RESAMPLES = 2000
_BLOCK = 1_000_000  # draws held in memory at once


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
    """Central interval with the share `level` of (resample,); ValueError if not in (0, 1).

    Efron and Tibshirani 1993, *An Introduction to the Bootstrap*, chapter 13.
    """
    if not 0.0 < level < 1.0:
        raise ValueError(f"level {level}: a share between 0 and 1 is needed, such as 0.95")
    low, high = np.quantile(replicates, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)
