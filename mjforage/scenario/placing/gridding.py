"""Cells of a place: the share of each that is water, and the nodes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_WHOLE = 1e-9


def water_shares(
    water: Any, rows: int, columns: int, pitch_m: float, fine: int
) -> NDArray[np.float64]:
    """(row, column) share of each cell that is water, exactly: cut in halves until it is all or
    nothing, or one cell.

    Parameters
    ----------
    water : geometry of shapely in the frame of the place [m]
    rows, columns, pitch_m : of the place's grid
    fine : cells of the result along one of those
    """
    rows, columns, side = rows * fine, columns * fine, pitch_m / fine
    corner = -0.5 * pitch_m
    shares = np.zeros((rows, columns))
    left = [(water, 0, 0, rows, columns)]
    while left:
        shape, top, west, bottom, east = left.pop()
        low = corner + west * side, corner + (rows - bottom) * side
        high = corner + east * side, corner + (rows - top) * side
        part = _clipped(shape, (*low, *high))
        share = part.area / ((high[0] - low[0]) * (high[1] - low[1]))
        tall, wide = bottom - top, east - west
        if share < _WHOLE:
            continue
        if share > 1.0 - _WHOLE or tall * wide == 1:
            shares[top:bottom, west:east] = min(share, 1.0)
        elif tall >= wide:
            middle = top + tall // 2
            left += [(part, top, west, middle, east), (part, middle, west, bottom, east)]
        else:
            middle = west + wide // 2
            left += [(part, top, west, bottom, middle), (part, top, middle, bottom, east)]
    return shares


def _clipped(shape: Any, bounds: tuple[float, float, float, float]) -> Any:
    """The part of a shape in a rectangle: the fast way, which refuses some slivers, or the sure."""
    import shapely

    try:
        return shapely.clip_by_rect(shape, *bounds)
    except shapely.errors.GEOSException:
        return shapely.intersection(shapely.make_valid(shape), shapely.box(*bounds))


def without_barriers(
    nodes: NDArray[np.bool_], shares: NDArray[np.float64], water: Any, pitch_m: float
) -> NDArray[np.bool_]:
    """The nodes without those that land bars from a neighbour, as a pontoon thinner than a cell.

    Of two neighbours whose straight connection crosses land, the one with less water goes.
    """
    import shapely

    shapely.prepare(water)
    kept, rows = nodes.copy(), len(nodes)
    for down, right in ((0, 1), (1, 0)):
        here, there = np.s_[: rows - down, : nodes.shape[1] - right], np.s_[down:, right:]
        partly = (shares[here] < 1.0 - _WHOLE) | (shares[there] < 1.0 - _WHOLE)
        start = np.argwhere(nodes[here] & nodes[there] & partly)
        end = start + np.array([down, right])
        ways = np.stack((start, end), axis=1)[..., ::-1] * [1.0, -1.0] + [0.0, rows - 1]
        barred = ~shapely.covers(water, shapely.linestrings(ways * pitch_m))
        for first, second in zip(start[barred], end[barred], strict=True):
            less = first if shares[tuple(first)] < shares[tuple(second)] else second
            kept[tuple(less)] = False
    return kept


def least_depths(
    areas: NDArray[np.object_],
    area_depth_m: NDArray[np.float64],
    nodes: NDArray[np.bool_],
    pitch_m: float,
) -> NDArray[np.float64]:
    """(row, column) least depth of the areas in each node's cell [m]: infinite where there is none,
    NaN on land.

    `areas`, `area_depth_m`: (area,) polygons in the frame of the place, and their depths [m].
    """
    import shapely

    cells, half = np.argwhere(nodes), 0.49 * pitch_m  # what only touches a cell is not in it
    x, y = pitch_m * cells[:, 1], pitch_m * (len(nodes) - 1 - cells[:, 0])
    tree = shapely.STRtree(shapely.box(x - half, y - half, x + half, y + half))
    area, node = tree.query(areas, predicate="intersects")
    least = np.full(len(cells), np.inf)
    np.minimum.at(least, node, area_depth_m[area])
    depth_m = np.full(nodes.shape, np.nan)
    depth_m[nodes] = least
    return depth_m
