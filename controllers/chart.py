"""Gaps between vessels and land; the map's edge counts as a quay.

Land is made of cells. A map with outlines has walls besides, which reach into cells of water.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor
from mjforage.controllers.boxes import box_gap

WALL_M = 0.05  # half thickness of a wall
NO_WALLS = np.zeros((0, 5))
_NEAR_M = 0.25  # walls so near to a cell are among its walls
_FIELDS = NO_WALLS.shape[1]  # of a wall

LandArray = NDArray[Any]
"""Land, for kernels. Without walls: (column + 2, row + 2) bool, in a frame of land; empty: open
water. With walls: (n,) float64, the two sizes of such a grid, its cells in the same order, then
walls by cell. A cell is 0 for water, -1 for land; with walls it is k for water and -k for land,
where `k` is the place of the number of its walls, before these."""
OPEN_WATER: LandArray = np.zeros((0, 0), np.bool_)


@dataclass(frozen=True, eq=False)
class Chart:
    """A map of square cells.

    Attributes
    ----------
    navigable : (row, column) bool, row 0 in the north
    pitch_m : side of a cell [m]; the centre of cell (row, column) is at
        x = column * pitch, y = (rows - 1 - row) * pitch
    walls : (wall, 5) x, y of its middle [m], cosine and sine of its direction, half its length [m]
    """

    navigable: NDArray[np.bool_]
    pitch_m: float
    walls: NDArray[np.float64] = field(default_factory=NO_WALLS.copy)

    @property
    def land(self) -> LandArray:
        """Its land, cells west to east and south to north."""
        water = np.pad(np.asarray(self.navigable, np.bool_), 1)
        cells = np.ascontiguousarray(~water[::-1].T)
        if not len(self.walls):
            return cells
        columns, rows = cells.shape
        cell, wall = _by_cell(columns, rows, self.pitch_m, self.walls).T
        order = np.argsort(cell, kind="stable")
        walled, first, count = np.unique(cell[order], return_index=True, return_counts=True)
        tail = np.insert(self.walls[wall[order]].ravel(), _FIELDS * first, count)
        codes = -cells.ravel().astype(np.float64)
        place = 2 + cells.size + _FIELDS * first + np.arange(len(first))
        codes[walled] = np.where(codes[walled] < 0.0, -place, place)
        return np.concatenate((cells.shape, codes, tail))


def cells_of(land: LandArray) -> NDArray[np.bool_]:
    """(column + 2, row + 2) cells of land in a frame of land; empty: open water."""
    if land.ndim == 2:
        return land
    columns, rows = grid_shape(land)
    return np.asarray(land[2 : 2 + columns * rows].reshape(columns, rows) < 0.0)


@kernel
def has_walls(land: LandArray) -> bool:
    """True if outlines are known."""
    return bool(land.ndim == 1)


@kernel
def grid_shape(land: LandArray) -> tuple[int, int]:
    """Columns and rows of the framed cells."""
    if land.ndim == 2:
        return land.shape[0], land.shape[1]
    return int(land[0]), int(land[1])


@kernel
def framed_is_land(land: LandArray, i: int, j: int) -> bool:
    """True if cell (i, j), counted from the frame's south-west corner, is land."""
    if land.ndim == 2:
        return bool(land[i, j])
    return bool(land[2 + i * int(land[1]) + j] < 0.0)


@kernel
def walls_at(land: LandArray, i: int, j: int) -> range:
    """Places in `land` of the walls of a cell, counted as by `framed_is_land`."""
    if land.ndim == 2:
        return range(0, 0, _FIELDS)
    first = abs(int(land[2 + i * int(land[1]) + j]))
    if first < 2:
        return range(0, 0, _FIELDS)
    return range(first + 1, first + 1 + _FIELDS * int(land[first]), _FIELDS)


@kernel
def is_open(land: LandArray, i: int, j: int) -> bool:
    """True if a cell, counted as by `framed_is_land`, is water without walls."""
    if land.ndim == 2:
        return not land[i, j]
    return bool(land[2 + i * int(land[1]) + j] == 0.0)


@kernel
def wall_at(land: LandArray, k: int) -> tuple[float, float, float, float, float]:
    """A wall, see `Chart`, from its place in `land`."""
    if land.ndim == 2:
        return 0.0, 0.0, 1.0, 0.0, 0.0
    return land[k], land[k + 1], land[k + 2], land[k + 3], land[k + 4]


@kernel
def _by_cell(
    columns: int, rows: int, pitch: float, walls: NDArray[np.float64]
) -> NDArray[np.int64]:
    """(n, 2) number of a framed cell, and of a wall that it has."""
    found, half = [(0, 0) for _ in range(0)], 0.5 * pitch + _NEAR_M
    for k in range(len(walls)):
        x, y, c, s, length = walls[k]
        wide, high = abs(c) * length + _NEAR_M, abs(s) * length + _NEAR_M
        west, east = math.floor((x - wide) / pitch + 1.5), math.floor((x + wide) / pitch + 2.5)
        south, north = math.floor((y - high) / pitch + 1.5), math.floor((y + high) / pitch + 2.5)
        for i in range(max(west, 0), min(east, columns)):
            for j in range(max(south, 0), min(north, rows)):
                dx, dy = (i - 1) * pitch - x, (j - 1) * pitch - y
                if box_gap(dx, dy, c, s, length, 0.0, 1.0, 0.0, half, half) <= 0.0:
                    found.append((i * rows + j, k))
    return np.array(found, np.int64).reshape(-1, 2)


@kernel
def way_to_wall(land: LandArray, k: int, x: float, y: float) -> tuple[float, float, float]:
    """Way from a point to the middle line of wall `k`, and how far beyond its end that is [m]."""
    mx, my, c, s, half = wall_at(land, k)
    along = (x - mx) * c + (y - my) * s
    least = min(max(along, -half), half)
    return mx + least * c - x, my + least * s - y, along - half


@kernel
def is_behind(land: LandArray, pitch: float, i: int, j: int, x: float, y: float) -> bool:
    """True if walls part a point of cell (i, j) from its middle, an odd number of them."""
    to_x, to_y, behind = i * pitch - x, j * pitch - y, False
    for k in walls_at(land, i + 1, j + 1):
        mx, my, c, s, half = wall_at(land, k)
        ax, ay, bx, by = mx - half * c - x, my - half * s - y, mx + half * c - x, my + half * s - y
        sides = (to_x * ay - to_y * ax >= 0.0) != (to_x * by - to_y * bx >= 0.0)
        own, other = s * ax - c * ay >= 0.0, s * (ax - to_x) - c * (ay - to_y) >= 0.0
        behind ^= sides and own != other
    return behind


@kernel
def is_cell_land(land: LandArray, i: int, j: int) -> bool:
    """True if cell (i, j), counted from the south-west, is land; all is around a map."""
    columns, rows = grid_shape(land)
    inside = -1 <= i < columns - 1 and -1 <= j < rows - 1
    return bool(not inside or framed_is_land(land, i + 1, j + 1))


@kernel
def is_land(land: LandArray, pitch: float, x: float, y: float) -> bool:
    """True if a point [m] lies on land; an empty map has none, and all is land around a map."""
    if land.size == 0:
        return False
    i, j = floor(x / pitch + 0.5), floor(y / pitch + 0.5)
    return bool(is_cell_land(land, i, j) or is_behind(land, pitch, i, j, x, y))


@kernel
def headland(land: LandArray, i: int, j: int) -> bool:
    """True if a quay juts out where cells (i, j) and (i + 1, j + 1) meet: one of four is land."""
    if land.size == 0:
        return False
    count = int(is_cell_land(land, i, j)) + int(is_cell_land(land, i + 1, j))
    return count + int(is_cell_land(land, i, j + 1)) + int(is_cell_land(land, i + 1, j + 1)) == 1


@kernel
def way_to_cell(pitch: float, x: float, y: float, i: int, j: int) -> tuple[float, float]:
    """Way from a point to the nearest of cell (i, j) [m]."""
    dx = min(max(x, (i - 0.5) * pitch), (i + 0.5) * pitch) - x
    return dx, min(max(y, (j - 0.5) * pitch), (j + 0.5) * pitch) - y


@kernel
def is_nearer(land: LandArray, i: int, j: int, dx: float, dy: float) -> bool:
    """True if a way (dx, dy) to land cell (i, j) is shorter than to its neighbours before it.

    Of a straight quay that is one cell, of two quays in a corner one each; a corner that juts out
    is nearer than its sides.
    """
    if dx == 0.0 or dy == 0.0:
        return True
    before_i, before_j = i - (1 if dx > 0.0 else -1), j - (1 if dy > 0.0 else -1)
    return not (is_cell_land(land, before_i, j) or is_cell_land(land, i, before_j))


@kernel
def quay_gap(
    land: LandArray,
    pitch: float,
    x: float,
    y: float,
    c: float,
    s: float,
    half_length: float,
    half_beam: float,
    reach: float,
) -> float:
    """Gap between a box and the nearest land [m], at most `reach`; negative: overlap.

    Parameters
    ----------
    land, pitch : of a `Chart`; an empty map has no land
    x, y, c, s : centre of the box [m], cosine and sine of its heading
    """
    nearest = reach
    if land.size == 0:
        return nearest
    wide = abs(c) * half_length + abs(s) * half_beam + reach
    high = abs(s) * half_length + abs(c) * half_beam + reach
    columns, rows = grid_shape(land)
    west = min(max(floor((x - wide) / pitch + 0.5) + 1, 0), columns - 1)
    east = min(max(floor((x + wide) / pitch + 0.5) + 1, 0), columns - 1)
    south = min(max(floor((y - high) / pitch + 0.5) + 1, 0), rows - 1)
    north = min(max(floor((y + high) / pitch + 0.5) + 1, 0), rows - 1)
    half = 0.5 * pitch
    for i in range(west, east + 1):
        for j in range(south, north + 1):
            if framed_is_land(land, i, j):
                dx, dy = (i - 1) * pitch - x, (j - 1) * pitch - y
                gap = box_gap(dx, dy, c, s, half_length, half_beam, 1.0, 0.0, half, half)
                nearest = min(nearest, gap)
                continue
            for k in walls_at(land, i, j):
                wx, wy, wc, ws, long = wall_at(land, k)
                dx, dy = wx - x, wy - y
                gap = box_gap(dx, dy, c, s, half_length, half_beam, wc, ws, long, WALL_M)
                nearest = min(nearest, gap)
    return nearest
