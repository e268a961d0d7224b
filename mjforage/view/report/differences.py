"""Paired differences in tables and figures, and those that differ significantly from 0."""

import math
from collections.abc import Sequence

import numpy as np

from mjforage.metrics import Interval, holm, paired_difference, paired_p, statistics
from mjforage.mission.scoring import Description
from mjforage.view.page.table import NOTHING, Number
from mjforage.view.report.cells import (
    NORMAL_95,
    Cell,
    interval_cell,
    needed_digits,
    number,
    number_cell,
    span,
)
from mjforage.view.report.run_logs import FloatArray

SEED = 0  # of the bootstrap: a report made twice must be the same
LEVEL = 0.05  # of a whole family of tests
MANY = 500  # episodes from which an interval is the normal one
NORMAL = f"; of {MANY} episodes or more an interval is ± 1.96 SEM instead"
FEWEST = 10  # episodes of an interval that may be bold: of fewer the bootstrap's is too narrow


def too_few(episodes: int) -> str:
    """Note for a page whose intervals are all of too few episodes; nothing for another."""
    if episodes >= FEWEST:
        return ""
    return f"Intervals from fewer than {FEWEST} episodes are too narrow: no difference is bold."


class Estimate:
    """A number with its 95 % interval, NaN where undefined; both with the digits that it needs.

    Attributes
    ----------
    value, low, high, n : as of `metrics.Interval`
    p : of the test that the number is 0
    normal : True if the interval is ± 1.96 SEM, not the bootstrap's
    """

    normal = False

    def __init__(self, found: Interval, p: float, digits: int) -> None:
        self.value, self.low, self.high = float(found.value), float(found.low), float(found.high)
        self.n, self.p = int(found.n), p
        self._digits = needed_digits((self.high - self.low) / 2, digits)

    @property
    def number(self) -> Number:
        """Number and interval, unrounded."""
        return Number(self.value, self.low, self.high)

    @property
    def leaves_out_zero(self) -> bool:
        """True if the interval, as shown, excludes 0."""
        return round(self.low, self._digits) > 0 or round(self.high, self._digits) < 0

    def cell(self, best: bool = False, also: str = "") -> Cell:
        """Number and interval in one cell; a dash where undefined, no interval where that is."""
        text = interval_cell(self.number, self._digits).text if self.n else NOTHING
        return Cell(text, self.number, also, best)

    def cells(self, p: float, best: bool) -> tuple[Cell, Cell, Cell]:
        """The number, its interval, and a corrected p-value."""
        interval = Number(math.nan, self.low, self.high)
        words = span(self.low, self.high, self._digits) if math.isfinite(self.low) else NOTHING
        value = number_cell(self.value, self._digits, best=best)
        return value, Cell(words, interval), Cell(p_text(p), Number(p))


class Difference(Estimate):
    """Mean of x - y over the episodes where both are defined, with its bootstrap interval."""

    def __init__(self, x: FloatArray, y: FloatArray, metric: Description) -> None:
        """Compare x (episode,) with y (episode,), where entry i of both is the same episode."""
        self.normal = len(x) >= MANY
        found = _normal(x - y) if self.normal else paired_difference(x, y, SEED)
        super().__init__(found, float(paired_p(x, y)), metric.digits)


def _normal(differences: FloatArray) -> Interval:
    """Mean ± 1.96 SEM: of so many episodes the bootstrap's is no other, and takes a second each."""
    mean, half = statistics.mean(differences), NORMAL_95 * statistics.sem(differences)
    return Interval(mean, mean - half, mean + half, statistics.count(differences))


def corrected(family: Sequence[Estimate]) -> list[float]:
    """P-values of a family of estimates that are read together, by Holm; NaN where untested."""
    return [float(p) for p in holm([estimate.p for estimate in family])]


def set_apart(family: Sequence[Estimate]) -> list[bool]:
    """Members of a family that differ from 0, together at `LEVEL`, with enough episodes for it.

    What has 0 in the interval that is shown beside it is not one of them.
    """
    return [
        one.n >= FEWEST and p < LEVEL and one.leaves_out_zero
        for one, p in zip(family, corrected(family), strict=True)
    ]


def p_text(p: float) -> str:
    """A p-value as tables show it."""
    return "< 0.001" if p < 0.001 else number(p, 3)


def family_note(family: Sequence[Estimate], where: str = "this table", how: str = "bold") -> str:
    """Sentence on the tests of a family."""
    tests = sum(not np.isnan(one.p) for one in family)
    return (
        f"{how} where the interval leaves out 0 and it differs from 0 by paired t-tests at the "
        f"level {LEVEL:g}, corrected by Holm's method for the {tests} test"
        f"{'s' if tests != 1 else ''} of {where}"
        f"{NORMAL if any(one.normal for one in family) else ''}"
    )


def judged(lines: Sequence[Sequence[Estimate]]) -> list[list[Cell]]:
    """Cells of rows of estimates, tested as one family: bold where they differ from 0."""
    apart = iter(set_apart([one for line in lines for one in line]))
    return [[one.cell(next(apart)) for one in line] for line in lines]
