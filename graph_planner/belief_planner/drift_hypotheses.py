"""Drift hypotheses: the node that an item from each start has drifted to by now, under each."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, boundary_of, drifted
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import TABLE_LIMIT, NavigationGraph

PER_AXIS = 5
MEMORY = 1 << 28  # bytes of tables; time is taken in longer strides where they would take more


@kernel
def _carried(
    boundary: Boundary,
    drift: NDArray[np.float64],
    row: NDArray[np.float64],
    col: NDArray[np.float64],
    steps: float,
    node: Int32Array,
) -> None:
    """Carry places (drift, place) along with the drift of each hypothesis for some steps."""
    for w in range(row.shape[0]):
        for x in range(row.shape[1]):
            row[w, x], col[w, x], node[w, x] = drifted(
                boundary, row[w, x], col[w, x], drift[w, 0], drift[w, 1], steps
            )


class DriftHypotheses:
    """Tables of drifted nodes, made as time goes on and shared by all episodes.

    Attributes
    ----------
    drift : (hypothesis, 2) [node/step]
    axis : (value,) the drifts per axis that the hypotheses combine, ascending
    """

    def __init__(self, graph: NavigationGraph, walls: str, largest: float, horizon: int) -> None:
        n = len(graph)
        many = PER_AXIS if n <= TABLE_LIMIT and largest > 0 else 1
        self.axis = largest * (np.arange(many) - (many - 1) / 2) * 2.0 / many
        self.drift = np.array([(r, c) for r in self.axis for c in self.axis])
        hypotheses = many * many
        self._stride = max(1, int(np.ceil(4.0 * hypotheses * n * horizon / MEMORY)))
        self._row = np.tile(graph.rows.astype(np.float64), (hypotheses, 1))
        self._col = np.tile(graph.cols.astype(np.float64), (hypotheses, 1))
        self._tables = [np.tile(np.arange(n, dtype=np.int32), (hypotheses, 1))]
        self._boundary, self._still = boundary_of(graph, walls), many == 1

    def nodes(self, step: int) -> Int32Array:
        """(hypothesis, node) where an item that started in a node is after so many steps."""
        if self._still:
            return self._tables[0]
        number = step // self._stride
        while len(self._tables) <= number:
            table = np.empty_like(self._tables[0])
            stride = float(self._stride)
            _carried(self._boundary, self.drift, self._row, self._col, stride, table)
            self._tables.append(table)
        return self._tables[number]


@lru_cache(maxsize=8)
def drift_hypotheses_of(
    graph: NavigationGraph, walls: str, largest: float, horizon: int
) -> DriftHypotheses:
    """The drift_hypotheses of a map for drifts of up to `largest` per axis, made once and kept."""
    return DriftHypotheses(graph, walls, largest, horizon)
