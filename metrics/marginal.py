"""Marginal Contribution over episodes."""

import numpy as np
from numpy.typing import ArrayLike

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, same_shape
from mjforage.metrics.intra_team import marginal_contribution


def paired_contribution(
    full: ArrayLike, without: ArrayLike, *, higher_is_better: bool
) -> FloatArray:
    """Marginal Contribution of the means, paper "MC", as a mean of pairs: (episode,).

    Each entry is the contribution plus what its pair differs from it, to first order (delta method:
    Cochran 1977, *Sampling Techniques*, section 6.4). Their mean is the contribution itself, and
    their standard error that of the ratio.

    Parameters
    ----------
    full, without : (episode,) performance of the whole team and without the agent, where entry i
        of both is the same episode; NaN = undefined, a pair needs both
    higher_is_better : as in `marginal_contribution`

    Raises
    ------
    ValueError
        the shapes differ or are not (episode,), or a value is infinite.
    """
    whole, rest = statistics.defined(full), statistics.defined(without)
    same_shape("full", whole, "without", rest)
    if whole.ndim != 1:
        raise ValueError(f"full of shape {whole.shape}: (episode,) is needed")
    gain = whole - rest if higher_is_better else rest - whole
    of = np.where(np.isnan(gain), np.nan, whole if higher_is_better else rest)
    both = np.where(np.isnan(gain), np.nan, whole), np.where(np.isnan(gain), np.nan, rest)
    value = marginal_contribution(*map(statistics.mean, both), higher_is_better=higher_is_better)
    return np.asarray(value + (gain - value * of) / statistics.mean(of))
