"""Differences between several maps: mean products of their smoothed differences from one.

The model error of two maps is a quadratic form: with d the differences of their nodes and G the
filter of `model_error`, the mean of (G d)^2 over the nodes is d' K d with K = G' M G / nodes, M
taking the cells of nodes. K is 0 between nodes that are more than twice the filter's reach apart,
and worked out once for a map. So all pairs of maps cost little more than the few nodes in which
any of them differs.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.metrics._checks import BoolArray, FloatArray, IntArray
from mjforage.metrics.model_error import RADIUS, checked_map, filter_weights, mirrored, node_cells

_REACH = 2 * RADIUS
_WIDTH = 2 * RADIUS + 1
_SPAN = 2 * _REACH + 1


def error_products(
    base: NDArray[np.number],
    maps: NDArray[np.number],
    truth: NDArray[np.number],
    navigable: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """Mean over the nodes of the products of two maps' smoothed differences from a third.

    Parameters
    ----------
    base : (..., node) items in each node
    maps : (..., map, node) the same of each map
    truth : (..., node) of one more map
    navigable : (row, column) True where there is a node

    Returns
    -------
    among : (..., map, map) of the maps, symmetric [item^2]; the root of the diagonal is the RMSE of
        `model_error` between a map and the base
    with_truth : (..., map) of each map and the truth [item^2]
        Both have the same bits whatever the leading axes.

    Raises
    ------
    ValueError
        as `model_error`.
    """
    cells = node_cells(navigable)
    one = np.ascontiguousarray(checked_map("base", base, cells))
    true = np.ascontiguousarray(checked_map("truth", truth, cells))
    many = np.ascontiguousarray(checked_map("maps", maps, cells))
    if many.ndim < 2 or not many.shape[:-2] == one.shape[:-1] == true.shape[:-1]:
        raise ValueError(
            f"maps has shape {many.shape}, base {one.shape} and truth {true.shape}: "
            "(..., map, node) and (..., node) are needed"
        )
    among, with_truth = np.zeros((*many.shape[:-1], many.shape[-2])), np.zeros(many.shape[:-1])
    _products(
        one.reshape(-1, cells.size),
        many.reshape(-1, *many.shape[-2:]),
        true.reshape(-1, cells.size),
        _water_of(np.asarray(navigable).tobytes(), np.shape(navigable)),
        among.reshape(-1, *among.shape[-2:]),
        with_truth.reshape(-1, many.shape[-2]),
    )
    return among, with_truth


class _Water(NamedTuple):
    """A map's nodes."""

    row: IntArray  # (node,)
    column: IntArray  # (node,)
    overlap: FloatArray  # (node, rows down, columns) K, half of it: as far as it is not 0


@lru_cache(maxsize=4)
def _water_of(grid: bytes, shape: tuple[int, int]) -> _Water:
    """Water of a map."""
    navigable = np.frombuffer(grid, np.bool_).reshape(shape)
    cells = np.flatnonzero(navigable)
    number = np.full(shape, -1, np.int64)
    number[navigable] = np.arange(cells.size)
    overlap = _overlaps(_responses(navigable, cells, filter_weights()), number, cells)
    return _Water(cells // shape[1], cells % shape[1], overlap)


@kernel
def _responses(navigable: BoolArray, cells: IntArray, weights: FloatArray) -> FloatArray:
    """(node, 9, 9) what an item of each node gives to the nodes around it once smoothed."""
    rows, columns = navigable.shape
    near = np.zeros((cells.size, _WIDTH, _WIDTH))
    for n in range(cells.size):
        row, column = cells[n] // columns, cells[n] % columns
        for i in range(_WIDTH):
            for j in range(_WIDTH):
                to_row = mirrored(row + i, rows) - RADIUS
                to_column = mirrored(column + j, columns) - RADIUS
                if navigable[to_row, to_column]:
                    down, right = to_row - row + RADIUS, to_column - column + RADIUS
                    near[n, down, right] += weights[i, j]
    return near


@kernel
def _overlaps(near: FloatArray, number: IntArray, cells: IntArray) -> FloatArray:
    """(node, 9, 17) K of each node with those up to 8 rows below and 8 columns beside it."""
    rows, columns = number.shape
    out = np.zeros((cells.size, _REACH + 1, _SPAN))
    for n in range(cells.size):
        row, column = cells[n] // columns, cells[n] % columns
        for down in range(min(_REACH + 1, rows - row)):
            for right in range(max(-_REACH, -column), min(_REACH + 1, columns - column)):
                other = number[row + down, column + right]
                if other < 0:
                    continue
                total = 0.0
                for i in range(down, _WIDTH):
                    for j in range(max(0, right), min(_WIDTH, _WIDTH + right)):
                        total += near[n, i, j] * near[other, i - down, j - right]
                out[n, down, right + _REACH] = total / cells.size
    return out


@kernel
def _products(
    base: NDArray[np.number],  # (batch, node)
    maps: NDArray[np.number],  # (batch, map, node)
    truth: NDArray[np.number],  # (batch, node)
    water: _Water,
    among: FloatArray,  # (batch, map, map) out, zeros before
    with_truth: FloatArray,  # (batch, map) out, zeros before
) -> None:
    """Products of every batch, over the nodes in which any map differs, and those of the truth."""
    many, nodes, flags = maps.shape[1], maps.shape[2], _flags(maps.shape[2])
    where, wrong = np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    apart, smooth = np.empty((nodes, many)), np.empty((nodes, many))
    for b in range(maps.shape[0]):
        count = _differing(base[b], maps[b], flags, where)
        if count == 0:
            continue
        for p in range(count):
            for m in range(many):
                apart[p, m] = np.float64(maps[b, m, where[p]]) - np.float64(base[b, where[p]])
        _smooth(water, where[:count], apart, smooth)
        errors = _differing(base[b], truth[b : b + 1], flags, wrong)
        for p in range(count):
            error = _smooth_at(water, where[p], wrong[:errors], base[b], truth[b])
            for m in range(many):
                with_truth[b, m] += apart[p, m] * error
                for k in range(m + 1):
                    among[b, m, k] += apart[p, m] * smooth[p, k]
        for m in range(many):
            for k in range(m):
                among[b, k, m] = among[b, m, k]


@kernel
def _smooth(water: _Water, where: IntArray, apart: FloatArray, smooth: FloatArray) -> None:
    """K times what is given of the nodes `where`, in these: (listed, map)."""
    row, column, overlap, many = water.row, water.column, water.overlap, apart.shape[1]
    for p in range(where.size):
        for m in range(many):
            smooth[p, m] = overlap[where[p], 0, _REACH] * apart[p, m]
    for p in range(where.size):
        n = where[p]
        for q in range(p + 1, where.size):
            down, right = row[where[q]] - row[n], column[where[q]] - column[n]
            if down > _REACH:
                break
            if abs(right) <= _REACH:
                weight = overlap[n, down, right + _REACH]
                for m in range(many):
                    smooth[p, m] += weight * apart[q, m]
                    smooth[q, m] += weight * apart[p, m]


@kernel
def _smooth_at(
    water: _Water,
    n: int,
    wrong: IntArray,  # (error,) the nodes in which the truth differs from the base, ascending
    base: NDArray[np.number],  # (node,)
    truth: NDArray[np.number],  # (node,)
) -> float:
    """K times the difference of the truth from the base, in one node."""
    row, column, overlap, total = water.row, water.column, water.overlap, 0.0
    for q in range(wrong.size):
        other = wrong[q]
        down, right = row[other] - row[n], column[other] - column[n]
        if abs(right) > _REACH or down < -_REACH:
            continue
        if down > _REACH:
            break
        if down >= 0:
            weight = overlap[n, down, right + _REACH]
        else:
            weight = overlap[other, -down, _REACH - right]
        total += weight * (np.float64(truth[other]) - np.float64(base[other]))
    return total


@kernel
def _flags(nodes: int) -> NDArray[np.uint8]:
    """Memory of `_differing`: a byte for each node, in words of eight."""
    return np.zeros(-(-nodes // 8) * 8, np.uint8)


@kernel
def _differing(
    base: NDArray[np.number],  # (node,)
    maps: NDArray[np.number],  # (map, node)
    flags: NDArray[np.uint8],
    where: IntArray,  # (node,) out, in ascending order
) -> int:
    """List the nodes in which any map differs; how many. Words without any are passed over."""
    for m in range(maps.shape[0]):
        mine = maps[m]
        if m == 0:
            for n in range(base.size):
                flags[n] = mine[n] != base[n]
        else:
            for n in range(base.size):
                flags[n] |= mine[n] != base[n]
    words, count = flags.view(np.uint64), 0
    for w in range(words.size):
        if words[w]:
            for n in range(8 * w, 8 * w + 8):
                if flags[n]:
                    where[count] = n
                    count += 1
    return count
