"""A paired difference as tables and figures show it, and which of several are set apart from 0."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mjforage.metrics import Interval, holm, paired_difference, paired_p, statistics
from mjforage.mission.mission_metrics import Description
from mjforage.view.page.table import Number
from mjforage.view.report.text_tables import NORMAL_95, NOTHING, needed_digits, number

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
    normal : whether the interval is ± 1.96 SEM, not the bootstrap's
    """

    normal = False

    def __init__(self, found: Interval, p: float, digits: int) -> None:
        self.value, self.low, self.high = float(found.value), float(found.low), float(found.high)
        self.n, self.p = int(found.n), p
        self._digits = needed_digits((self.high - self.low) / 2, digits)

    @property
    def full(self) -> Number:
        """Number and interval, unrounded."""
        return Number(self.value, self.low, self.high)

    @property
    def split(self) -> tuple[Number, Number]:
        """The same for a cell with the number and one with the interval."""
        return Number(self.value), Number(float("nan"), self.low, self.high)

    @property
    def text(self) -> str:
        """The number."""
        return number(self.value, self._digits)

    @property
    def interval(self) -> str:
        """Its interval."""
        if not np.isfinite(self.low):
            return NOTHING
        return f"{number(self.low, self._digits)} to {number(self.high, self._digits)}"

    @property
    def leaves_out_zero(self) -> bool:
        """Whether its interval does, as it is shown."""
        return round(self.low, self._digits) > 0 or round(self.high, self._digits) < 0

    @property
    def cell(self) -> str:
        """Number and interval in one cell; a dash where undefined, no interval where that is."""
        if not self.n:
            return NOTHING
        if not np.isfinite(self.low):
            return self.text
        return f"{self.text} ({self.interval})"


class Difference(Estimate):
    """Mean of x - y over the episodes where both are defined, with its bootstrap interval."""

    def __init__(self, x: NDArray[np.float64], y: NDArray[np.float64], metric: Description) -> None:
        """Compare x (episode,) with y (episode,), where entry i of both is the same episode."""
        self.normal = len(x) >= MANY
        found = _normal(x - y) if self.normal else paired_difference(x, y, SEED)
        super().__init__(found, float(paired_p(x, y)), metric.digits)


def _normal(differences: NDArray[np.float64]) -> Interval:
    """Mean ± 1.96 SEM: of so many episodes the bootstrap's is no other, and takes a second each."""
    mean, half = statistics.mean(differences), NORMAL_95 * statistics.sem(differences)
    return Interval(mean, mean - half, mean + half, statistics.count(differences))


def corrected(family: Sequence[Estimate]) -> list[float]:
    """P-values of a family of estimates that are read together, by Holm; NaN where untested."""
    return [float(p) for p in holm([estimate.p for estimate in family])]


def set_apart(family: Sequence[Estimate]) -> list[bool]:
    """Which of a family differ from 0, together at `LEVEL`, and are of enough episodes for it.

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
    """Say how a family was tested."""
    tests = sum(not np.isnan(one.p) for one in family)
    return (
        f"{how} where the interval leaves out 0 and it differs from 0 by paired t-tests at the "
        f"level {LEVEL:g}, corrected by Holm's method for the {tests} test"
        f"{'s' if tests != 1 else ''} of {where}"
        f"{NORMAL if any(one.normal for one in family) else ''}"
    )
