"""Visibility: the nodes seen from a node, a disc less what the straight line to it hits.

A node is seen when its distance is at most the radius and every node on the rounded straight line
to it is navigable: 49 nodes in open water for radius 4, 5 for radius 1 (definitions, section 1).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel

Int32Array = NDArray[np.int32]


class NodeLists(NamedTuple):
    """One list of nodes per node, for several radii, in compressed form.

    The list of node v for radius number r is `nodes[start[r, v]:start[r, v + 1]]`.
    """

    start: NDArray[np.int64]  # (radius, node + 1)
    nodes: Int32Array  # (entry,)

    def of(self, node: int, radius: int = 0) -> Int32Array:
        """List of one node for radius number `radius`."""
        return self.nodes[self.start[radius, node] : self.start[radius, node + 1]]


def rounded_line(d_row: int, d_col: int) -> NDArray[np.int64]:
    """Offsets of the nodes on the straight line from (0, 0) to (d_row, d_col), both ends included.

    One node per unit of the longer axis; halves round away from the start. Returns: (point, 2)
    int64.
    """
    points = max(abs(d_row), abs(d_col))
    k = np.arange(points + 1)
    offsets = np.zeros((points + 1, 2), np.int64)
    if points:
        for axis, d in enumerate((d_row, d_col)):
            offsets[:, axis] = np.sign(d) * ((2 * k * abs(d) + points) // (2 * points))
    return offsets


def disc_offsets(radius: float, shape: tuple[int, int]) -> NDArray[np.int64]:
    """Offsets within `radius` of the origin in row-major order: (offset, 2) int64.

    Those alone that join two cells of a map of this shape (rows, columns).
    """
    down, across = (min(int(np.floor(radius)), size - 1) for size in shape)
    d_row, d_col = np.mgrid[-down : down + 1, -across : across + 1]
    inside = d_row**2 + d_col**2 <= radius**2 + 1e-9
    return np.stack((d_row[inside], d_col[inside]), axis=1).astype(np.int64)


def list_bytes(radius: float, shape: tuple[int, int], nodes: int) -> float:
    """Memory that lists of nodes of one radius take at most while they are made [byte].

    Parameters
    ----------
    radius : [node]
    shape : (rows, columns) of the map
    nodes : navigable cells
    """
    down, across = (min(radius, size - 1.0) for size in shape)
    offsets = min(np.pi * radius**2 + 1.0, (2.0 * down + 1.0) * (2.0 * across + 1.0))
    points = 2.0 * max(down, across) / 3.0 + 1.0  # of a mean line
    return float(offsets * points * 32 + nodes * min(offsets, nodes) * 8)


@kernel
def _list_nodes(
    node_of_cell: Int32Array,
    rows: Int32Array,
    cols: Int32Array,
    offsets: NDArray[np.int64],
    line_start: NDArray[np.int64],
    lines: NDArray[np.int64],
    start: NDArray[np.int64],
    nodes: Int32Array,
    fill: bool,
) -> None:
    """List the nodes at given offsets of every node, less those behind land; or only count them."""
    height, width = node_of_cell.shape
    total = start[0]
    for v in range(rows.size):
        start[v] = total
        for o in range(offsets.shape[0]):
            row, col = rows[v] + offsets[o, 0], cols[v] + offsets[o, 1]
            if row < 0 or col < 0 or row >= height or col >= width or node_of_cell[row, col] < 0:
                continue
            free = True
            for p in range(line_start[o], line_start[o + 1]):
                if node_of_cell[rows[v] + lines[p, 0], cols[v] + lines[p, 1]] < 0:
                    free = False
                    break
            if free:
                if fill:
                    nodes[total] = node_of_cell[row, col]
                total += 1
    start[rows.size] = total


def node_lists(
    node_of_cell: Int32Array,
    rows: Int32Array,
    cols: Int32Array,
    radii: tuple[float, ...],
    line_of_sight: bool,
) -> NodeLists:
    """Lists of the nodes within each radius of every node, with or without line of sight.

    Parameters
    ----------
    node_of_cell : (row, column) int32 node of each cell, -1 on land
    rows, cols : (node,) int32
    radii : [node]
    line_of_sight : True if land on the rounded line hides a node
    """
    start = np.zeros((len(radii), rows.size + 1), np.int64)
    parts: list[Int32Array] = []
    total = 0
    for i, radius in enumerate(radii):
        offsets = disc_offsets(radius, (node_of_cell.shape[0], node_of_cell.shape[1]))
        lines = [
            rounded_line(r, c) if line_of_sight else np.zeros((0, 2), np.int64) for r, c in offsets
        ]
        ends = np.cumsum([len(line) for line in lines])
        line_start = np.concatenate(([0], ends)).astype(np.int64)
        flat = np.concatenate(lines) if lines else np.zeros((0, 2), np.int64)
        cells = (node_of_cell, rows, cols, offsets, line_start, flat)
        _list_nodes(*cells, start[i], np.empty(0, np.int32), False)
        nodes = np.empty(int(start[i, -1]), np.int32)
        start[i, 0] = 0
        _list_nodes(*cells, start[i], nodes, True)
        start[i] += total
        total += nodes.size
        parts.append(nodes)
    return NodeLists(start, np.concatenate(parts) if parts else np.empty(0, np.int32))
