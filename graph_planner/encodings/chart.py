"""The map as the kernels of the egocentric encoding read it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.encodings.encoder import TOP, Levels
from graph_planner.geodesics import Int32Array
from graph_planner.task import Task
from graph_planner.visibility import NodeLists

REACH = 7  # nodes to each side in the crop
COARSE = 16  # cells per side of the coarse map


class Chart(NamedTuple):
    """A map with a frame of land, and its nodes by the cells of a coarse one."""

    framed: Int32Array  # (row + 2 REACH, column + 2 REACH) node of each cell, on land their number
    place: Int32Array  # (node,) its place in a map with a frame of one cell, all in one axis
    width: int  # columns of that map
    coarse: Int32Array  # (node,) cell of the coarse map
    wet: Int32Array  # (wet cell,) cells of the coarse map with water
    start: Int32Array  # (wet cell + 1,) where the nodes of each begin in `nodes`
    nodes: Int32Array  # (node,) by wet cells, ascending in each
    water: Levels  # (wet cell,) level of the share of water
    views: NodeLists
    disc: NDArray[np.int64]  # (radius,) nodes in view on open water

    @classmethod
    def of(cls, task: Task) -> "Chart":
        """The chart of a task's map."""
        graph = task.graph
        height, width = graph.shape
        coarse = (graph.rows * COARSE // height) * COARSE + graph.cols * COARSE // width
        cells = np.arange(height)[:, None] * COARSE // height * COARSE
        cells = cells + np.arange(width)[None, :] * COARSE // width
        area = np.bincount(cells.reshape(-1), minlength=COARSE**2)
        wet, nodes = np.unique(coarse, return_counts=True)
        node_of_cell = np.where(graph.navigable, graph.node_of_cell, len(graph))
        discs = graph.discs(task.view_radii)
        return cls(
            framed=np.pad(node_of_cell, REACH, constant_values=len(graph)).astype(np.int32),
            place=((graph.rows + 1) * (width + 2) + graph.cols + 1).astype(np.int32),
            width=width + 2,
            coarse=coarse.astype(np.int32),
            wet=wet.astype(np.int32),
            start=np.concatenate(([0], np.cumsum(nodes))).astype(np.int32),
            nodes=np.argsort(coarse, kind="stable").astype(np.int32),
            water=(TOP * nodes // area[wet]).astype(np.uint8),
            views=task.views,
            disc=np.diff(discs.start, axis=1).max(axis=1).astype(np.int64),
        )

    @property
    def places(self) -> int:
        """Cells of the map with a frame of one cell."""
        return int(self.place[-1]) + self.width + 2
