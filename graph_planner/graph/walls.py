"""Boundary condition of items: one that drifts onto land goes to the nearest node, in its square to
where `rules.walls` of the scenario puts it (definitions, section 1).
"""

import numpy as np

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import Water

INSET = 0.49  # an item pushed back into a node keeps this far from its centre at most [node]
WALLS = ("clip", "project", "published")
"""Values of `rules.walls`; kernels take the place in this list."""


@inlined
def put_back(
    walls: int, row: float, col: float, centre_row: float, centre_col: float
) -> tuple[float, float]:
    """A position outside a node's square, moved into it by the rule of walls.

    clip: each component to +-0.49. project: the offset from the centre is scaled as a whole, its
    larger component to 0.49. published: so, and the smaller component takes the sign of the lesser
    of the two signed offsets, as published (definitions, section 1); of equal magnitudes
    the column is that one. An offset within the square is kept.
    """
    if walls == 0:
        row = min(max(row, centre_row - INSET), centre_row + INSET)
        return row, min(max(col, centre_col - INSET), centre_col + INSET)
    off_row, off_col = row - centre_row, col - centre_col
    largest = max(abs(off_row), abs(off_col))
    if largest <= INSET:
        return row, col
    back_row, back_col = off_row * (INSET / largest), off_col * (INSET / largest)
    if walls == 2:
        lesser = min(off_row, off_col)
        sign = np.sign(lesser)
        if abs(off_row) < abs(off_col):
            back_row = abs(back_row) * sign
        else:
            back_col = abs(back_col) * sign
    return centre_row + back_row, centre_col + back_col


@kernel
def _search_outwards(framed: Int32Array, row: float, col: float) -> int:
    """`nearest_node` by rings; what is outside of reach q is at least q + 0.5 away."""
    height, width = framed.shape
    centre_row, centre_col = int(row + 0.5) + 1, int(col + 0.5) + 1
    best, best_squared = -1, np.inf
    for reach in range(height + width):
        left, right = max(0, centre_col - reach), min(width - 1, centre_col + reach)
        for r in range(max(0, centre_row - reach), min(height, centre_row + reach + 1)):
            edge = abs(r - centre_row) == reach  # all of the ring's row, or its two ends
            stride = 1 if edge else max(1, 2 * reach)
            for c in range(left if edge else centre_col - reach, right + 1, stride):
                node = int(framed[r, c]) if c >= 0 else -1
                squared = (r - 1 - row) ** 2 + (c - 1 - col) ** 2
                if node >= 0 and (
                    squared < best_squared or (squared == best_squared and node < best)
                ):
                    best, best_squared = node, squared
        if best_squared < (reach + 0.5) ** 2:
            break
    return best


@inlined
def nearest_node(framed: Int32Array, row: float, col: float) -> int:
    """Node whose centre is nearest to a position on a land cell; ties: the lowest row-major index.

    Hot, because items lie on quays: the eight cells around are compared without branches, and only
    if something farther could be nearer does a search go on.
    """
    r, c = int(row + 0.5), int(col + 0.5)
    best, best_squared = -1, np.inf
    for i in range(3):
        squared_rows = (r + i - 1 - row) * (r + i - 1 - row)
        for j in range(3):
            node = int(framed[np.uint64(r + i), np.uint64(c + j)])
            squared = squared_rows + (c + j - 1 - col) * (c + j - 1 - col)
            squared = squared if node >= 0 else np.inf
            best = node if squared < best_squared else best
            best_squared = min(best_squared, squared)
    if best_squared >= 1.5**2:
        best = _search_outwards(framed, row, col)
    return best


@inlined
def own_node(framed: Int32Array, row: float, col: float) -> int:
    """Node in whose square a position lies, -1 on land or off the map."""
    height, width = framed.shape[0] - 2, framed.shape[1] - 2
    inside = (row >= -0.5) & (row < height - 0.5) & (col >= -0.5) & (col < width - 0.5)
    return int(framed[int(row + 1.5), int(col + 1.5)]) if inside else -1


@inlined
def into_water(water: Water, walls: int, row: float, col: float) -> tuple[float, float, int]:
    """Position and node of an item; out of navigable water it is moved to the nearest node's
    square.

    Clipped to the array first, then put back around the nearest node's centre by the rule of walls
    (definitions, section 1).
    """
    framed, rows, cols = water.framed, water.rows, water.cols
    node = own_node(framed, row, col)
    if node < 0:
        row = min(max(row, 0.0), framed.shape[0] - 3.0)
        col = min(max(col, 0.0), framed.shape[1] - 3.0)
        node = own_node(framed, row, col)
        if node < 0:
            node = nearest_node(framed, row, col)
        row, col = put_back(walls, row, col, rows[node], cols[node])
    return row, col, node
