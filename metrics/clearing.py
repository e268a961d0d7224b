"""Times until a share of the items is collected, where some episodes never get there."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import bdtr

from mjforage.metrics._checks import FloatArray
from mjforage.metrics.intervals import LEVEL, Interval, mean_interval


def clearing_time(t_collected: ArrayLike, share: float) -> float:
    """Time until a share of all items is collected; infinite if it never is, NaN without items.

    Parameters
    ----------
    t_collected : (item,) time of each, infinite if never
    share : above 0, at most 1: of 10 items .9 are the first 9, .91 all

    Raises
    ------
    ValueError
        a share out of range.
    """
    if not 0.0 < share <= 1.0:
        raise ValueError(f"share {share}: give a number above 0, at most 1")
    times = np.sort(np.asarray(t_collected, np.float64))
    return float(times[int(np.ceil(share * len(times) - 1e-9)) - 1]) if len(times) else np.nan


def median_time(times: ArrayLike) -> Interval:
    """Median with its 95 % interval between two of the times, whatever their distribution.

    The ends are the order statistics whose ranks the binomial law gives (Conover 1999, *Practical
    Nonparametric Statistics*, section 3.2); NaN of fewer than 6 episodes, which have none.

    Parameters
    ----------
    times : (episode,), infinite where it never came to that, NaN where undefined
    """
    given = np.asarray(times, np.float64)
    found = np.sort(given[~np.isnan(given)])
    n = len(found)
    middle = _between(found[(n - 1) // 2], found[n // 2]) if n else np.nan
    rank = int(np.searchsorted(bdtr(np.arange(n), n, 0.5), (1.0 - LEVEL) / 2.0))
    low, high = (found[rank - 1], found[n - rank]) if rank else (np.nan, np.nan)
    return Interval(*map(np.asarray, (middle, low, high, n)))


def never_share(times: ArrayLike) -> Interval:
    """Share of the episodes (episode,) whose time is infinite, with its exact 95 % interval."""
    given = np.asarray(times, np.float64)
    never = np.where(np.isnan(given), np.nan, np.isinf(given))
    return mean_interval(never, 0.0, 1.0)


def _between(low: float, high: float) -> FloatArray:
    return np.asarray(high if np.isinf(high) else 0.5 * (low + high), np.float64)
