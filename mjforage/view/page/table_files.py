"""Tables as files: CSV with the numbers in full, Markdown, and LaTeX for a paper."""

import csv
import io
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from mjforage.base.atomic_files import write_bytes
from mjforage.base.references import file_label
from mjforage.view.page.latex_tables import latex_text
from mjforage.view.page.table import NOTHING, Number, Table, groups

MINUS = "−"


def write_table(table: Table, folder: Path, formats: Sequence[str]) -> None:
    """Write a table as ``<folder>/<name>.csv|md|tex``.

    Raises `UserError` if a file cannot be written.

    `formats`: of `FORMATS`.
    """
    for one in formats:
        ending, text = FORMATS[one]
        write_bytes(folder / f"{file_label(table.name)}.{ending}", text(table).encode("utf-8"))


def csv_text(table: Table) -> str:
    """A table as CSV (RFC 4180, but lines end in a bare newline), with numbers in full.

    A column of numbers with intervals becomes three: itself, then with " low" and " high". What is
    undefined is empty. Headings of groups stand in a column of their own.
    """
    grouped = any(row.group for row in table.rows)
    parts = [_parts(table, place) for place in range(len(table.columns))]
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    heads = [label + end for label, ends in zip(labels(table), parts, strict=True) for end in ends]
    writer.writerow([*(["group"] if grouped else []), table.head, *heads])
    for row in table.rows:
        cells = [
            text
            for place, ends in enumerate(parts)
            for text in _csv_cells(row.number(place), row.cells[place], ends)
        ]
        writer.writerow([*([row.group] if grouped else []), row.head, *cells])
    return buffer.getvalue()


def labels(table: Table) -> tuple[str, ...]:
    """Columns with their units."""
    units = table.units or ("",) * len(table.columns)
    pairs = zip(table.columns, units, strict=True)
    return tuple(f"{column} [{unit}]" if unit else column for column, unit in pairs)


def _parts(table: Table, place: int) -> tuple[str, ...]:
    """Ends of the names of the columns that one column becomes in CSV."""
    numbers = [number for row in table.rows if (number := row.number(place))]
    ends = (" low", " high") if any(not math.isnan(one.low) for one in numbers) else ()
    shown = any(not math.isnan(one.value) for one in numbers) or not ends
    return (*(("",) if shown else ()), *ends)


def _csv_cells(number: Number | None, words: str, ends: Sequence[str]) -> Iterator[str]:
    """Cells of a row in the columns that one column becomes."""
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


def markdown_text(table: Table) -> str:
    """A table as Markdown with pipes, as GitHub and pandoc read it; the best in bold."""
    heads = [_markdown(table.head), *map(_markdown, labels(table))]
    lines = [
        _piped(heads),
        _piped([":--", *[":--" if table.wordy else "--:"] * len(table.columns)]),
    ]
    for first, rows in groups(table.rows):
        if first.group:
            lines.append(_piped([f"**{_markdown(first.group)}**", *[""] * len(table.columns)]))
        for row in rows:
            cells = [*map(_markdown, row.cells)]
            for place in row.best:
                cells[place] = f"**{cells[place]}**"
            head = _markdown(row.head)
            lines.append(_piped([f"*{head}*" if row.paper else head, *cells]))
    notes = [_markdown(note) for note in table.notes]
    return "\n\n".join([f"**{_markdown(table.title)}**", "\n".join(lines), *notes]) + "\n"


def _piped(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _markdown(text: str) -> str:
    """Escape what Markdown would take for its own; code between backticks stays code."""
    code = text.split("`")
    for place in range(0, len(code), 2):
        for sign in "\\*_|<":
            code[place] = code[place].replace(sign, f"\\{sign}")
    return "`".join(part if i % 2 == 0 else part.replace("|", "\\|") for i, part in enumerate(code))


FORMATS: dict[str, tuple[str, Callable[[Table], str]]] = {
    "latex": ("tex", latex_text),
    "csv": ("csv", csv_text),
    "markdown": ("md", markdown_text),
}
"""Format -> the file's ending, and what makes its text."""
