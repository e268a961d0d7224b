"""Map files: where one lies, and reading it as a table of 0 and 1 or as an image.

Rows and columns are counted from 0, row 0 at the north edge, column 0 at the west edge.
"""

import difflib
import logging
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from mjforage.core.assets import models_folder
from mjforage.core.errors import UserError
from mjforage.core.whole_files import whole

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".gif")
HALF_GREY = 128  # of 0..255: this light or lighter is navigable
HALF_GREY_16 = 32768  # the same for 16-bit images
COLOURED = 48  # between the largest and the least of red, green and blue: more than JPEG makes
MANY = 0.01  # share of coloured pixels that is worth a word
_BROKEN_IMAGE = (
    *(OSError, ValueError, TypeError, SyntaxError, EOFError, ArithmeticError, LookupError),
    Image.DecompressionBombError,
)  # what Pillow raises on damaged files

logger = logging.getLogger(__name__)


def shipped_maps() -> tuple[str, ...]:
    """Names of the maps that come with the package, in alphabetical order."""
    files = (models_folder() / "maps").glob("*.csv")
    return tuple(sorted(f.stem for f in files if not f.stem.endswith(".starts")))


def write_table(cells: NDArray[np.bool_], path: Path) -> None:
    """Write a map (row, column) as a table that `read_cells` reads.

    Raises
    ------
    UserError
        If the file cannot be written.
    """
    lines = (",".join("01"[int(cell)] for cell in row) + "\n" for row in cells)
    with whole(path) as beside:
        beside.write_text("".join(lines), encoding="utf-8")


def is_shipped_map(reference: str) -> bool:
    """Whether a reference names a map that comes with the package."""
    return reference.replace("-", "_") in shipped_maps()


def map_path(reference: str) -> Path:
    """File of a shipped map or of a user's.

    Parameters
    ----------
    reference : name of a shipped map (``comb_port`` or ``comb-port``) or a path

    Raises
    ------
    UserError
        If there is no such map or file; similar names of shipped maps are offered.
    """
    shipped = shipped_maps()
    if is_shipped_map(reference):
        return models_folder() / "maps" / f"{reference.replace('-', '_')}.csv"
    path = Path(reference)
    try:
        if path.is_file():
            return path
        if path.exists():
            raise UserError(f"map {reference!r}: is not a file; give a CSV, text or image file")
    except (OSError, ValueError) as error:
        raise UserError(f"map {reference!r}: cannot be opened ({error})") from error
    close = difflib.get_close_matches(path.stem.replace("-", "_").lower(), shipped, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise UserError(
        f"map {reference!r}: no such file or shipped map; {hint}shipped maps: {', '.join(shipped)}"
    )


def read_cells(path: Path, name: str) -> NDArray[np.bool_]:
    """Navigable cells (row, column) of a map file; the suffix tells an image from a table.

    A table (UTF-8) has one line per row and 0 (obstacle) or 1 (navigable) per cell, also written as
    floats, separated by commas, semicolons, tabs or blanks. An image (PNG, JPG, BMP, GIF) has one
    pixel per cell: from half as light as white it is navigable; transparency counts as white.

    Parameters
    ----------
    path : the file
    name : what errors call the map

    Raises
    ------
    UserError
        If the file is unreadable, empty or ragged, or holds anything but 0 and 1.
    """
    if path.suffix.lower() in IMAGE_SUFFIXES:
        return _read_image(path, name)
    return _read_table(path, name)


def _read_text(path: Path, name: str) -> list[str]:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(f"map {name}: cannot be read ({error.strerror})") from error
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError(f"map {name}: {_foreign()}") from error
    if "\0" in text:
        raise UserError(f"map {name}: {_foreign()}")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip().split("\n")
    if lines == [""]:
        raise UserError(f"map {name}: is empty; give one line of 0 and 1 per row")
    return lines


def _foreign() -> str:
    return f"is neither UTF-8 text nor an image ({', '.join(IMAGE_SUFFIXES)})"


def _read_table(path: Path, name: str) -> NDArray[np.bool_]:
    lines = _read_text(path, name)
    separator = next((mark for mark in ",;\t" if any(mark in line for line in lines)), None)
    rows = [line.split(separator) if line.strip() else [] for line in lines]
    expected = Counter(map(len, rows)).most_common(1)[0][0]
    for r, row in enumerate(rows):
        if len(row) != expected:
            raise UserError(
                f"map {name}: row {r} has {len(row)} columns, expected {expected} "
                f"(counted from 0; line {r + 1})"
            )
    meaning: dict[str, bool] = {}
    cells = np.empty((len(rows), expected), np.bool_)
    for r, row in enumerate(rows):
        for c, field in enumerate(row):
            if field not in meaning:
                meaning[field] = _navigable(field, f"map {name}: row {r}, column {c}", r + 1)
        cells[r] = [meaning[field] for field in row]
    return cells


def _navigable(field: str, place: str, line: int) -> bool:
    try:
        value = float(field)
    except ValueError:
        value = np.nan
    if value not in (0.0, 1.0):
        found = repr(field.strip()[:20])
        raise UserError(f"{place} is {found}, expected 0 or 1 (counted from 0; line {line})")
    return value == 1.0


def _read_image(path: Path, name: str) -> NDArray[np.bool_]:
    try:
        with Image.open(path) as image:
            return _light(image, name)
    except UnidentifiedImageError as error:
        raise UserError(f"map {name}: is no image, or one of size 0, or damaged") from error
    except _BROKEN_IMAGE as error:
        raise UserError(f"map {name}: cannot be read as an image ({error})") from error


def _light(image: Image.Image, name: str) -> NDArray[np.bool_]:
    if image.mode.startswith("I"):  # 16 bits per pixel
        deep: NDArray[Any] = np.asarray(image)
        return np.asarray(deep >= HALF_GREY_16)
    colours = image.convert("RGBA")
    white = Image.new("RGBA", colours.size, "white")
    shown = Image.alpha_composite(white, colours)
    light = np.asarray(np.asarray(shown.convert("L")) >= HALF_GREY)
    parts: NDArray[np.int64] = np.asarray(shown.convert("RGB"), np.int64)
    coloured = (parts.max(axis=-1) - parts.min(axis=-1) > COLOURED).mean()
    if coloured > MANY:
        logger.warning(
            "map %s: %.0f %% of its pixels are coloured, and colours count by lightness alone: "
            "%.0f %% of all are water now; `mjforage maps %s -o seen.png` shows which",
            *(name, 100 * coloured, 100 * light.mean(), name),
        )
    return light
