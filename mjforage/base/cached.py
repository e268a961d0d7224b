"""Caches of results that several callers share."""

import logging
from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from mjforage.base.views import read_only

_T = TypeVar("_T")


@cache
def warn_once(line: str) -> None:
    """Log a line of warning, once in a process."""
    logging.getLogger(__name__).warning("%s", line)


class Cache:
    """Base of what formulas are given: keeps what several of them compute from it."""

    def __init__(self) -> None:
        self._kept: dict[object, Any] = {}

    def cached(self, compute: Callable[[Any], _T]) -> _T:
        """`compute(self)`, or what it gave when it was asked for before; arrays read-only."""
        if compute not in self._kept:
            self._kept[compute] = read_only(compute(self))
        found: _T = self._kept[compute]
        return found
