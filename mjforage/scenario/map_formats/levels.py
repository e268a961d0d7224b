"""Parts that the formats share: the largest map, and numbers as light and dark."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError

Levels: TypeAlias = NDArray[np.int8]
"""(row, column) of `LIGHT`, `DARK` and `UNKNOWN`."""
LIGHT, DARK, UNKNOWN = 1, 0, -1
MOST_CELLS = 40_000_000  # rows times columns, beyond which the graph of a map fits no machine


def check_size(rows: int, columns: int, name: str) -> None:
    """Refuse a map by its size, before memory is allocated for its cells.

    Raises `UserError` if it has no cell or more than `MOST_CELLS`.

    `name`: name of the map in messages.
    """
    if rows < 1 or columns < 1:
        raise UserError(f"map {name}: {rows} x {columns} cells; give at least one row and column")
    if rows * columns > MOST_CELLS:
        raise UserError(
            f"map {name}: {rows} x {columns} cells are more than {MOST_CELLS:,}; cut out the part "
            "that you need, or make its cells larger"
        )


def levels_of(
    values: NDArray[np.float64], name: str, words: Callable[[int, int], str] = lambda r, c: ""
) -> Levels:
    """Levels of numbers (row, column) that are 0 and 1, or 0 and 255.

    Raises `UserError`, naming the first cell that is neither.

    `words`: how errors quote the cell of a row and column of the file; by default by its number.
    """
    top = 255.0 if (values == 255.0).any() and not (values == 1.0).any() else 1.0
    wrong = (values != 0.0) & (values != top)
    if wrong.any():
        row, column = divmod(int(wrong.argmax()), wrong.shape[1])
        quoted = words(row, column) or f"{values[row, column]:g}"
        raise UserError(
            f"map {name}: row {row}, column {column} is {quoted}, expected 0 or {top:g} "
            "(counted from 0)"
        )
    levels: Levels = (values == top).astype(np.int8)
    return levels
