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
    """Base of the inputs of formulas: caches results that several of them need."""

    def __init__(self) -> None:
        self._kept: dict[object, Any] = {}

    def cached(self, compute: Callable[[Any], _T]) -> _T:
        """Result of `compute(self)`, computed once; arrays are read-only."""
        if compute not in self._kept:
            self._kept[compute] = read_only(compute(self))
        found: _T = self._kept[compute]
        return found
