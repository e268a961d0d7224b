"""Failure of a conformance check, and several checks run as one."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.registry import fault

T = TypeVar("T")


class ConformanceError(AssertionError):
    """Failed check, in one sentence: demand, result and remedy.

    Attributes
    ----------
    check : name of the check that failed
    """

    def __init__(self, check: str, message: str) -> None:
        super().__init__(f"{check}: {message}")
        self.check = check


def run_checks(checks: Sequence[Callable[[T], None]], trial: T) -> None:
    """All checks, in their order.

    Raises
    ------
    ConformanceError
        Of the first that fails, or in which something else is raised.
    """
    for check in checks:
        try:
            check(trial)
        except ConformanceError:
            raise
        except UserError as error:  # says itself what to do
            name = check.__name__.removeprefix("check_")
            raise ConformanceError(name, str(error)) from error
        except Exception as error:
            name = check.__name__.removeprefix("check_")
            who = getattr(trial, "name", "")
            remedy = "copy what you change" if "read-only" in str(error) else "mend it"
            words = f"{who} raised {fault(error, _package(trial)) or fault(error)}; {remedy}"
            raise ConformanceError(name, words) from error


def _package(trial: object) -> str:
    """Top of the package of what is checked."""
    made = getattr(trial, "policy", None)
    module = getattr(made, "__module__", "") or str(getattr(trial, "name", "")).partition(":")[0]
    return module.partition(".")[0]


def first_difference(one: NDArray[np.generic], other: NDArray[np.generic]) -> str:
    """First bit that differs between two arrays of one shape, as text; "" if there is none."""
    if one.shape != other.shape or one.dtype != other.dtype:
        return f"{one.dtype} {one.shape} and {other.dtype} {other.shape}"
    same = (one == other) | ((one != one) & (other != other))
    wrong = np.argwhere(~np.atleast_1d(same))
    if not len(wrong):
        return ""
    place = tuple(int(i) for i in wrong[0])
    here, there = np.atleast_1d(one)[place], np.atleast_1d(other)[place]
    return f"{here!s} and {there!s} at {list(place)}"
