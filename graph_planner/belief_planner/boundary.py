"""Boundary of the water: a position on land or off the map counts as the nearest navigable node.

The boundary condition of items (definitions, section 1): items pushed out of the water are put back
beside the nearest node's centre.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph, Water
from mjforage.graph_planner.graph.walls import WALLS, into_water

STRIDE = 0.4  # longest stretch drifted at once, so that no quay is jumped over [node]


class Boundary(NamedTuple):
    """Boundary of the water, and the rule for items there."""

    framed: Int32Array  # (row + 2, column + 2) node of each cell in a frame of land, see `Water`
    rows: Int32Array  # (node,)
    cols: Int32Array  # (node,)
    room: Int32Array  # (node, axis, 2) free cells to the wall: up and down, left and right
    quay: NDArray[np.bool_]  # (node, axis) whether land, not the map's edge, is beside it there
    walls: int  # place in `WALLS`


@kernel
def _rooms(water: Int32Array, rows: Int32Array, cols: Int32Array) -> Int32Array:
    """Free nodes (node, axis, side) from each node to the next wall, backwards and forwards."""
    height, width = water.shape
    room = np.zeros((rows.size, 2, 2), np.int32)
    for v in range(rows.size):
        for axis in range(2):
            for side in range(2):
                down = (2 * side - 1) * (1 - axis)
                right = (2 * side - 1) * axis
                r, c = rows[v] + down, cols[v] + right
                while 0 <= r < height and 0 <= c < width and water[r, c] >= 0:
                    room[v, axis, side] += 1
                    r, c = r + down, c + right
    return room


def nearest_of_cells(graph: NavigationGraph) -> Int32Array:
    """(row, column) node of every cell of a map, of land the one nearest to its centre."""
    _, (row, col) = ndimage.distance_transform_edt(~graph.navigable, return_indices=True)
    return np.ascontiguousarray(graph.node_of_cell[row, col])


@lru_cache(maxsize=16)
def boundary_of(graph: NavigationGraph, walls: str = "clip") -> Boundary:
    """The boundary of a map under a rule of `WALLS`, made once and kept."""
    rows, cols = graph.rows, graph.cols
    room = _rooms(graph.node_of_cell, rows, cols)
    land = np.pad(~graph.navigable, 1)
    quay = np.stack(
        (
            land[rows, cols + 1] | land[rows + 2, cols + 1],
            land[rows + 1, cols] | land[rows + 1, cols + 2],
        ),
        axis=1,
    )
    return Boundary(graph.water.framed, rows, cols, room, quay, WALLS.index(walls))


@inlined
def at_boundary(boundary: Boundary, node: int, axis: int) -> bool:
    """True if a quay beside a node may hold up items that drift along it, as all but clip do.

    Items at the edge of the map are clipped to it, whatever the rule, and drift along it freely.
    """
    return bool((boundary.walls != 0) & boundary.quay[node, 1 - axis])


@kernel
def settled(boundary: Boundary, row: float, col: float) -> tuple[float, float, int]:
    """A position with its node, moved into the water as the world does it."""
    water = Water(boundary.framed, boundary.rows, boundary.cols)
    return into_water(water, boundary.walls, row, col)


@kernel
def drifted(
    boundary: Boundary, row: float, col: float, drift_row: float, drift_col: float, steps: float
) -> tuple[float, float, int]:
    """Position and node of an item after so many steps of a constant drift, along the quays.

    Parameters
    ----------
    row, col : position [node]
    drift_row, drift_col : [node/step]
    steps : 0 or more
    """
    way_row, way_col = drift_row * steps, drift_col * steps
    pieces = int(max(abs(way_row), abs(way_col)) / STRIDE) + 1
    row, col, node = settled(boundary, row, col)
    for _ in range(pieces):
        row, col, node = settled(boundary, row + way_row / pieces, col + way_col / pieces)
    return row, col, node
