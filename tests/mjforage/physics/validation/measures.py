"""Checks of the physics by name, each a function that returns measures with their limits."""

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

from mjforage.physics.vessel_checks import Measure, at_most

Measures: TypeAlias = list[Measure]

__all__ = ["CHECKS", "Check", "Measure", "Measures", "at_most", "check", "near", "near_share"]


class Check(NamedTuple):
    """A check; `number` is its place in the table, and several may share one, as 14a and 14b."""

    number: str
    measures: Callable[[], Measures]


CHECKS: dict[str, Check] = {}


def check(name: str, number: str) -> Callable[[Callable[[], Measures]], Callable[[], Measures]]:
    """Register a function as a check."""

    def register(function: Callable[[], Measures]) -> Callable[[], Measures]:
        CHECKS[name] = Check(number, function)
        return function

    return register


def near(what: str, value: float, expected: float, slack: float, unit: str = "") -> Measure:
    """A number at most `slack`, in its own unit, from an expected one."""
    return Measure(what, float(value), float(expected - slack), float(expected + slack), unit)


def near_share(what: str, value: float, expected: float, share: float, unit: str = "") -> Measure:
    """A number at most a share of an expected one away from it."""
    return near(what, value, expected, share * abs(expected), unit)


def utilisation(measure: Measure) -> float:
    """How much of the range is used: 0 in its middle, 1 at a limit; infinite for nan."""
    value, low, high = measure[1:4]
    if math.isnan(value):
        return math.inf
    if math.isinf(low):
        return value / high if high else float(value > 0.0)
    half, off = 0.5 * (high - low), abs(value - 0.5 * (high + low))
    return off / half if half else float(off > 0.0)
