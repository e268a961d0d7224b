"""Text files: detection of the format, and the two formats that contain their own size.

Octile maps: Sturtevant (2012), "Benchmarks for Grid-Based Pathfinding". ESRI ASCII grids: the
format of ArcGIS and GDAL.
"""

import codecs
from pathlib import Path

import numpy as np

from mjforage.base.errors import UserError
from mjforage.scenario.map_formats.levels import MOST_BYTES, Levels, check_size, levels_of
from mjforage.scenario.map_formats.tables import read_table

GROUND, BLOCKED = ".GS", "@OTW"  # of an octile map: ground, grass, swamp; out, trees, deep water
ESRI_KEYS = (
    *("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter"),
    *("cellsize", "nodata_value"),
)
NO_DATA = -9999.0  # of an ESRI grid that does not say


def read_text(path: Path, name: str) -> Levels:
    """Levels of a text file: an octile map, an ESRI grid, or else a table.

    Parameters
    ----------
    path : the file
    name : name of the map in messages

    Raises
    ------
    UserError
        If it cannot be read, is no text, empty, too long or malformed.
    """
    lines = _lines(path, name)
    head = (lines[0].split() or [""])[0].lower()
    if head == "type":
        return _octile(lines, name)
    return _esri(lines, name) if head in ESRI_KEYS else read_table(lines, name)


def _lines(path: Path, name: str) -> list[str]:
    try:
        if path.stat().st_size > MOST_BYTES:
            raise UserError(f"map {name}: has more than {MOST_BYTES:,} bytes; give fewer cells")
        text = decoded(path.read_bytes())
    except OSError as error:
        raise UserError(f"map {name}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise UserError(
            f"map {name}: is neither UTF-8 nor UTF-16 text, nor an image nor an array by the "
            "end of its name; give .csv, .txt, .map, .asc, .npy, .png, .pgm, .tif or another image"
        )
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip().split("\n")
    if lines == [""]:
        raise UserError(f"map {name}: is empty; give one line of 0 and 1 per row")
    return lines


def decoded(content: bytes) -> str:
    """Text in UTF-8, or in UTF-16 where it begins with its mark, as spreadsheets write it.

    Raises
    ------
    UnicodeDecodeError
        If it is neither.
    """
    marked = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return content.decode("utf-16" if marked else "utf-8-sig")


def _size(head: dict[str, str], rows: str, columns: str, name: str) -> tuple[int, int]:
    """Rows and columns of a header."""
    for key in (rows, columns):
        if not head.get(key, "").isdecimal() or len(head[key]) > 9:
            raise UserError(f"map {name}: its header needs {key} and a whole number")
    size = int(head[rows]), int(head[columns])
    check_size(*size, name)
    return size


def _octile(lines: list[str], name: str) -> Levels:
    start = next((i for i, line in enumerate(lines[:9]) if line.strip() == "map"), None)
    head = dict(line.split() for line in lines[:start] if len(line.split()) == 2)
    if start is None or head.get("type") != "octile":
        raise UserError(f"map {name}: its header needs type octile, height, width, and then map")
    rows, columns = _size(head, "height", "width", name)
    body = lines[start + 1 :]
    lengths = {len(line) for line in body}
    if len(body) != rows or lengths != {columns}:
        found = " or ".join(map(str, sorted(lengths)))
        raise UserError(
            f"map {name}: has {len(body)} rows of {found or 'no'} characters, its header says "
            f"{rows} x {columns}"
        )
    for r, line in enumerate(body):
        if wrong := set(line) - set(GROUND + BLOCKED):
            raise UserError(
                f"map {name}: row {r} has {min(wrong)!r}, expected {GROUND} or {BLOCKED} "
                f"(counted from 0; line {start + r + 2})"
            )
    codes = np.frombuffer("".join(body).encode("ascii"), np.uint8).reshape(rows, columns)
    return np.isin(codes, np.frombuffer(GROUND.encode(), np.uint8)).astype(np.int8)


def _esri(lines: list[str], name: str) -> Levels:
    split = [line.split() for line in lines[: len(ESRI_KEYS)]]
    head = {one[0].lower(): one[1] for one in split if len(one) == 2 and one[0][0].isalpha()}
    rows, columns = _size(head, "nrows", "ncols", name)
    try:
        no_data = float(head.get("nodata_value", NO_DATA))
        body = [np.array(line.split(), np.float64) for line in lines[len(head) :]]
    except ValueError as error:
        raise UserError(f"map {name}: {error}; give an ESRI grid of numbers") from error
    values = np.concatenate([*body, np.empty(0)])
    if values.size != rows * columns:
        raise UserError(f"map {name}: has {values.size} cells, its header says {rows} x {columns}")
    values = values.reshape(rows, columns)
    return levels_of(values, name, np.isnan(values) | (values == no_data))
