"""Maps: shipped and generated ones by name, others by path; connected components; starts.

Rows and columns are counted from 0, row 0 at the north edge, column 0 at the west edge.
"""

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from mjforage.base.errors import UserError
from mjforage.base.views import read_only
from mjforage.scenario.assets import models_folder
from mjforage.scenario.harbours import harbour, harbour_cells, is_harbour
from mjforage.scenario.map_files import WaterIs, is_shipped_map, map_path, read_cells
from mjforage.scenario.map_formats.levels import LIGHT, check_size, levels_of

Starts = tuple[tuple[int, int], ...]

logger = logging.getLogger(__name__)


_NAMED = 4  # components in a message


@dataclass(frozen=True, eq=False)
class GridMap:
    """A map.

    Attributes
    ----------
    name : name of a shipped map (``comb_port``) or of a generated harbour with its size
        (``harbour:combs:7:60x46``), or file name of a user's (``port.csv``)
    navigable : (row, column) bool, read-only
    """

    name: str
    navigable: NDArray[np.bool_]

    def __post_init__(self) -> None:
        object.__setattr__(self, "navigable", read_only(self.navigable))

    @property
    def nodes(self) -> int:
        """Number of navigable cells."""
        return int(np.count_nonzero(self.navigable))


def load_map(
    reference: str,
    *,
    corner_cutting: bool = False,
    largest_component: bool = False,
    water: WaterIs = "light",
) -> GridMap:
    """Load a map and check that it is one component.

    Parameters
    ----------
    reference : name of a shipped map (``comb_port`` or ``comb-port``) or of a generated harbour
        (``harbour:combs:7``), or path of a map file (see `read_cells`)
    corner_cutting : True if a diagonal move may pass beside a land cell or between two
    largest_component : make an obstacle of every node outside the largest component
    water : which cells of a file are water (see `read_cells`)

    Raises
    ------
    UserError
        If the file is missing, unreadable or malformed, has no navigable cell, or is not one
        component and `largest_component` is not set; if a harbour's name is malformed; if the water
        of a shipped map or a harbour is said to be dark.
    """
    if water == "dark" and (is_harbour(reference) or is_shipped_map(reference)):
        raise UserError(f"map {reference}: has light water; leave out map.water = dark")
    if is_harbour(reference):
        which = harbour(reference)
        return GridMap(which.name, harbour_cells(which))
    path = map_path(reference)
    name = path.stem if path.parent == models_folder() / "maps" else path.name
    return grid_of(read_cells(path, name, water), name, corner_cutting, largest_component)


def water_of_array(grid: ArrayLike) -> NDArray[np.bool_]:
    """Water (row, column) of an array of 0 and 1, or of 0 and 255; NaN is land.

    Raises
    ------
    UserError
        If it has not two axes, or holds something else.
    """
    try:
        array = np.asarray(grid)
    except ValueError as error:  # rows of several lengths
        raise UserError(f"map: no array (row, column); {error}") from error
    if array.ndim != 2 or array.dtype.kind not in "buif":
        words = "two axes, row and column, of booleans or of 0 and 1, 1 where there is water"
        raise UserError(f"map: an array of {array.dtype}, shape {array.shape}; give {words}")
    check_size(len(array), array.shape[1], "array")
    cells: NDArray[np.bool_] = levels_of(np.nan_to_num(array.astype(float)), "array") == LIGHT
    return cells


def grid_of(
    cells: NDArray[np.bool_], name: str, corner_cutting: bool, largest_component: bool
) -> GridMap:
    """A map of given cells (row, column); arguments and errors as `load_map`."""
    if not cells.any():
        raise UserError(
            f"map {name}: all {cells.size} cells are obstacles (0 or dark); mark water with 1, "
            "or give map.water = dark"
        )
    cells = _one_component(cells, name, corner_cutting, largest_component)
    return GridMap(name, cells)


def components(
    navigable: NDArray[np.bool_], corner_cutting: bool
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Parts of a map between which no vessel can travel.

    Without corner cutting a diagonal move needs both cells beside it free, so two straight moves
    join the same nodes: only the four straight directions count. With it all eight do.

    Parameters
    ----------
    navigable : (row, column) bool
    corner_cutting : True if diagonal moves may pass land cells

    Returns
    -------
    label : (row, column) int32, 0 on land, components from 1
    sizes : (component,) nodes in each
    """
    structure = ndimage.generate_binary_structure(2, 2 if corner_cutting else 1)
    label = np.zeros(navigable.shape, np.int32)
    ndimage.label(navigable, structure, output=label)
    return label, np.bincount(label.ravel())[1:].astype(np.int64)


def _one_component(
    cells: NDArray[np.bool_], name: str, corner_cutting: bool, largest_component: bool
) -> NDArray[np.bool_]:
    label, sizes = components(cells, corner_cutting)
    if sizes.size == 1:
        return cells
    largest, nodes = int(sizes.argmax()) + 1, int(sizes.sum())
    if largest_component:
        dropped = nodes - int(sizes.max())
        logger.warning(
            "map %s: %d of %d nodes lie outside the largest of %d components and become obstacles",
            *(name, dropped, nodes, sizes.size),
        )
        return np.asarray(label == largest)
    remedy = "keep only that one where you play on it: give map.largest_component = true"
    if not corner_cutting and components(cells, True)[1].size == 1:
        remedy += ", or join them with map.corner_cutting = true"
    parts = ", ".join(str(size) for size in sorted(sizes, reverse=True)[:_NAMED])
    more = f" and {sizes.size - _NAMED} more" if sizes.size > _NAMED else ""
    raise UserError(
        f"map {name}: its {nodes} nodes form {sizes.size} separate components, of {parts}{more} "
        f"nodes; {remedy}"
    )


def check_starts(starts: Starts, navigable: NDArray[np.bool_], owner: str, map_name: str) -> None:
    """Refuse starts that no agent can take.

    Parameters
    ----------
    starts : (row, column) of each start, counted from 0
    navigable : (row, column) bool
    owner : whose starts they are, for the message (``scenario published``)
    map_name : name of the map in messages

    Raises
    ------
    UserError
        If a start lies outside the map or on land, or is given twice.
    """
    rows, columns = navigable.shape
    for i, (row, column) in enumerate(starts):
        if not (0 <= row < rows and 0 <= column < columns):
            fault = f"is outside map {map_name} ({rows} rows x {columns} columns, counted from 0)"
        elif not navigable[row, column]:
            fault = f"is on land in map {map_name}"
        elif (row, column) in starts[:i]:
            fault = f"is given twice for map {map_name}"
        else:
            continue
        raise UserError(
            f"start ({row}, {column}) of {owner} {fault}; give map.starts = "
            "[[r,c],...], or [] for a random cluster"
        )


def load_starts(reference: str) -> Starts | None:
    """Read the starts that lie beside a map as ``<stem>.starts.csv``, a line ``row,column`` each.

    Parameters
    ----------
    reference : name of a shipped map or a generated harbour, or path of a map file

    Returns
    -------
    (row, column) of each start, unchecked against the map, or None if there is no such file, as
    beside no harbour

    Raises
    ------
    UserError
        If there is no such map, or the starts cannot be read, are none, or hold anything but two
        whole numbers per line.
    """
    if is_harbour(reference):
        return None
    path = map_path(reference)
    file = path.with_name(f"{path.stem}.starts.csv")
    if not file.is_file():
        return None
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"starts {file.name}: cannot be read ({error})") from error
    starts = tuple(_start(line, i + 1, file.name) for i, line in enumerate(lines) if line.strip())
    if not starts:
        raise UserError(f"starts {file.name}: is empty; delete it for a random cluster")
    return starts


def _start(line: str, number: int, name: str) -> tuple[int, int]:
    try:
        row, column = (int(field) for field in line.replace(";", ",").split(","))
    except ValueError as error:
        found = repr(line.strip()[:40])
        raise UserError(
            f"starts {name}: line {number} is {found}, expected two whole numbers: row,column"
        ) from error
    return row, column
