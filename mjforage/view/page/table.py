"""A table: cells as text, and the numbers in full that they show."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

NOTHING = "–"
"""A cell that is undefined."""


class Number(NamedTuple):
    """Number of a cell, unrounded. NaN is undefined, or not shown in that cell."""

    value: float
    low: float = math.nan  # of its interval
    high: float = math.nan


@dataclass(frozen=True)
class Row:
    """One row: its head, its cells, and its marks."""

    head: str
    cells: tuple[str, ...]
    colour: str = ""  # chip before the head, "#rrggbb"
    paper: bool = False  # published figures, not ours
    best: frozenset[int] = frozenset()  # cells with the best mean of their column
    group: str = ""  # heading above this row, where it differs from the row before
    note: str = ""  # small print beside the group
    values: tuple[Number | None, ...] = ()  # of each cell, None for words; empty: none is known
    also: tuple[str, ...] = ()  # small print below each cell
    better: int = 0  # of the metric that the head names: 1 more, -1 less is better, 0 neither
    group_better: int = 0  # of the one that the group names

    def number(self, place: int) -> Number | None:
        """Number of a cell, None for words or where it is not known."""
        return self.values[place] if self.values else None


@dataclass(frozen=True)
class Table:
    """A titled table. Column labels may carry a subscript after an underscore."""

    name: str
    title: str
    columns: tuple[str, ...]  # without the head column
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()
    units: tuple[str, ...] = ()  # below the labels
    stacked: bool = False  # intervals stand below their numbers, for wide tables
    head: str = "policy"  # what the heads of the rows are
    better: tuple[int, ...] = ()  # of the columns' metrics, as of a row
    wordy: bool = False  # cells are words, which may have several lines, and no numbers


def with_words(table: Table, label: str, words: Sequence[str]) -> Table:
    """A table with a column of words before its others, a cell for each row."""
    rows = (
        replace(
            one,
            cells=(word, *one.cells),
            values=(None, *one.values),
            also=("", *one.also),
            best=frozenset(place + 1 for place in one.best),
        )
        for one, word in zip(table.rows, words, strict=True)
    )
    return replace(
        table,
        columns=(label, *table.columns),
        rows=tuple(rows),
        units=("", *table.units),
        better=(0, *table.better),
    )


def groups(rows: Sequence[Row]) -> list[tuple[Row, list[Row]]]:
    """Consecutive rows of one group, each with its first row."""
    result: list[tuple[Row, list[Row]]] = []
    for row in rows:
        if result and result[-1][0].group == row.group:
            result[-1][1].append(row)
        else:
            result.append((row, [row]))
    return result
