"""Marginal Contribution over episodes, with its interval."""

import numpy as np
from numpy.typing import ArrayLike

from mjforage.metrics import statistics
from mjforage.metrics._checks import same_shape
from mjforage.metrics.intra_team import marginal_contribution
from mjforage.metrics.resampling import LEVEL, RESAMPLES, Interval, percentiles, resampled


def paired_contribution(
    full: ArrayLike,
    without: ArrayLike,
    seed: int,
    *,
    higher_is_better: bool,
    resamples: int = RESAMPLES,
    level: float = LEVEL,
) -> Interval:
    """Marginal Contribution of the means, paper "MC", with a paired percentile interval.

    A resample takes the same episodes of both, so that what an episode is worth cancels.

    Parameters
    ----------
    full, without : (episode,) performance of the whole team and without the agent, where entry i
        of both is the same episode; NaN = undefined, a pair needs both
    seed, resamples, level : as in `bootstrap`
    higher_is_better : as in `marginal_contribution`

    Returns
    -------
    Interval of single numbers; NaN where undefined, the ends also with fewer than two pairs

    Raises
    ------
    ValueError
        the shapes differ or are not (episode,), or as `bootstrap`.
    """
    whole, rest = statistics.defined(full), statistics.defined(without)
    same_shape("full", whole, "without", rest)
    if whole.ndim != 1:
        raise ValueError(f"full of shape {whole.shape}: (episode,) is needed")
    both = ~np.isnan(whole - rest)
    pairs = np.stack([whole[both], rest[both]])
    n = np.asarray(pairs.shape[1], dtype=np.int64)
    means = statistics.mean(pairs)
    value = marginal_contribution(means[0], means[1], higher_is_better=higher_is_better)
    low = high = np.nan
    if n >= 2:
        blocks = resampled([np.arange(int(n))], seed, resamples)
        drawn = np.concatenate([statistics.mean(pairs[:, block]) for block in blocks], axis=1)
        replicates = marginal_contribution(drawn[0], drawn[1], higher_is_better=higher_is_better)
        if np.isfinite(replicates).all():
            low, high = percentiles(replicates, level)
    return Interval(value, np.asarray(low), np.asarray(high), n)
