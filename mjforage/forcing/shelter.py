"""Wind shadow of quays and of obstacles on them: the factor by which the wind is weaker.

Behind an obstacle of height H the air of the mean wind turns back over a length d, and further
behind it has recovered to 1 - (d / x)^1.5 of its speed at x (Roeckle 1990; Kaplan and Dinar 1996,
Atmospheric Environment 30, 4197-4207), with

    d / H = 1.8 (W / H) / ((L / H)^0.3 (1 + 0.24 W / H))

at the ground (Fackrell 1984, Journal of Wind Engineering 16, 97-118; L along the wind, at most
3 H, and W across it). Quays are wide, W >> H, and long, L = 3 H: d = 5.4 H. Within d the air is
taken as calm: what turns back there is a weak eddy. A lee lies straight behind the land, and the
nearest land upwind counts.
"""

import math
from typing import NamedTuple

import numpy as np

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph

CALM = 1.8 / (0.24 * 3.0**0.3)  # d over the height of a wide, long obstacle
_NOWHERE = 1e-12  # slower than this along an axis, the air crosses no cell border there


class Shelter(NamedTuple):
    """Land, and the length of the calm behind it."""

    framed: Int32Array  # (row + 2, column + 2) as `Water.framed`: -1 on land
    pitch_m: float
    length_m: float  # d; 0: no lee


NO_SHELTER = Shelter(np.zeros((2, 2), np.int32), 1.0, 0.0)


def shelter_of(graph: NavigationGraph, height_m: float) -> Shelter:
    """Wind shadows of a map whose land is `height_m` high [m]."""
    return Shelter(graph.water.framed, graph.pitch_m, CALM * height_m)


@kernel
def upwind_land_m(shelter: Shelter, x: float, y: float, u: float, v: float) -> float:
    """Way from (x, y) [m] against a wind (u, v) to the nearest land; infinite if there is none.

    It goes from cell to cell (Amanatides and Woo 1987) to the edge of the map, where all is open.
    """
    rows, cols = shelter.framed.shape[0] - 2, shelter.framed.shape[1] - 2
    speed = math.hypot(u, v)
    if speed == 0.0 or math.isnan(x + y):
        return math.inf
    i, j = floor(x / shelter.pitch_m + 0.5), floor(y / shelter.pitch_m + 0.5)
    step_x, step_y = (-1 if u > 0.0 else 1), (-1 if v > 0.0 else 1)
    pace_x, pace_y = math.inf, math.inf  # way from one border to the next [m]
    next_x, next_y = math.inf, math.inf  # way to the next border [m]
    if abs(u) > _NOWHERE * speed:
        pace_x = shelter.pitch_m * speed / abs(u)
        next_x = pace_x * (0.5 + step_x * (i - x / shelter.pitch_m))
    if abs(v) > _NOWHERE * speed:
        pace_y = shelter.pitch_m * speed / abs(v)
        next_y = pace_y * (0.5 + step_y * (j - y / shelter.pitch_m))
    way = 0.0
    while 0 <= i < cols and 0 <= j < rows:
        if shelter.framed[rows - j, i + 1] < 0:
            return way
        if next_x < next_y:
            way, next_x, i = next_x, next_x + pace_x, i + step_x
        else:
            way, next_y, j = next_y, next_y + pace_y, j + step_y
    return math.inf


@kernel
def wind_share(shelter: Shelter, x: float, y: float, u: float, v: float) -> float:
    """Share of the wind (u, v) [m/s] that is left at (x, y) [m]."""
    way = upwind_land_m(shelter, x, y, u, v)
    if way <= shelter.length_m:
        return 0.0
    return float(1.0 - (shelter.length_m / way) ** 1.5)
