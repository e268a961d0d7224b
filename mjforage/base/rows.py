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
        result = np.full((len(into), *shape), fill, into.dtype)
        result[(slice(None), *_leading(into))] = into
        result[rows] = fill
        result[(rows, *_leading(values))] = values
        return result
    result = into.copy()
    result[rows] = values
    return result


def _leading(array: NDArray[Any]) -> tuple[slice, ...]:
    """Where an array lies in one that is at least as wide on each axis but the first."""
    return tuple(slice(0, size) for size in array.shape[1:])


def scatter_all(
    into: Arrays,
    rows: NDArray[np.int64],
    values: Arrays,
    nobody: Collection[str] = (),
    only: Collection[str] = (),
) -> Arrays:
    """`scatter_rows` for the arrays of a named tuple.

    Parameters
    ----------
    nobody : fields that are filled with -1
    only : fields that have rows, where others have none; empty: all
    """
    kind: Any = type(into)
    each = zip(kind._fields, into, values, strict=True)
    mixed: Arrays = kind(
        *(
            a if only and name not in only else scatter_rows(a, rows, b, -(name in nobody))
            for name, a, b in each
        )
    )
    return mixed
