"""What a check gives back: measures with their limits, and curves to draw."""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Float64Array: TypeAlias = NDArray[np.float64]

PASSED, FAILED, NOT_APPLICABLE = "passed", "failed", "does not apply"


@dataclass(frozen=True)
class Measure:
    """One number and the closed range that it has to lie in."""

    what: str
    value: float
    low: float  # -inf: no limit below
    high: float  # inf: no limit above
    unit: str  # empty for plain numbers

    @property
    def passed(self) -> bool:
        """Whether the number lies in its range; one that is not a number does not."""
        return bool(self.low <= self.value <= self.high)

    @property
    def strain(self) -> float:
        """How much of the range is used up: 0 in its middle, 1 at a limit; to rank measures."""
        if math.isnan(self.value):
            return math.inf
        if math.isinf(self.low) or math.isinf(self.high):
            value, limit = (
                (self.value, self.high) if math.isinf(self.low) else (self.low, self.value)
            )
            return value / limit if limit else float(value > 0.0)
        half = 0.5 * (self.high - self.low)
        off = abs(self.value - 0.5 * (self.high + self.low))
        return off / half if half else float(off > 0.0)

    @property
    def limit(self) -> str:
        """The range in words, without the unit."""
        if self.low == self.high:
            return f"{shown(self.low)}"
        if math.isinf(self.low):
            return f"at most {shown(self.high)}"
        if math.isinf(self.high):
            return f"at least {shown(self.low)}"
        return f"{shown(self.low)} to {shown(self.high)}"


def at_most(what: str, value: float, limit: float, unit: str = "") -> Measure:
    """A number with an upper limit."""
    return Measure(what, float(value), -math.inf, float(limit), unit)


def within(what: str, value: float, low: float, high: float, unit: str = "") -> Measure:
    """A number in a range."""
    return Measure(what, float(value), float(low), float(high), unit)


def near(what: str, value: float, expected: float, slack: float, unit: str = "") -> Measure:
    """A number at most `slack`, in its own unit, from an expected one."""
    return within(what, value, expected - slack, expected + slack, unit)


def near_share(what: str, value: float, expected: float, share: float, unit: str = "") -> Measure:
    """A number at most a share of an expected one away from it."""
    return near(what, value, expected, share * abs(expected), unit)


def shown(value: float) -> str:
    """A number with four digits, the way tables show it."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    return f"{value:.4g}" if 1e-3 <= abs(value) < 1e5 else f"{value:.1e}"


@dataclass(frozen=True)
class Line:
    """A curve: measured ones solid in the colour of their number, expected ones dashed.

    Expected ones are in ink, but in their colours where a panel has several labels of them.
    """

    label: str
    x: Float64Array  # (point,)
    y: Float64Array  # (point,)
    colour: int = 0
    expected: bool = False
    points: bool = False  # markers instead of a line


def dashed(label: str) -> Line:
    """Nothing but an entry in the legend: what the dashed lines are."""
    return Line(label, np.full(1, math.nan), np.full(1, math.nan), expected=True)


@dataclass(frozen=True)
class Span:
    """A range on the y axis at one place of the x axis, for published ranges."""

    x: float
    low: float
    high: float


@dataclass(frozen=True)
class Panel:
    """One pair of axes."""

    title: str
    x_label: str
    y_label: str
    lines: tuple[Line, ...]
    equal: bool = False  # same scale on both axes, for tracks
    log_x: bool = False
    log_y: bool = False
    spans: tuple[Span, ...] = ()
    span_label: str = ""
    x_names: tuple[str, ...] = ()  # of the places 0, 1, ... on the x axis


@dataclass(frozen=True)
class Finding:
    """Result of one check.

    Attributes
    ----------
    name : as `mjforage validate --check` takes it
    number : place in the list of checks of the validation report
    title : in a few words
    shows : what the check proves, and with what
    measures : empty if the check does not apply
    panels : curves to draw
    """

    name: str
    number: str
    title: str
    shows: str
    measures: tuple[Measure, ...]
    panels: tuple[Panel, ...] = ()

    @property
    def worst(self) -> Measure | None:
        """The measure nearest to its limit, or furthest beyond it."""
        return max(self.measures, key=lambda m: (not m.passed, m.strain), default=None)

    @property
    def status(self) -> str:
        """`passed`, `failed`, or `does not apply`."""
        if not self.measures:
            return NOT_APPLICABLE
        return PASSED if all(measure.passed for measure in self.measures) else FAILED
