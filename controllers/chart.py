"""Where quays are: gaps between hulls and land cells; the map's edge counts as a quay."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers._compiled import kernel
from controllers.boxes import box_gap

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

    def __post_init__(self) -> None:
        if self.navigable.ndim != 2 or not self.pitch_m > 0.0:
            raise ValueError(
                f"chart: shape {self.navigable.shape}, pitch {self.pitch_m} m; "
                "give (row, column) cells and a pitch above 0"
            )

    @property
    def land(self) -> LandArray:
        """(column + 2, row + 2) bool, west to east and south to north, in a frame of land."""
        water = np.pad(np.asarray(self.navigable, np.bool_), 1)
        return np.ascontiguousarray(~water[::-1].T)


@kernel
def is_land(land: LandArray, pitch: float, x: float, y: float) -> bool:
    """Whether a point [m] lies on land; an empty map has none, and all is land around a map."""
    if land.size == 0:
        return False
    i, j = math.floor(x / pitch + 0.5) + 1, math.floor(y / pitch + 0.5) + 1
    inside = 0 <= i < land.shape[0] and 0 <= j < land.shape[1]
    return bool(not inside or land[i, j])


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
    west = min(max(math.floor((x - wide) / pitch + 0.5) + 1, 0), columns - 1)
    east = min(max(math.floor((x + wide) / pitch + 0.5) + 1, 0), columns - 1)
    south = min(max(math.floor((y - high) / pitch + 0.5) + 1, 0), rows - 1)
    north = min(max(math.floor((y + high) / pitch + 0.5) + 1, 0), rows - 1)
    half = 0.5 * pitch
    for i in range(west, east + 1):
        for j in range(south, north + 1):
            if land[i, j]:
                dx, dy = (i - 1) * pitch - x, (j - 1) * pitch - y
                gap = box_gap(dx, dy, c, s, half_length, half_beam, 1.0, 0.0, half, half)
                nearest = min(nearest, gap)
    return nearest
