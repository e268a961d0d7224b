"""Paired differences in tables and figures, and those that differ significantly from 0."""

import math
from collections.abc import Hashable, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple, TypeVar

import numpy as np

from mjforage.metrics import FEWEST, compared
from mjforage.view.page.table import NOTHING, Number
from mjforage.view.report.cells import (
    Cell,
    interval_cell,
    needed_digits,
    number,
    number_cell,
    span,
)
from mjforage.view.report.run_logs import FloatArray

Name = TypeVar("Name", bound=Hashable)

SEED = 0  # of what is resampled: a report made twice must be the same
LEVEL = 0.05  # of a whole family of tests
HOW = "paired max-t tests"


def too_few(episodes: int) -> str:
    """Note for a page whose differences are all of too few episodes; nothing for another."""
    if episodes >= FEWEST:
        return ""
    return f"Differences of fewer than {FEWEST} episodes have no interval, and none is bold."


class Estimate(NamedTuple):
    """A mean difference of a family, NaN where undefined, with the digits that it needs.

    Attributes
    ----------
    value, low, high, p, n : as of `metrics.Family`
    usual : digits of the metric
    """

    value: float
    low: float
    high: float
    p: float
    n: int
    usual: int

    @property
    def digits(self) -> int:
        """Decimals that its interval needs."""
        return needed_digits((self.high - self.low) / 2, self.usual)

    @property
    def number(self) -> Number:
        """Number and interval, unrounded."""
        return Number(self.value, self.low, self.high)

    @property
    def apart(self) -> bool:
        """True if it differs from 0, and its interval as shown leaves 0 out."""
        out = round(self.low, self.digits) > 0 or round(self.high, self.digits) < 0
        return self.p < LEVEL and out

    def cell(self, also: str = "") -> Cell:
        """Number and interval in one cell; a dash where undefined, no interval where that is."""
        text = interval_cell(self.number, self.digits).text if self.n else NOTHING
        return Cell(text, self.number, also, self.apart)

    @property
    def cells(self) -> tuple[Cell, Cell, Cell]:
        """The number, its interval, and its p-value."""
        interval = Number(math.nan, self.low, self.high)
        words = span(self.low, self.high, self.digits) if math.isfinite(self.low) else NOTHING
        value = number_cell(self.value, self.digits, best=self.apart)
        return value, Cell(words, interval), Cell(p_text(self.p), Number(self.p))


def estimates(differences: Sequence[tuple[FloatArray, int]]) -> list[Estimate]:
    """Differences (episode,) with the digits of their metrics, tested as one family."""
    found = compared([values for values, _ in differences])
    columns = [column.tolist() for column in found]
    digits = [digits for _, digits in differences]
    return [Estimate(*one) for one in zip(*columns, digits, strict=True)]


def pairs(values: Mapping[Name, FloatArray], digits: int = 0) -> dict[tuple[Name, Name], Estimate]:
    """(one, other) -> one - other, and back, of every two (episode,) of some, as one family."""
    two = list(combinations(values, 2))
    found = estimates([(values[one] - values[other], digits) for one, other in two])
    there = dict(zip(two, found, strict=True))
    back = {
        (other, one): gap._replace(value=-gap.value, low=-gap.high, high=-gap.low)
        for (one, other), gap in there.items()
    }
    return there | back


def p_text(p: float) -> str:
    """A p-value as tables show it."""
    return "< 0.001" if p < 0.001 else number(p, 3)


def family_note(family: Sequence[Estimate], where: str = "this table", how: str = "bold") -> str:
    """Sentence on the tests of a family."""
    tests = sum(not np.isnan(one.p) for one in family)
    return (
        f"{how} where it differs from 0 at the level {LEVEL:g} ({HOW}); intervals and p hold for "
        f"the {tests} difference{'s' if tests != 1 else ''} of {where} together"
    )


def judged(lines: Sequence[Sequence[tuple[FloatArray, int]]]) -> list[list[Estimate]]:
    """Rows of differences as of `estimates`, tested as one family."""
    every = iter(estimates([one for line in lines for one in line]))
    return [[next(every) for _ in line] for line in lines]
