"""Unknowns of a map of elements by elimination, with sums in one order on every processor.

Nested dissection (George 1973) as a multifrontal method (Duff and Reid 1983): elements join into
rectangles by halves, and each rectangle eliminates the unknowns that no element outside it has.
LAPACK and sparse solvers built on BLAS add in an order that depends on the processor.
"""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.forcing.stream_element import FloatArray

IntArray: TypeAlias = NDArray[np.int64]

_FEW = 32  # elements that join at once; about the quickest
_TILE, _WIDE = 16, 512  # rows and columns of a tile, of 64 KiB


class _Front(NamedTuple):
    """Equations of a group of elements for the unknowns that others have too."""

    unknowns: IntArray  # (unknown,) numbers, -1 for zero
    uses: IntArray  # (unknown,) how often the group's elements have it
    rows: FloatArray  # (unknown, unknown + force) matrix, of which the upper triangle, and loads


@kernel
def _add(rows: FloatArray, part: FloatArray, at: IntArray) -> None:
    """Add a part's rows to those of the whole; `at` is where each unknown is, -1 if it is zero."""
    size, whole = at.size, rows.shape[0]
    for a in range(size):
        if at[a] < 0:
            continue
        rows[at[a], at[a]] += part[a, a]
        for b in range(a + 1, size):
            if at[b] == at[a]:
                rows[at[a], at[a]] += 2.0 * part[a, b]
            elif at[b] >= 0:
                rows[min(at[a], at[b]), max(at[a], at[b])] += part[a, b]
        for f in range(rows.shape[1] - whole):
            rows[at[a], whole + f] += part[a, size + f]


@kernel
def _eliminate(rows: FloatArray, own: int) -> None:
    """Gaussian elimination of the first `own` unknowns.

    Tiles of rows take four rows above them at a time, which stay in the processor's cache. Each
    number has its differences in the order of the rows, as without tiles.
    """
    size, wide = rows.shape
    for first in range(0, size, _TILE):
        last, done = min(first + _TILE, size), min(first, own)
        for start in range(first, wide, _WIDE):
            stop = min(start + _WIDE, wide)
            for p in range(0, done - 3, 4):
                for i in range(first, last):
                    a, b = rows[p, i] / rows[p, p], rows[p + 1, i] / rows[p + 1, p + 1]
                    c, d = rows[p + 2, i] / rows[p + 2, p + 2], rows[p + 3, i] / rows[p + 3, p + 3]
                    low = max(i, start)
                    to, e, f = rows[i, low:stop], rows[p, low:stop], rows[p + 1, low:stop]
                    g, h = rows[p + 2, low:stop], rows[p + 3, low:stop]
                    for j in range(to.size):
                        to[j] = to[j] - a * e[j] - b * f[j] - c * g[j] - d * h[j]
            for p in range(done - done % 4, done):
                for i in range(first, last):
                    factor = rows[p, i] / rows[p, p]
                    for j in range(max(i, start), stop):
                        rows[i, j] -= factor * rows[p, j]
        for i in range(first, last):
            for p in range(done, min(i, own)):
                factor = rows[p, i] / rows[p, p]
                for j in range(i, wide):
                    rows[i, j] -= factor * rows[p, j]


@kernel
def _substitute(rows: FloatArray, unknowns: IntArray, solution: FloatArray) -> None:
    """Set the eliminated unknowns, the first ones, given the others."""
    for p in range(rows.shape[0] - 1, -1, -1):
        for f in range(solution.shape[1]):
            left = rows[p, unknowns.size + f]
            for j in range(p + 1, unknowns.size):
                left -= rows[p, j] * solution[unknowns[j], f]
            solution[unknowns[p], f] = left / rows[p, p]


def _halves(group: IntArray, corners: IntArray) -> list[IntArray]:
    """Cut a group of elements across its longer side."""
    of = corners[group]
    low, high = of.min(axis=0), of.max(axis=0)
    axis = int(np.argmax(high - low))
    first = 2 * of[:, axis] < low[axis] + high[axis] + 1
    return [group[first], group[~first]]


class _Elimination:
    """The fronts of all elements, and their rows in the order of elimination."""

    def __init__(self, places: IntArray, corners: IntArray, element: FloatArray) -> None:
        self.places, self.corners, self.element = places, corners, element
        self.uses = np.bincount(places[places >= 0])
        self.steps: list[tuple[FloatArray, IntArray]] = []

    def front(self, group: IntArray) -> _Front:
        """Join a group of elements and eliminate the unknowns that are its own."""
        if group.size > _FEW:
            parts = [self.front(half) for half in _halves(group, self.corners)]
        else:
            once = np.ones(self.places.shape[1], np.int64)
            parts = [_Front(self.places[one], once, self.element) for one in group]
        every = np.concatenate([part.unknowns for part in parts])
        unknowns = np.unique(every[every >= 0])
        at = np.where(every < 0, -1, np.searchsorted(unknowns, every))
        uses = np.zeros(unknowns.size, np.int64)
        np.add.at(uses, at[at >= 0], np.concatenate([part.uses for part in parts])[at >= 0])
        own = uses == self.uses[unknowns]
        order = np.argsort(~own, kind="stable")
        at[at >= 0] = np.argsort(order, kind="stable")[at[at >= 0]]
        forces = self.element.shape[1] - self.element.shape[0]
        rows = np.zeros((order.size, order.size + forces))
        ends = np.cumsum([part.unknowns.size for part in parts])[:-1]
        for part, where in zip(parts, np.split(at, ends), strict=True):
            _add(rows, part.rows, where)
        unknowns, uses, done = unknowns[order], uses[order], int(np.count_nonzero(own))
        _eliminate(rows, done)
        self.steps.append((rows[:done].copy(), unknowns))
        return _Front(unknowns[done:], uses[done:], rows[done:, done:].copy())


def least_of_elements(
    places: IntArray, corners: IntArray, matrix: FloatArray, loads: FloatArray
) -> FloatArray:
    """(unknown, load) least of the sum over elements of x' matrix x / 2 - x' load.

    Parameters
    ----------
    places : (element, k) number of each of an element's unknowns, -1 for one that is zero
    corners : (element, 2) integers, where elements are; they set the order of elimination
    matrix : (k, k) of each element, symmetric; their sum is positive definite
    loads : (k, load) of each element
    """
    elimination = _Elimination(places, corners, np.hstack((matrix, loads)))
    elimination.front(np.arange(len(places)))
    solution = np.zeros((elimination.uses.size, loads.shape[1]))
    for rows, unknowns in reversed(elimination.steps):
        _substitute(rows, unknowns, solution)
    return solution
