"""Descriptive statistics over episodes: mean, standard error, IQM.

Every function takes (..., episode), leaves undefined (NaN) episodes out and gives (...).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from mjforage.metrics._checks import FloatArray, IntArray, first, ratio

NORMAL_95 = 1.96
"""Half width of the paper's intervals in standard errors (its tables: mean +- 1.96 SEM)."""


def defined(values: ArrayLike) -> FloatArray:
    """Give `values` (..., episode) as floats.

    Raises
    ------
    ValueError
        For a single number or an infinity.
    """
    given = np.asarray(values, dtype=np.float64)
    if given.ndim == 0:
        raise ValueError(f"values {given}: an array (..., episode) is needed, not one number")
    if np.isinf(given).any():
        where = first(np.isinf(given))
        raise ValueError(f"values{list(where)} is {given[where]}; use NaN for undefined")
    return given


def count(values: ArrayLike) -> IntArray:
    """Number n (...) of episodes of (..., episode) where the value is defined.

    Raises
    ------
    ValueError
        As `defined`.
    """
    return np.asarray(np.sum(~np.isnan(defined(values)), axis=-1), dtype=np.int64)


def mean(values: ArrayLike) -> FloatArray:
    """Arithmetic mean (...) of (..., episode); NaN with n = 0.

    Raises
    ------
    ValueError
        As `defined`.
    """
    given = defined(values)
    return ratio(np.nansum(given, axis=-1), count(given))


def sem(values: ArrayLike) -> FloatArray:
    """Standard error (...) of the mean of (..., episode), s / sqrt(n) with s over n - 1.

    NaN with n < 2.

    Raises
    ------
    ValueError
        As `defined`.
    """
    given = defined(values)
    n = count(given)
    squares = np.nansum((given - mean(given)[..., None]) ** 2, axis=-1)
    return np.sqrt(ratio(squares, np.maximum(n - 1, 0) * n))


def stratified_sem(strata: Sequence[ArrayLike]) -> FloatArray:
    """Standard error of the mean of all defined values, of strata (episode,) with given shares.

    sqrt(sum of (n_i / n SEM_i)^2), such as of maps (Cochran 1977, *Sampling Techniques*, section
    5.3). Strata without a defined value are left out; NaN without any, or if one has n = 1.
    """
    counts = np.array([count(values) for values in strata])
    errors = np.array([sem(values) for values in strata])[counts > 0]
    shares = counts[counts > 0] / max(1, counts.sum())
    return np.asarray(np.sqrt(np.sum((shares * errors) ** 2)) if shares.size else np.nan)


def half_width_95(values: ArrayLike) -> FloatArray:
    """1.96 SEM (...) of (..., episode), the interval the paper prints; NaN with n < 2.

    Raises
    ------
    ValueError
        As `defined`.
    """
    return NORMAL_95 * sem(values)


def iqm(values: ArrayLike) -> FloatArray:
    """Interquartile mean (...) of (..., episode): without the floor(n / 4) lowest and highest.

    NaN with n = 0. Agarwal et al. 2021, "Deep Reinforcement Learning at the Edge of the Statistical
    Precipice", section 4.3.

    Raises
    ------
    ValueError
        As `defined`.
    """
    given = defined(values)
    n = count(given)[..., None]
    rank = np.arange(given.shape[-1])
    inner = (rank >= n // 4) & (rank < n - n // 4)
    total = np.sum(np.sort(given, axis=-1), axis=-1, where=inner)  # NaN sort last
    return ratio(total, np.sum(inner, axis=-1))
