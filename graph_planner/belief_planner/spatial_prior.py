"""Spatial prior of a hotspot's items: Gaussian per axis, what falls on land is put beside it.

P0[c, x] is the probability that an item of a hotspot in node c starts in node x: the integral of
the Gaussian over every cell, counted for the cell's nearest node. It is never tabulated: sums over
x or over c are separable convolutions over the map with a margin.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import nearest_of_cells
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph

MARGIN = 3.2  # the Gaussian is cut at so many standard deviations


class SpatialPrior(NamedTuple):
    """The map with a margin, and the Gaussian's shares per cell."""

    reach: int  # cells of margin
    shares: NDArray[np.float64]  # (2 reach + 1,) of the cells along an axis
    node: Int32Array  # (row + 2 reach, column + 2 reach) nearest node of every cell
    cell_start: NDArray[np.int64]  # (node + 1,) the cells of a node, numbered row by row
    cells: NDArray[np.int64]  # `cells[cell_start[x]:cell_start[x + 1]]`
    rows: Int32Array  # (node,)
    cols: Int32Array  # (node,)


@lru_cache(maxsize=16)
def spatial_prior_of(graph: NavigationGraph, spread: float) -> SpatialPrior:
    """The prior of a hotspot on a map, for a standard deviation per axis [node]."""
    reach = min(int(np.ceil(MARGIN * spread)), max(graph.shape))
    steps = np.arange(-reach, reach + 1)
    shares = ndtr((steps + 0.5) / spread) - ndtr((steps - 0.5) / spread)
    node = np.pad(nearest_of_cells(graph), reach, mode="edge").astype(np.int32)
    order = np.argsort(node.ravel(), kind="stable").astype(np.int64)
    start = np.searchsorted(node.ravel()[order], np.arange(len(graph) + 1)).astype(np.int64)
    return SpatialPrior(reach, shares / shares.sum(), node, start, order, graph.rows, graph.cols)


@kernel
def bounds(prior: SpatialPrior, weight: NDArray[np.float64], least: float) -> NDArray[np.int64]:
    """First and last row and column (4,) of the nodes with more than `least` weight (node,)."""
    box = np.array([1 << 40, -1, 1 << 40, -1])
    for node in range(weight.size):
        if weight[node] > least:
            row, col = np.int64(prior.rows[node]), np.int64(prior.cols[node])
            box[0], box[1] = min(box[0], row), max(box[1], row)
            box[2], box[3] = min(box[2], col), max(box[3], col)
    return box


@kernel
def gathered(
    prior: SpatialPrior,
    value: NDArray[np.float64],
    box: NDArray[np.int64],
    out: NDArray[np.float64],
) -> None:
    """out[c] = sum over x of P0[c, x] value[x] for the nodes c of a box; others are left alone."""
    reach, shares, node = prior.reach, prior.shares, prior.node
    top, bottom, left, right = box
    if bottom < top:
        return
    height, width = bottom - top + 1 + 2 * reach, right - left + 1
    across = np.zeros((height, width))
    line = np.empty(width + 2 * reach)
    for r in range(height):
        for c in range(width + 2 * reach):
            line[c] = value[node[top + r, left + c]]
        for k in range(2 * reach + 1):
            share = shares[k]
            for c in range(width):
                across[r, c] += share * line[c + k]
    result = np.zeros((bottom - top + 1, width))
    for r in range(bottom - top + 1):
        for k in range(2 * reach + 1):
            share = shares[k]
            for c in range(width):
                result[r, c] += share * across[r + k, c]
    rows, cols = prior.rows, prior.cols
    for v in range(rows.size):
        if top <= rows[v] <= bottom and left <= cols[v] <= right:
            out[v] = result[rows[v] - top, cols[v] - left]


@kernel
def scattered(
    prior: SpatialPrior,
    weight: NDArray[np.float64],
    box: NDArray[np.int64],
    out: NDArray[np.float64],
) -> None:
    """out[x] += sum over the nodes c of a box of weight[c] P0[c, x]."""
    reach, shares, node = prior.reach, prior.shares, prior.node
    rows, cols = prior.rows, prior.cols
    top, bottom, left, right = box
    if bottom < top:
        return
    height, width = bottom - top + 1, right - left + 1
    field = np.zeros((height, width))
    for v in range(rows.size):
        if top <= rows[v] <= bottom and left <= cols[v] <= right:
            field[rows[v] - top, cols[v] - left] = weight[v]
    down = np.zeros((height + 2 * reach, width))
    for r in range(height):
        for k in range(2 * reach + 1):
            share = shares[k]
            for c in range(width):
                down[r + k, c] += share * field[r, c]
    line = np.empty(width + 2 * reach)
    for r in range(height + 2 * reach):
        line[:] = 0.0
        for k in range(2 * reach + 1):
            share = shares[k]
            for c in range(width):
                line[c + k] += share * down[r, c]
        for c in range(width + 2 * reach):
            out[node[top + r, left + c]] += line[c]


@kernel
def start_chances(prior: SpatialPrior, start: int, out: NDArray[np.float64]) -> None:
    """out[c] = P0[c, start] for all hotspots c."""
    reach, shares, width = prior.reach, prior.shares, prior.node.shape[1]
    rows, cols = prior.rows, prior.cols
    out[:] = 0.0
    for i in range(prior.cell_start[start], prior.cell_start[start + 1]):
        row, col = prior.cells[i] // width - reach, prior.cells[i] % width - reach
        for c in range(rows.size):
            down, right = row - rows[c] + reach, col - cols[c] + reach
            if 0 <= down <= 2 * reach and 0 <= right <= 2 * reach:
                out[c] += shares[down] * shares[right]
