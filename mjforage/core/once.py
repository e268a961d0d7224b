"""Work that several ask for, done once."""

from collections.abc import Callable
from typing import Any, TypeVar

from graph_planner.lending import read_only

_T = TypeVar("_T")


class Once:
    """Base of what formulas are given: keeps what several of them compute from it."""

    def __init__(self) -> None:
        self._kept: dict[object, Any] = {}

    def once(self, compute: Callable[[Any], _T]) -> _T:
        """`compute(self)`, or what it gave when it was asked for before; arrays read-only."""
        if compute not in self._kept:
            self._kept[compute] = read_only(compute(self))
        found: _T = self._kept[compute]
        return found
