"""Tables: a line per row with a 0 or 1 per cell, and the headers that programs add."""

import math
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mjforage.base.errors import UserError
from mjforage.scenario.map_formats.levels import Levels, check_size, levels_of

_WORDS = {"true": 1.0, "false": 0.0}
_COUNTED = 3  # so many numbers 0, 1, 2, ... are no cells


class _Row(NamedTuple):
    line: int  # of the file, from 1
    fields: list[str]


def read_table(lines: Sequence[str], name: str) -> Levels:
    """Levels of a table.

    Fields are separated by commas, semicolons, tabs or blanks, in quotes or not, and are numbers
    (0 and 1, or 0 and 255) or True and False; between semicolons a comma is a decimal one. What
    follows a `#`, a spreadsheet's `sep=`, a separator at the end of every row, and header and index
    of a data frame are left out.

    Parameters
    ----------
    lines : of the file
    name : name of the map in messages

    Raises
    ------
    UserError
        If rows differ in length, or a cell is neither.
    """
    rows = _rows(lines)
    if not rows:
        raise UserError(f"map {name}: is empty; give one line of 0 and 1 per row")
    rows = _cells(rows)
    expected = Counter(len(row.fields) for row in rows).most_common(1)[0][0]
    for r, row in enumerate(rows):
        if len(row.fields) != expected:
            raise UserError(
                f"map {name}: row {r} has {len(row.fields)} columns, expected {expected} "
                f"(counted from 0; line {row.line})"
            )
    check_size(len(rows), expected, name)
    meaning = {field: _number(field) for field in set().union(*(row.fields for row in rows))}
    values = np.empty((len(rows), expected))
    for r, row in enumerate(rows):
        values[r] = [meaning[field] for field in row.fields]

    def found(r: int, c: int) -> tuple[str, str]:
        return repr(rows[r].fields[c][:20]), f"; line {rows[r].line}"

    return levels_of(values, name, found=found)


def _rows(lines: Sequence[str]) -> list[_Row]:
    """Fields of the lines that are no comments, without quotes."""
    numbered = ((i, line) for i, line in enumerate(lines, 1) if not _is_comment(line))
    kept = [(i, line.partition("#")[0]) for i, line in numbered]
    separator = next((mark for mark in ";,\t" if any(mark in line for _, line in kept)), None)
    rows = []
    for number, line in kept:
        line = line.replace(",", ".") if separator == ";" else line
        fields = line.split(separator) if line.strip() else []
        rows.append(_Row(number, [field.strip().strip("\"'").strip() for field in fields]))
    return rows


def _is_comment(line: str) -> bool:
    return line.lstrip().lower().startswith(("#", "sep="))


def _cells(rows: list[_Row]) -> list[_Row]:
    """Rows less separators at their ends, and less header and index of a data frame."""
    if all(len(row.fields) > 1 and not row.fields[-1] for row in rows):
        rows = [_Row(row.line, row.fields[:-1]) for row in rows]
    if not all(row.fields for row in rows):
        return rows
    head, below = rows[0].fields, rows[1:]
    if not below or not _is_header(head):
        return _without_index(rows) if _counts([row.fields[0] for row in rows]) else rows
    beside = all(len(row.fields) == len(head) + 1 for row in below)  # an index without a name
    indexed = beside or not head[0] or _counts([row.fields[0] for row in below])
    return _without_index(below) if indexed else below


def _without_index(rows: list[_Row]) -> list[_Row]:
    return [_Row(row.line, row.fields[1:]) for row in rows]


def _is_header(fields: list[str]) -> bool:
    """True if fields are names of columns: words, or a count of them."""
    named = [field for field in fields if field]
    words = bool(named) and all(math.isnan(_number(field)) for field in named)
    return words or _counts(fields) or (not fields[0] and _counts(fields[1:], 1))


def _counts(fields: Sequence[str], least: int = _COUNTED) -> bool:
    """True if fields count on from 0 or 1, by default too far to be cells."""
    counts = (list(map(str, range(first, first + len(fields)))) for first in (0, 1))
    return len(fields) >= least and list(fields) in counts


def _number(field: str) -> float:
    """The number that a field is, or NaN."""
    try:
        return _WORDS.get(field.lower(), math.nan) if field[:1].isalpha() else float(field)
    except ValueError:
        return math.nan
