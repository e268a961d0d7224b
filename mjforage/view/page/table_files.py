"""Tables as files: CSV with the numbers in full, Markdown, and LaTeX for a paper."""

import csv
import io
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from graph_planner.references import file_label
from mjforage.core.whole_files import write_bytes
from mjforage.view.page.table import NOTHING, Number, Table

MINUS = "−"


def write_table(table: Table, folder: Path, formats: Sequence[str]) -> None:
    """Write a table as ``<folder>/<name>.csv|md|tex``.

    Parameters
    ----------
    formats : of `FORMATS`

    Raises
    ------
    UserError
        If a file cannot be written.
    """
    for one in formats:
        ending, text = FORMATS[one]
        write_bytes(folder / f"{file_label(table.name)}.{ending}", text(table).encode("utf-8"))


def csv_text(table: Table) -> str:
    """A table as CSV (RFC 4180, but lines end in a bare newline), with numbers in full.

    A column of numbers with intervals becomes three: itself, then with " low" and " high". What is
    undefined is empty. Headings of groups and the units are in cells of their own.
    """
    grouped = any(row.group for row in table.rows)
    parts = [_parts(table, place) for place in range(len(table.columns))]
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    heads = [_column(table, place) + end for place, ends in enumerate(parts) for end in ends]
    writer.writerow([*(["group"] if grouped else []), table.head, *heads])
    for row in table.rows:
        cells = [
            text
            for place, ends in enumerate(parts)
            for text in _csv_cells(row.number(place), row.cells[place], ends)
        ]
        writer.writerow([*([row.group] if grouped else []), row.head, *cells])
    return buffer.getvalue()


def _column(table: Table, place: int) -> str:
    """Label of a column with its unit."""
    unit = table.units[place] if table.units else ""
    return f"{table.columns[place]} [{unit}]" if unit else table.columns[place]


def _parts(table: Table, place: int) -> tuple[str, ...]:
    """Ends of the names of the columns that one column becomes in CSV."""
    numbers = [number for row in table.rows if (number := row.number(place))]
    ends = (" low", " high") if any(not math.isnan(one.low) for one in numbers) else ()
    shown = any(not math.isnan(one.value) for one in numbers) or not ends
    return (*(("",) if shown else ()), *ends)


def _csv_cells(number: Number | None, words: str, ends: Sequence[str]) -> Iterator[str]:
    """What a row has in the columns that one column becomes."""
    for end in ends:
        if number is None:
            plain = "" if words == NOTHING else words.replace(MINUS, "-")
            yield plain if end == "" else ""
        else:
            value = {"": number.value, " low": number.low, " high": number.high}[end]
            yield _unrounded(value)


def _unrounded(value: float) -> str:
    """The shortest text that reads back as the same number; nothing for NaN."""
    if math.isnan(value):
        return ""
    return str(int(value)) if float(value).is_integer() else repr(float(value))


FORMATS: dict[str, tuple[str, Callable[[Table], str]]] = {"csv": ("csv", csv_text)}
"""Format -> the file's ending, and what makes its text."""
