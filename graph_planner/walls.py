"""What becomes of an item that drifts onto land: `rules.walls` of a scenario (its section 1)."""

import numpy as np

from graph_planner.compiled import inlined

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
    of the two signed offsets, as the paper's code has it (scenario section 1); of equal magnitudes
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
