"""Map files: their paths, and the cells that are water.

Rows and columns are counted from 0, row 0 at the north edge, column 0 at the west edge.
"""

import logging
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mjforage.base.atomic_files import atomic_write
from mjforage.scenario.assets import named_file, shipped_files
from mjforage.scenario.map_formats import DARK, IMAGE_SUFFIXES, LIGHT, read_image, read_table

WaterIs = Literal["light", "dark"]
"""Cells of a map file that are water."""

logger = logging.getLogger(__name__)


def shipped_maps() -> dict[str, Path]:
    """Name -> file of the maps that come with the package, in alphabetical order."""
    return shipped_files("maps", ".csv")


def write_table(cells: NDArray[np.bool_], path: Path) -> None:
    """Write a map (row, column) as a table that `read_cells` reads.

    Raises `UserError` if the file cannot be written.
    """
    lines = (",".join("01"[int(cell)] for cell in row) + "\n" for row in cells)
    with atomic_write(path) as beside:
        beside.write_text("".join(lines), encoding="utf-8")


def is_shipped_map(reference: str) -> bool:
    """True if a reference names a map that comes with the package."""
    return reference.replace("-", "_") in shipped_maps()


def map_path(reference: str) -> Path:
    """File of a shipped map (``comb_port`` or ``comb-port``) or of a user's.

    Raises `UserError` if there is no such map or file.
    """
    return named_file("map", reference, shipped_maps(), "a file of a table or an image, or a place")


def read_cells(path: Path, name: str, water: WaterIs = "light") -> NDArray[np.bool_]:
    """Navigable cells (row, column) of a map file, an image by the end of its name, or a table.

    An image has a pixel per cell, a table a number: see `map_formats`. The light cells are water,
    of a table those with 1; unknown ones are land. Raises `UserError` if the file is unreadable,
    too large, empty or malformed.

    Parameters
    ----------
    path : the file
    name : name of the map in messages
    water : `dark` where the dark cells are water, of a table those with 0
    """
    is_image = path.suffix.lower() in IMAGE_SUFFIXES
    levels = (read_image if is_image else read_table)(path, name)
    cells: NDArray[np.bool_] = levels == (LIGHT if water == "light" else DARK)
    edge = np.concatenate((cells[0], cells[-1], cells[:, 0], cells[:, -1]))
    if is_image and edge.all() and not cells.all():
        logger.warning(
            "map %s: all of its edge is water; if that is the land, give map.water = %s",
            *(name, "dark" if water == "light" else "light"),
        )
    return cells
