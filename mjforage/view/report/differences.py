"""A paired difference as tables and figures show it."""

import numpy as np
from numpy.typing import NDArray

from metrics import Interval, paired_difference
from mjforage.core.vocabulary import Metric
from mjforage.view.report.text_tables import NOTHING, number

SEED = 0  # of the bootstrap: a report made twice must be the same
FEWEST = 10  # episodes of an interval that may be bold: of fewer the bootstrap's is too narrow


def too_few(episodes: int) -> str:
    """Note for a page whose intervals are all of too few episodes; nothing for another."""
    if episodes >= FEWEST:
        return ""
    return f"Intervals from fewer than {FEWEST} episodes are too narrow; none is bold."


class Estimate:
    """A number with its 95 % interval, NaN where undefined."""

    def __init__(self, found: Interval, digits: int) -> None:
        self.value, self.low, self.high = float(found.value), float(found.low), float(found.high)
        self.n, self._digits = int(found.n), digits

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
    def cell(self) -> str:
        """Number and interval in one cell."""
        return f"{self.text} ({self.interval})"

    @property
    def apart(self) -> bool:
        """Whether the interval leaves out zero, and is of enough episodes to say so."""
        return self.n >= FEWEST and bool(self.low > 0 or self.high < 0)


class Difference(Estimate):
    """Mean of x - y over the episodes where both are defined, with its bootstrap interval."""

    def __init__(self, x: NDArray[np.float64], y: NDArray[np.float64], metric: Metric) -> None:
        """Compare x (episode,) with y (episode,), where entry i of both is the same episode."""
        super().__init__(paired_difference(x, y, SEED), metric.digits)
