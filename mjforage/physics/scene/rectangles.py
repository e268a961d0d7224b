"""Splitting land cells into few rectangles: every one becomes one collider."""

import numpy as np
from numpy.typing import NDArray


def merged_rectangles(land: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Cover all land cells with rectangles that do not overlap, greedily.

    In row-major order, every cell not yet covered starts a rectangle that grows east as far as it
    can and then south as far as it can.

    `land`: (row, column) bool. Returns: ndarray, shape (rectangle, 4), int64: first row, first
    column, row and column past the last.
    """
    left = np.array(land, np.bool_)
    found: list[tuple[int, int, int, int]] = []
    for row, col in zip(*np.nonzero(left), strict=True):
        if not left[row, col]:
            continue
        right, bottom = int(col) + 1, int(row) + 1
        while right < left.shape[1] and left[row, right]:
            right += 1
        while bottom < left.shape[0] and left[bottom, col:right].all():
            bottom += 1
        left[row:bottom, col:right] = False
        found.append((int(row), int(col), bottom, right))
    return np.array(found, np.int64).reshape(-1, 4)


def narrowest_passage(navigable: NDArray[np.bool_]) -> int:
    """Width of the narrowest passage [cell]: of every water cell, the shorter of its two runs.

    A run is the stretch of water cells through the cell, east-west or north-south; the map's edge
    ends it.
    """
    return int(np.minimum(_runs(navigable), _runs(navigable.T).T)[navigable].min())


def _runs(water: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(row, column) length of the run of water along the row through each cell, 0 on land."""
    lengths = np.zeros(water.shape, np.int64)
    for row, cells in enumerate(water):
        edges = np.flatnonzero(np.diff(np.pad(cells, 1).astype(np.int8)))
        for start, stop in edges.reshape(-1, 2):
            lengths[row, start:stop] = stop - start
    return lengths
