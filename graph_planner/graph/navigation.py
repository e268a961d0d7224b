"""The navigation graph: nodes of a map, edges between them, distances, views, and metres.

A map is an array of cells, row 0 at the north edge, column 0 at the west edge. A *node* is a
navigable cell, numbered in row-major order. Metres: x = column * pitch (east) and
y = (rows - 1 - row) * pitch (north), so the centre of the south-west cell is the origin (ENU).
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from mjforage.base.compiled import kernel
from mjforage.base.views import read_only
from mjforage.graph_planner.graph.geodesics import (
    DIAGONAL,
    DistanceRows,
    Float32Array,
    Int32Array,
    Workspace,
    all_pairs,
    spread,
)
from mjforage.graph_planner.graph.visibility import NodeLists, node_lists

COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW", "stay")
STAY = 8
OFFSETS = np.array(
    [(-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (0, 0)], np.int64
)  # (move, (row, column)); odd moves are diagonal
TABLE_LIMIT = 6000  # nodes; a table of all pairs then takes 144 MB, beyond it a search serves


@kernel
def _neighbours(
    node_of_cell: Int32Array, rows: Int32Array, cols: Int32Array, corner_cutting: bool
) -> Int32Array:
    """Node (node, direction) beside each node in each direction, -1 where there is no edge."""
    height, width = node_of_cell.shape
    result = np.full((rows.size, 8), np.int32(-1), np.int32)
    for v in range(rows.size):
        for d in range(8):
            row, col = rows[v] + OFFSETS[d, 0], cols[v] + OFFSETS[d, 1]
            if row < 0 or col < 0 or row >= height or col >= width:
                continue
            beside = min(node_of_cell[rows[v], col], node_of_cell[row, cols[v]])
            if corner_cutting or not d & 1 or beside >= 0:
                result[v, d] = node_of_cell[row, col]
    return result


class Water(NamedTuple):
    """Water of a map, as kernels read it."""

    framed: Int32Array  # (row + 2, column + 2) node of each cell in a frame of land, -1 on land
    rows: Int32Array  # (node,)
    cols: Int32Array  # (node,)


@dataclass(frozen=True, eq=False)
class NavigationGraph:
    """A map as a graph of up to eight edges per node.

    Attributes
    ----------
    navigable : (row, column) bool
    pitch_m : distance between neighbouring node centres [m]
    corner_cutting : True if a diagonal edge may pass between two land cells, or beside one
    """

    navigable: NDArray[np.bool_]
    pitch_m: float
    corner_cutting: bool

    def __len__(self) -> int:
        return int(self.rows.size)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of the map."""
        return self.navigable.shape[0], self.navigable.shape[1]

    @cached_property
    def _cells(self) -> tuple[Int32Array, Int32Array]:
        rows, cols = np.nonzero(self.navigable)
        return read_only((rows.astype(np.int32), cols.astype(np.int32)))

    @property
    def rows(self) -> Int32Array:
        """(node,) row of each node."""
        return self._cells[0]

    @property
    def cols(self) -> Int32Array:
        """(node,) column of each node."""
        return self._cells[1]

    @cached_property
    def node_of_cell(self) -> Int32Array:
        """(row, column) node of each cell, -1 on land."""
        result = np.full(self.navigable.shape, -1, np.int32)
        result[self.navigable] = np.arange(len(self), dtype=np.int32)
        return read_only(result)

    @cached_property
    def water(self) -> Water:
        """Cells and nodes as kernels read them."""
        framed = np.pad(self.node_of_cell, 1, constant_values=-1)
        return read_only(Water(framed, self.rows, self.cols))

    @cached_property
    def corners(self) -> NDArray[np.bool_]:
        """(node, 4) whether the three other cells around a corner of a node's square are all land:
        north-west, north-east, south-west, south-east.
        """
        land, r, c = self.water.framed < 0, self.rows + 1, self.cols + 1
        shut = [
            land[r + down, c] & land[r, c + right] & land[r + down, c + right]
            for down in (-1, 1)
            for right in (-1, 1)
        ]
        return read_only(np.stack(shut, axis=1))

    @cached_property
    def neighbours(self) -> Int32Array:
        """(node, 8) neighbour in each compass direction, -1 where there is no edge."""
        about = self.node_of_cell, self.rows, self.cols, self.corner_cutting
        return read_only(_neighbours(*about))

    @cached_property
    def edges(self) -> "sparse.csr_array[np.float64]":
        """(node, node) sparse costs: 1 and sqrt(2) [node]."""
        start, direction = np.nonzero(self.neighbours >= 0)
        cost = np.where(direction % 2 == 1, DIAGONAL, 1.0)
        shape = (len(self), len(self))
        edges = sparse.csr_array((cost, (start, self.neighbours[start, direction])), shape=shape)
        for name in ("data", "indices", "indptr"):
            setattr(edges, name, read_only(getattr(edges, name)))
        return edges

    @cached_property
    def distances(self) -> Float32Array:
        """(node, node) geodesic distances [node], or (0, 0) on a map too large for a table."""
        if len(self) > TABLE_LIMIT:
            return np.empty((0, 0), np.float32)
        return read_only(all_pairs(self.neighbours))

    @cached_property
    def distance_rows(self) -> DistanceRows:
        """Distances from single nodes, on a map of any size; kernels of ours fill it."""
        if len(self) > TABLE_LIMIT:
            return read_only(DistanceRows.none_yet(len(self)))
        return read_only(DistanceRows.of_table(self.distances))

    def distances_from(self, nodes: Int32Array) -> NDArray[np.float64]:
        """(node,) geodesic distance [node] of every node to the nearest of `nodes`."""
        workspace = Workspace.of(len(self))
        sources = np.ascontiguousarray(nodes, np.int32)
        spread(self.neighbours, sources, 0, workspace)
        return workspace.distance

    def views(self, radii: tuple[float, ...]) -> NodeLists:
        """Nodes seen from every node, for each radius [node]."""
        return _cached_lists(self, radii, True)

    def discs(self, radii: tuple[float, ...]) -> NodeLists:
        """Nodes within each radius [node] of every node, whatever lies between."""
        return _cached_lists(self, radii, False)

    def grid(self, values: NDArray[np.generic]) -> NDArray[np.generic]:
        """Lay (..., node) values out as (..., row, column), 0 on land."""
        result = np.zeros((*values.shape[:-1], *self.shape), values.dtype)
        result[..., self.navigable] = values
        return result

    def metres(self, rc: NDArray[np.floating]) -> NDArray[np.float64]:
        """(..., 2) positions (row, column) in node units as (x, y) in metres, ENU."""
        y = (self.shape[0] - 1 - rc[..., 0]) * self.pitch_m
        return np.stack((rc[..., 1] * self.pitch_m, y), axis=-1).astype(np.float64)

    def row_column(self, xy: NDArray[np.floating]) -> NDArray[np.float64]:
        """(..., 2) positions (x, y) in metres as (row, column) in node units."""
        row = self.shape[0] - 1 - xy[..., 1] / self.pitch_m
        return np.stack((row, xy[..., 0] / self.pitch_m), axis=-1).astype(np.float64)


@lru_cache(maxsize=32)
def _cached_lists(graph: NavigationGraph, radii: tuple[float, ...], sight: bool) -> NodeLists:
    return read_only(node_lists(graph.node_of_cell, graph.rows, graph.cols, radii, sight))


@lru_cache(maxsize=8)
def _cached_graph(
    cells: bytes, shape: tuple[int, int], pitch_m: float, corner_cutting: bool
) -> NavigationGraph:
    navigable = np.frombuffer(cells, np.bool_).reshape(shape)
    return NavigationGraph(navigable, pitch_m, corner_cutting)


def navigation_graph(
    navigable: NDArray[np.bool_], pitch_m: float, corner_cutting: bool
) -> NavigationGraph:
    """The graph of a map, built once per map and kept.

    Parameters
    ----------
    navigable : (row, column) bool
    pitch_m : distance between neighbouring node centres [m]
    corner_cutting : True if diagonals may cut corners
    """
    cells = np.ascontiguousarray(navigable, np.bool_)
    shape = (cells.shape[0], cells.shape[1])
    return _cached_graph(cells.tobytes(), shape, float(pitch_m), bool(corner_cutting))
