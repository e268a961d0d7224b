"""Two policies against each other: paired difference, its significance, probability of improvement.

Several differences that are read together are one family; `holm` corrects for their number.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtr

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, ratio, same_shape
from mjforage.metrics._checks import first as first_index
from mjforage.metrics.resampling import LEVEL, RESAMPLES, Interval, Statistic, bootstrap


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


def paired_p(x: ArrayLike, y: ArrayLike) -> FloatArray:
    """Two-sided p-value of the paired t-test (Student 1908) that the mean of x - y is 0.

    With n pairs it is never below 2^(1 - n), the least that flipping the signs of the differences
    can give, so that equal differences of a few pairs are no certainty.

    Parameters
    ----------
    x, y : (..., episode), NaN = undefined; a pair needs both

    Returns
    -------
    (...) NaN with fewer than two pairs

    Raises
    ------
    ValueError
        the shapes differ, or a value is infinite.
    """
    first, second = statistics.defined(x), statistics.defined(y)
    same_shape("x", first, "y", second)
    differences = first - second
    n, size = statistics.count(differences), np.abs(statistics.mean(differences))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(size == 0.0, 0.0, size / statistics.sem(differences))
    p = np.maximum(2.0 * stdtr(np.maximum(n - 1, 1), -t), 2.0 ** (1.0 - n))
    return np.where(n < 2, np.nan, np.minimum(p, 1.0))


def holm(p: ArrayLike) -> FloatArray:
    """P-values corrected for their number; below a level, they are wrong together at most so often.

    Holm 1979, "A Simple Sequentially Rejective Multiple Test Procedure", Scand. J. Stat. 6, 65-70:
    of m values the i-th smallest is multiplied by m - i + 1, and none is below one that is smaller.

    Parameters
    ----------
    p : (test,) a family; NaN = not tested, not counted

    Returns
    -------
    (test,) in [0, 1]; NaN where p is

    Raises
    ------
    ValueError
        p is not a flat list of numbers from 0 to 1.
    """
    given = np.asarray(p, dtype=np.float64)
    if given.ndim != 1:
        raise ValueError(f"p of shape {given.shape}: a flat list (test,) is needed")
    wrong = (given < 0) | (given > 1)
    if wrong.any():
        where = first_index(wrong)
        raise ValueError(f"p{list(where)} is {given[where]}; a probability is from 0 to 1")
    order = np.argsort(given, kind="stable")[: int(np.sum(~np.isnan(given)))]
    raised = given[order] * np.arange(order.size, 0, -1)
    corrected = np.full(given.shape, np.nan)
    corrected[order] = np.minimum(np.maximum.accumulate(raised), 1.0)
    return corrected


def probability_of_improvement(x: ArrayLike, y: ArrayLike) -> FloatArray:
    """P(X > Y) + P(X = Y) / 2 over all pairs of runs, whichever episodes they are.

    Agarwal et al. 2021, "Deep Reinforcement Learning at the Edge of the Statistical Precipice",
    section 4.3.

    Parameters
    ----------
    x, y : (..., episode) with equal leading axes, NaN = undefined, left out

    Returns
    -------
    (...) in [0, 1]; NaN without a defined episode on both sides

    Raises
    ------
    ValueError
        the leading axes differ, or a value is infinite.
    """
    first, second = statistics.defined(x), statistics.defined(y)
    if first.shape[:-1] != second.shape[:-1]:
        raise ValueError(f"x {first.shape} and y {second.shape}: leading axes must be equal")
    wins = np.empty(first.shape[:-1])
    for row in np.ndindex(wins.shape):
        ours = first[row][~np.isnan(first[row])]
        theirs = np.sort(second[row][~np.isnan(second[row])])
        below, up_to = (np.searchsorted(theirs, ours, side) for side in ("left", "right"))
        wins[row] = 0.5 * (below.sum() + up_to.sum())
    return ratio(wins, statistics.count(first) * statistics.count(second))
