"""Channels that a grid closes: where water lies beyond the reach of its nodes, and how wide the
narrowest part of the way there is.
"""

import heapq
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

_REACH = 1.5  # water farther than this from a node is lost [pitch]
_LEAST = 4.0  # area of lost water that is worth a word [pitch^2]
_EIGHT = np.ones((3, 3), np.bool_)


class Channel(NamedTuple):
    """A closed channel: its narrowest point on the fine grid, widths, and the water beyond."""

    row: float  # of the fine grid
    column: float
    width_m: float
    area_m2: float


def closed_channels(
    water: NDArray[np.bool_], nodes: NDArray[np.bool_], fine: int, pitch_m: float
) -> list[Channel]:
    """Closed channels, those with most water beyond first.

    Parameters
    ----------
    water : (row, column) of the fine grid
    nodes : (row, column) of the coarse one, whose cells are `fine` by `fine` of those
    pitch_m : of the fine grid [m]
    """
    kept = nodes.repeat(fine, axis=0).repeat(fine, axis=1)
    joined, _ = ndimage.label(water | kept, _EIGHT)
    same = np.isin(joined, np.unique(joined[kept])) & water  # else it is another water
    reached = ndimage.binary_dilation(kept, _EIGHT, round(_REACH * fine), mask=water | kept)
    lost, count = ndimage.label(same & ~reached, _EIGHT)
    sizes = np.bincount(lost.ravel(), minlength=count + 1)
    clearance = ndimage.distance_transform_edt(np.pad(water | kept, 1, mode="edge"))[1:-1, 1:-1]
    found = []
    for i, place in enumerate(ndimage.find_objects(lost), 1):
        if sizes[i] >= _LEAST * fine**2:
            inside = np.where(lost[place] == i, clearance[place], 0.0)
            seed = np.unravel_index(inside.argmax(), inside.shape)
            row, column = (int(at + cut.start) for at, cut in zip(seed, place, strict=True))
            (row, column), least = _narrowest(clearance, kept, (row, column))
            found.append(Channel(row, column, (2 * least - 1) * pitch_m, sizes[i] * pitch_m**2))
    return sorted(found, key=lambda channel: -channel.area_m2)


def _narrowest(
    clearance: NDArray[np.float64], kept: NDArray[np.bool_], seed: tuple[int, int]
) -> tuple[tuple[int, int], float]:
    """The narrowest cell, and its clearance, of the widest way from a cell to one that is kept."""
    heap, before = [(-float(clearance[seed]), seed)], {seed: seed}
    cell = seed
    while heap:
        _, cell = heapq.heappop(heap)
        if kept[cell]:
            break
        row, column = cell
        for near in ((row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            inside = 0 <= near[0] < kept.shape[0] and 0 <= near[1] < kept.shape[1]
            if inside and near not in before and (clearance[near] > 0.0 or kept[near]):
                before[near] = cell
                heapq.heappush(heap, (-float(clearance[near]), near))
    way = [cell]
    while way[-1] != seed:
        way.append(before[way[-1]])
    least = min(float(clearance[one]) for one in way)
    narrow = [one for one in way if clearance[one] == least]
    return narrow[len(narrow) // 2], least


def width_at(water: Any, x: float, y: float, about_m: float) -> float:
    """Width of the water across a point [m], from the nearest bank to the other.

    Parameters
    ----------
    water : geometry of shapely
    about_m : width as the grid has it, which stays where there is no other bank
    """
    import shapely

    bank, point = shapely.get_coordinates(
        shapely.shortest_line(shapely.boundary(water), shapely.Point(x, y))
    )
    off = float(np.hypot(*(point - bank)))
    if not off > 1e-6:
        return about_m
    across = (point - bank) / off
    ray = shapely.LineString([bank + 1e-6 * across, bank + (3.0 * about_m + 4.0 * off) * across])
    pieces = shapely.get_parts(shapely.intersection(ray, water))
    near = [one for one in pieces if shapely.distance(one, shapely.Point(point)) < 1e-6]
    return float(near[0].length) if near else about_m


def open_borders(nodes: NDArray[np.bool_]) -> list[tuple[str, int, int]]:
    """Runs of nodes on the edges of a grid: edge, first and last row or column."""
    edges = {"upper": nodes[0], "lower": nodes[-1], "left": nodes[:, 0], "right": nodes[:, -1]}
    found = []
    for name, edge in edges.items():
        ends = np.flatnonzero(np.diff(np.pad(edge, 1).astype(np.int8))).reshape(-1, 2)
        found += [(name, int(first), int(last) - 1) for first, last in ends]
    return found
