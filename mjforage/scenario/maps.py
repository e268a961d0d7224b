"""Maps: shipped and generated ones by name, others by path; connected components; starts.

Rows and columns are counted from 0, row 0 at the north edge, column 0 at the west edge.
"""

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from mjforage.base.errors import UserError
from mjforage.base.views import read_only
from mjforage.scenario.assets import models_folder
from mjforage.scenario.harbours import harbour, harbour_cells, is_harbour
from mjforage.scenario.map_files import WaterIs, is_shipped_map, map_path, read_cells
from mjforage.scenario.map_formats.levels import LIGHT, check_size, levels_of
from mjforage.scenario.place import (
    DEPTHS_FILE,
    GRID_FILE,
    Place,
    is_place,
    place_path,
    read_depths,
    read_place,
)

Starts = tuple[tuple[int, int], ...]
LatLon = tuple[tuple[float, float], ...]
PITCH_M = 4.0  # of a map that has none of its own

logger = logging.getLogger(__name__)


_NAMED = 4  # components in a message


@dataclass(frozen=True, eq=False)
class GridMap:
    """A map.

    Attributes
    ----------
    name : name of a shipped map (``comb_port``) or of a generated harbour with its size
        (``harbour:combs:7:60x46``), or file name of a user's (``port.csv``), of a place its folder
    navigable : (row, column) bool, read-only
    place : where on the globe it lies, of a map that was made by `mjforage place`
    depth_m : (row, column) least depth of its chart in a node's cell [m below datum], infinite
        where unknown, NaN on land; None of a map without depths
    """

    name: str
    navigable: NDArray[np.bool_]
    place: Place | None = None
    depth_m: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "navigable", read_only(self.navigable))
        object.__setattr__(self, "depth_m", read_only(self.depth_m))

    @property
    def charted(self) -> NDArray[np.bool_]:
        """(row, column) the navigable cells before a draught closes some."""
        return self.navigable if self.depth_m is None else ~np.isnan(self.depth_m)

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

    Raises `UserError` if the file is missing, unreadable or malformed, has no navigable cell, or is
    not one component and `largest_component` is not set; if a harbour's name is malformed; if the
    water of a shipped map or a harbour is said to be dark.

    Parameters
    ----------
    reference : name of a shipped map (``comb_port`` or ``comb-port``) or of a generated harbour
        (``harbour:combs:7``), or path of a map file (see `read_cells`) or of a place
    corner_cutting : True if a diagonal move may pass beside a land cell or between two
    largest_component : make an obstacle of every node outside the largest component
    water : which cells of a file are water (see `read_cells`)
    """
    if water == "dark" and (is_harbour(reference) or is_shipped_map(reference)):
        raise UserError(f"map {reference}: has light water; leave out map.water = dark")
    if is_harbour(reference):
        which = harbour(reference)
        return GridMap(which.name, harbour_cells(which))
    if is_place(reference):
        return _map_of_place(place_path(reference), water, corner_cutting, largest_component)
    path = map_path(reference)
    name = path.stem if path.parent == models_folder() / "maps" else path.name
    return grid_of(read_cells(path, name, water), name, corner_cutting, largest_component)


def _map_of_place(
    path: Path, water: WaterIs, corner_cutting: bool, largest_component: bool
) -> GridMap:
    place, name = read_place(path), path.absolute().parent.name
    cells = read_cells(path.with_name(GRID_FILE), f"{name} ({GRID_FILE})", water)
    if cells.shape != (place.rows, place.columns):
        raise UserError(
            f"place {path}: has {place.rows} rows and {place.columns} columns, {GRID_FILE} beside "
            f"it {cells.shape[0]} and {cells.shape[1]}; make the place again"
        )
    found = grid_of(cells, name, corner_cutting, largest_component)
    depth_m = read_depths(path.with_name(DEPTHS_FILE), found.navigable)
    return GridMap(name, found.navigable, place, depth_m)


def pitch_of(grid: GridMap, pitch_m: float) -> float:
    """Pitch of a map [m]: that of its place, else as given.

    Raises `UserError` if another than the usual one is given for a place.
    """
    if grid.place is None or pitch_m == grid.place.pitch_m:
        return pitch_m
    if pitch_m != PITCH_M:
        raise UserError(
            f"map {grid.name}: pitch_m = {pitch_m:g} of a place made at {grid.place.pitch_m:g} m; "
            "leave it out, or make the place at that pitch"
        )
    return grid.place.pitch_m


def starts_of(grid: GridMap, latlon: LatLon) -> Starts:
    """Nodes of starts in latitude and longitude.

    Raises `UserError` if the map is no place, or a start is outside it or on land.
    """
    if grid.place is None:
        raise UserError(
            f"map {grid.name}: has no latitude and longitude, so give map.starts in rows and "
            "columns; mjforage place makes maps that have them"
        )
    found: list[tuple[int, int]] = []
    rows, columns = grid.navigable.shape
    for here, cell in zip(latlon, grid.place.cells(latlon), strict=True):
        row, column = (int(part) for part in np.rint(cell))
        inside = 0 <= row < rows and 0 <= column < columns
        if not (inside and grid.navigable[row, column]) or (row, column) in found:
            fault = (
                "outside" if not inside else "on land" if not grid.navigable[row, column] else ""
            )
            raise UserError(
                f"start {here[0]:g}, {here[1]:g} (latitude, longitude) is "
                f"{fault or 'in the node of another'} in map {grid.name}; give map.starts_latlon "
                "on its water, which harbour.png shows"
            )
        found.append((row, column))
    return tuple(found)


def water_of_array(grid: ArrayLike) -> NDArray[np.bool_]:
    """Water (row, column) of an array of 0 and 1, or of 0 and 255; NaN is land.

    Raises `UserError` if it has not two axes, or holds something else.
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

    Raises `UserError` if a start lies outside the map or on land, or is given twice.

    Parameters
    ----------
    starts : (row, column) of each start, counted from 0
    navigable : (row, column) bool
    owner : whose starts they are, for the message (``scenario published``)
    map_name : name of the map in messages
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

    Raises `UserError` if there is no such map, or the starts cannot be read, are none, or hold
    anything but two whole numbers per line.

    `reference`: name of a shipped map or a generated harbour, or path of a map file. Returns: (row,
    column) of each start, unchecked against the map, or None if there is no such file, as beside no
    harbour.
    """
    if is_harbour(reference):
        return None
    path = place_path(reference) if is_place(reference) else map_path(reference)
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
