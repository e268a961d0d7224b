"""Paired differences that are read together, and the probability of improvement.

One statistic, the largest |t| of a family, gives intervals and p-values: they cannot disagree.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri

from mjforage.metrics import statistics
from mjforage.metrics._checks import FloatArray, IntArray, ratio
from mjforage.metrics.intervals import LEVEL

FEWEST = 10
"""Pairs that a difference needs: signs of fewer cannot tell many differences apart."""
FLIPS = 1999
POWER = 0.8
ROUNDING = 1e-9  # of |t|: one that is as large as that of a draw is no larger
_BLOCK = 2_000_000  # numbers held in memory at once


class Family(NamedTuple):
    """Mean differences that are read together; every array is (difference,).

    Attributes
    ----------
    value : mean
    low, high : simultaneous intervals: all of a family hold in 95 % of the families
    p : two-sided p-value of the mean being 0, corrected for the family
    n : pairs; with fewer than `FEWEST` interval and p are NaN
    """

    value: FloatArray
    low: FloatArray
    high: FloatArray
    p: FloatArray
    n: IntArray


def compared(differences: Sequence[ArrayLike]) -> Family:
    """Test mean differences against 0 together: max-t over flips of signs.

    Westfall and Young 1993, *Resampling-Based Multiple Testing*, section 2.3. In each of `FLIPS`
    draws all differences of an episode change their sign or none does, and the largest absolute t
    of the family is what every one is held against. Below p = 0.05, and only there, 0 is outside
    the interval. Signs are functions of episode and draw.

    Parameters
    ----------
    differences : (episode,) each, the same episode in the same place; NaN = undefined

    Raises
    ------
    ValueError
        an infinite value.
    """
    longest = max((len(one) for one in map(np.asarray, differences)), default=0)
    given = np.full((len(differences), longest), np.nan)
    for row, one in zip(given, differences, strict=True):
        row[: np.size(one)] = statistics.defined(one)
    n, value, sem = statistics.count(given), statistics.mean(given), statistics.sem(given)
    tested = np.flatnonzero(n >= FEWEST)
    largest = np.sort(_largest_t(given[tested]))
    p, half = np.full(n.shape, np.nan), np.full(n.shape, np.nan)
    t = _ratio_t(value, sem)[tested]
    p[tested] = _P[FLIPS - np.searchsorted(largest, t * (1 - ROUNDING))]
    with np.errstate(invalid="ignore"):  # inf * 0
        least = largest[FLIPS - np.sum(_P < 1 - LEVEL)] * (1 + 2 * ROUNDING)
        half[tested] = least * sem[tested]
    return Family(value, value - half, value + half, p, n)


def _p_values() -> FloatArray:
    """P-value by the number of draws that are as large, 0 to FLIPS: upper 99 % bound of its share.

    What the draws themselves leave open counts against a difference.
    """
    times = np.arange(FLIPS + 1)
    bound = times + ndtri(0.99) * np.sqrt(times * (1 - times / FLIPS))
    return np.asarray(np.minimum((1 + bound) / (1 + FLIPS), 1.0))


_P = _p_values()


def _ratio_t(mean: FloatArray, sem: FloatArray) -> FloatArray:
    """|t|, infinite where equal differences are not 0."""
    t = np.where(mean == 0, 0.0, np.inf)
    np.divide(np.abs(mean), sem, out=t, where=sem > 0)
    return t


def _largest_t(given: FloatArray) -> FloatArray:
    """Largest |t| of (difference, episode) in each draw of signs: (FLIPS,)."""
    largest, episodes = np.zeros(FLIPS), given.shape[1]
    random = np.random.Generator(np.random.Philox(key=1))
    signs = random.integers(0, 2, (episodes, FLIPS), dtype=np.int8)  # an episode more: a row more
    wide = max(1, _BLOCK // max(episodes, FLIPS))
    for start in range(0, len(given), wide):
        part = given[start : start + wide]
        n, block = statistics.count(part)[:, None], np.nan_to_num(part)
        squares = np.sum(block**2, axis=1, keepdims=True)  # no flip changes them
        for first in range(0, FLIPS, wide):
            drawn = slice(first, first + wide)
            mean = block @ (2.0 * signs[:, drawn] - 1.0) / n
            left = squares - n * mean**2
            sem = np.sqrt(np.where(left > 1e-12 * squares, left, 0.0) / (n * (n - 1)))
            largest[drawn] = np.maximum(largest[drawn], _ratio_t(mean, sem).max(axis=0))
    return largest


def episodes_needed(differences: ArrayLike, size: float) -> int | None:
    """Pairs with which a mean difference of `size` is found in 80 % of the runs.

    (1.96 + 0.84)^2 s^2 / size^2 + 1.96^2 / 2, of a two-sided paired t-test at the level 0.05, where
    s is the standard deviation of these pairs (Guenther 1981, Am. Stat. 35, 243-244).

    Parameters
    ----------
    differences : (episode,), NaN = undefined
    size : in the unit of the differences, above 0

    Returns
    -------
    None with fewer than `FEWEST` pairs, which do not tell s

    Raises
    ------
    ValueError
        size is not above 0, or a value is infinite.
    """
    n, sem = int(statistics.count(differences)), float(statistics.sem(differences))
    if not size > 0:
        raise ValueError(f"size {size}: a difference above 0 is needed")
    if n < FEWEST:
        return None
    level, power = ndtri((1 + LEVEL) / 2), ndtri(POWER)
    return int(np.ceil(n * ((level + power) * sem / size) ** 2 + level**2 / 2))


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
