"""Model error: root mean squared difference of the smoothed true and estimated item maps.

Equation: paper, "Primary metrics", "RMSE". The Gaussian filter is linear, so the difference of
the filtered maps is the filtered difference, and that differs from 0 near few nodes only: the
kernel adds one stencil per differing node into a padded map, folds the padding back at the
borders (scipy's mode `reflect`) and sums squares inside the bounding box.
"""

import math
from functools import lru_cache
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.metrics._checks import BoolArray, FloatArray, IntArray, first, same_shape

SIGMA = 1.0
"""Standard deviation of the filter [node], paper "RMSE"."""
RADIUS = 4
"""Reach of the filter [node]: four standard deviations, the default of scipy's filter."""
_WIDTH = 2 * RADIUS + 1

Box = tuple[int, int, int, int]


def model_error(
    truth: NDArray[np.number], estimate: NDArray[np.number], navigable: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """RMSE over the navigable nodes, and the mean over columns of each column's RMSE.

    Both filter the whole array with land 0 as scipy's `gaussian_filter` (sigma 1, reflect).
    `rmse` is the paper's equation; `rmse_columns` takes all rows of a column, land included,
    which is what the paper's printed numbers are.

    Parameters
    ----------
    truth, estimate : (..., node) items in each node; nodes are the True cells in row-major order
    navigable : (row, column) True where there is a node

    Returns
    -------
    rmse, rmse_columns : each (...) [item]; exactly 0 for equal maps, and the same bits whatever
        the leading axes

    Raises
    ------
    ValueError
        the map is not a boolean matrix with a node, the shapes do not fit, or a value is not a
        finite real number.
    """
    cells = node_cells(navigable)
    true, believed = checked_map("truth", truth, cells), checked_map("estimate", estimate, cells)
    same_shape("truth", true, "estimate", believed)
    rmse, rmse_columns = np.zeros(true.shape[:-1]), np.zeros(true.shape[:-1])
    _errors(
        np.ascontiguousarray(true).reshape(-1, cells.size),
        np.ascontiguousarray(believed).reshape(-1, cells.size),
        np.ascontiguousarray(navigable),
        cells,
        filter_weights(),
        rmse.reshape(-1),
        rmse_columns.reshape(-1),
    )
    return rmse, rmse_columns


def node_cells(navigable: BoolArray) -> IntArray:
    """(node,) flat index of each node's cell; a ValueError if there is none."""
    grid = np.asarray(navigable)
    if grid.ndim != 2 or grid.dtype != np.bool_:
        raise ValueError(
            f"navigable: booleans (row, column) are needed, not {grid.dtype} {grid.shape}"
        )
    cells = np.flatnonzero(grid)
    if cells.size == 0:
        raise ValueError("navigable: the map has no node; at least one True is needed")
    return cells


def checked_map(name: str, values: NDArray[np.number], cells: IntArray) -> NDArray[np.number]:
    """Values (..., node) that fit a map and are finite; a ValueError naming them if not."""
    nodes = np.asarray(values)
    if nodes.ndim == 0 or nodes.shape[-1] != cells.size:
        raise ValueError(f"{name} has shape {nodes.shape} but the map {cells.size} nodes")
    if nodes.dtype.kind not in "biuf":
        raise ValueError(f"{name} has dtype {nodes.dtype}; real numbers are needed")
    if nodes.dtype.kind == "f" and not np.isfinite(nodes).all():
        where = first(~np.isfinite(nodes))
        raise ValueError(f"{name}{list(where)} is {nodes[where]}; finite numbers are needed")
    return nodes


@lru_cache(maxsize=1)
def filter_weights() -> FloatArray:
    """Weights (9, 9) of the filter around one node; they add up to 1."""
    offset = range(-RADIUS, RADIUS + 1)
    weights = np.array([math.exp(-0.5 * (node / SIGMA) ** 2) for node in offset])
    weights /= weights.sum()
    return np.outer(weights, weights)


@kernel
def _errors(
    truth: NDArray[np.number],  # (map, node)
    estimate: NDArray[np.number],  # (map, node)
    navigable: BoolArray,  # (row, column)
    cells: IntArray,  # (node,) flat index of each node's cell
    stencil: FloatArray,
    rmse: FloatArray,  # (map,) out
    rmse_columns: FloatArray,  # (map,) out
) -> None:
    """Root mean squared error of each map after Gaussian filtering: over nodes, and by columns."""
    rows, columns = navigable.shape
    padded = np.zeros((rows + 2 * RADIUS, columns + 2 * RADIUS))
    squares = np.zeros((2, columns))  # per column: over the nodes, over all rows
    for m in range(truth.shape[0]):
        box = _spread(truth[m], estimate[m], cells, columns, stencil, padded)
        if box[0] < 0:
            continue
        _fold(padded, box, rows, columns)
        _square(padded, box, navigable, squares)
        on_nodes = 0.0
        over_columns = 0.0
        for c in range(columns):
            on_nodes += squares[0, c]
            over_columns += sqrt(squares[1, c] / rows)
        rmse[m] = sqrt(on_nodes / cells.size)
        rmse_columns[m] = over_columns / columns
        squares[:] = 0.0


@kernel
def _spread(
    truth: NDArray[np.number],  # (node,)
    estimate: NDArray[np.number],  # (node,)
    cells: IntArray,
    columns: int,
    stencil: FloatArray,
    padded: FloatArray,
) -> Box:
    """Add a stencil per differing node; first and last differing row and column, -1 if none."""
    top, bottom, left, right = -1, -1, columns, -1
    for n in range(cells.size):
        if truth[n] == estimate[n]:
            continue
        row = cells[n] // columns
        column = cells[n] - row * columns
        difference = np.float64(truth[n]) - np.float64(estimate[n])
        for i in range(_WIDTH):
            for j in range(_WIDTH):
                padded[row + i, column + j] += difference * stencil[i, j]
        top = row if top < 0 else top
        bottom = row
        left = min(left, column)
        right = max(right, column)
    return top, bottom, left, right


@kernel
def mirrored(place: int, length: int) -> int:
    """Cell that the padded place `place` repeats: ... 1 0 | 0 1 ... n-1 | n-1 n-2 ..."""
    turn = (place - RADIUS) % (2 * length)
    return RADIUS + (turn if turn < length else 2 * length - 1 - turn)


@kernel
def _fold(padded: FloatArray, box: Box, rows: int, columns: int) -> None:
    """Add what was spread over the borders back onto the map: first rows, then columns."""
    top, bottom, left, right = box
    for p in range(top, bottom + _WIDTH):
        if p < RADIUS or p >= rows + RADIUS:
            q = mirrored(p, rows)
            for c in range(left, right + _WIDTH):
                padded[q, c] += padded[p, c]
    for c in range(left, right + _WIDTH):
        if c < RADIUS or c >= columns + RADIUS:
            d = mirrored(c, columns)
            for p in range(max(top, RADIUS), min(bottom + _WIDTH, rows + RADIUS)):
                padded[p, d] += padded[p, c]


@kernel
def _square(padded: FloatArray, box: Box, navigable: BoolArray, squares: FloatArray) -> None:
    """Sum the squares inside the box per column into `squares`, and clear the box.

    Works on views of one row, which the compiler can vectorise: three times as fast.
    """
    rows, columns = navigable.shape
    top, bottom, left, right = box
    start = max(left, RADIUS)
    stop = min(right + _WIDTH, columns + RADIUS)
    on_nodes = squares[0, start - RADIUS : stop - RADIUS]
    on_all = squares[1, start - RADIUS : stop - RADIUS]
    for p in range(max(top, RADIUS), min(bottom + _WIDTH, rows + RADIUS)):
        line = padded[p, start:stop]
        is_node = navigable[p - RADIUS, start - RADIUS : stop - RADIUS]
        for c in range(line.size):
            square = line[c] * line[c]
            on_nodes[c] += square if is_node[c] else 0.0
            on_all[c] += square
    padded[top : bottom + _WIDTH, left : right + _WIDTH] = 0.0
