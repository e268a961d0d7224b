"""Tables: a line per row with a 0 or 1 per cell."""

import math
from pathlib import Path

import numpy as np

from mjforage.base.errors import UserError
from mjforage.scenario.map_formats.levels import Levels, check_size, levels_of

MOST_BYTES = 200_000_000
_WORDS = {"true": 1.0, "false": 0.0}


def read_table(path: Path, name: str) -> Levels:
    """Levels of a table in UTF-8.

    Fields are separated by commas, semicolons, tabs or blanks, and are numbers (0 and 1, or 0 and
    255) or True and False. Empty lines and what follows a `#` are left out. Raises `UserError` if
    it cannot be read, is no text, empty or too long, if rows differ in length, or a cell has
    another value.

    `path`: the file; `name`: name of the map in messages.
    """
    text = (line.partition("#")[0].strip() for line in _text(path, name).splitlines())
    lines = [(number, line) for number, line in enumerate(text, 1) if line]
    if not lines:
        raise UserError(f"map {name}: is empty; give one line of 0 and 1 per row")
    separator = next((mark for mark in ";,\t" if mark in lines[0][1]), None)
    rows = [[field.strip() for field in line.split(separator)] for _, line in lines]
    columns = len(rows[0])
    for r, row in enumerate(rows):
        if len(row) != columns:
            raise UserError(
                f"map {name}: row {r} has {len(row)} columns, expected {columns} "
                f"(counted from 0; line {lines[r][0]})"
            )
    check_size(len(rows), columns, name)
    numbers = {field: _number(field) for field in set().union(*rows)}
    values = np.array([[numbers[field] for field in row] for row in rows])
    return levels_of(values, name, lambda row, column: repr(rows[row][column][:20]))


def _text(path: Path, name: str) -> str:
    try:
        if path.stat().st_size > MOST_BYTES:
            raise UserError(f"map {name}: has more than {MOST_BYTES:,} bytes; give fewer cells")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UserError(f"map {name}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise UserError(
            f"map {name}: is neither a text in UTF-8 nor, by the end of its name, an image; give "
            ".csv, .txt, .png, .pgm, .tif or another image"
        ) from error


def _number(field: str) -> float:
    """The number of a field, or NaN."""
    try:
        return _WORDS[field.lower()] if field.lower() in _WORDS else float(field)
    except ValueError:
        return math.nan
