"""Scatter of rows: episodes of one batch replaced by those of another."""

from collections.abc import Collection
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T", bound=np.generic)
Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


def scatter_rows(
    into: NDArray[T], rows: NDArray[np.int64], values: NDArray[T], fill: float = 0
) -> NDArray[T]:
    """A copy of `into` (episode, ...) with `values` (row, ...) at `rows`.

    Where an axis beyond the first differs in size (items, padded to the largest episode), the
    narrower side is padded with `fill`.
    """
    if into.shape[1:] != values.shape[1:]:
        shape = np.maximum(into.shape[1:], values.shape[1:])
        into, values = _padded(into, shape, fill), _padded(values, shape, fill)
    result = into.copy()
    result[rows] = values
    return result


def put_rows(
    into: NDArray[T], rows: NDArray[np.int64], values: NDArray[T], fill: float = 0
) -> NDArray[T]:
    """`scatter_rows`, in `into` itself if values are no wider and it may be written."""
    if not into.flags.writeable or np.any(np.less(into.shape[1:], values.shape[1:])):
        return scatter_rows(into, rows, values, fill)
    into[rows] = _padded(values, np.array(into.shape[1:], np.int64), fill)
    return into


def _padded(array: NDArray[T], shape: NDArray[np.int64], fill: float) -> NDArray[T]:
    """As wide as `shape` beyond the first axis."""
    more = np.subtract(shape, array.shape[1:])
    return np.pad(array, [(0, 0), *((0, n) for n in more)], constant_values=fill)


def scatter_all(
    into: Arrays,
    rows: NDArray[np.int64],
    values: Arrays,
    nobody: Collection[str] = (),
    only: Collection[str] = (),
) -> Arrays:
    """`scatter_rows` for the arrays of a named tuple, in their memory where it has the width.

    Parameters
    ----------
    nobody : fields that are filled with -1
    only : fields that have rows, where others have none; empty: all
    """
    kind: Any = type(into)
    each = zip(kind._fields, into, values, strict=True)
    mixed: Arrays = kind(
        *(
            a if only and name not in only else put_rows(a, rows, b, -(name in nobody))
            for name, a, b in each
        )
    )
    return mixed
