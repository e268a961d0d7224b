"""Gaps between vessels and land cells; the map's edge counts as a quay."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor
from mjforage.controllers.boxes import box_gap

LandArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Chart:
    """A map of square cells.

    Attributes
    ----------
    navigable : (row, column) bool, row 0 in the north
    pitch_m : side of a cell [m]; the centre of cell (row, column) is at
        x = column * pitch, y = (rows - 1 - row) * pitch
    """

    navigable: NDArray[np.bool_]
    pitch_m: float

    @property
    def land(self) -> LandArray:
        """(column + 2, row + 2) bool, west to east and south to north, in a frame of land."""
        water = np.pad(np.asarray(self.navigable, np.bool_), 1)
        return np.ascontiguousarray(~water[::-1].T)


@kernel
def is_cell_land(land: LandArray, i: int, j: int) -> bool:
    """True if cell (i, j), counted from the south-west, is land; all is around a map."""
    inside = -1 <= i < land.shape[0] - 1 and -1 <= j < land.shape[1] - 1
    return bool(not inside or land[i + 1, j + 1])


@kernel
def is_land(land: LandArray, pitch: float, x: float, y: float) -> bool:
    """True if a point [m] lies on land; an empty map has none, and all is land around a map."""
    if land.size == 0:
        return False
    return is_cell_land(land, floor(x / pitch + 0.5), floor(y / pitch + 0.5))


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
    columns, rows = land.shape
    west = min(max(floor((x - wide) / pitch + 0.5) + 1, 0), columns - 1)
    east = min(max(floor((x + wide) / pitch + 0.5) + 1, 0), columns - 1)
    south = min(max(floor((y - high) / pitch + 0.5) + 1, 0), rows - 1)
    north = min(max(floor((y + high) / pitch + 0.5) + 1, 0), rows - 1)
    half = 0.5 * pitch
    for i in range(west, east + 1):
        for j in range(south, north + 1):
            if land[i, j]:
                dx, dy = (i - 1) * pitch - x, (j - 1) * pitch - y
                gap = box_gap(dx, dy, c, s, half_length, half_beam, 1.0, 0.0, half, half)
                nearest = min(nearest, gap)
    return nearest
