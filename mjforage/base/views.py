"""Read-only views of arrays, for policies, bounds, metrics, reward terms and encoders."""

from typing import Any, Generic, TypeVar, cast

import numpy as np

T = TypeVar("T")


def view_of(array: T) -> T:
    """A view of an array that cannot be written.

    It is of a read-only buffer, so numpy refuses `setflags(write=True)` as well.
    """
    content: Any = array
    return cast(T, np.asarray(memoryview(content).toreadonly()))


def read_only(value: T) -> T:
    """Read-only views of an array, or of all arrays in a tuple; other values as they are."""
    if isinstance(value, np.ndarray):
        return view_of(value)
    if isinstance(value, tuple):
        parts = map(read_only, value)
        make = getattr(type(value), "_make", tuple)  # a named tuple's
        return cast(T, make(parts))
    return value


class CachedViews(Generic[T]):
    """Read-only views, made once for the same arrays; a copy makes views of its own."""

    def __init__(self) -> None:
        self._of: object = None
        self._views: T | None = None

    def of(self, arrays: T) -> T:
        """Views of a tuple of arrays (or of one)."""
        if self._of is not arrays:
            self._of, self._views = arrays, read_only(arrays)
        return cast(T, self._views)

    def __reduce__(self) -> tuple[Any, ...]:
        """No views: they would be of other arrays."""
        return CachedViews, ()
