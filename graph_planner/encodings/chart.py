"""The map as the kernels of the egocentric encoding read it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.encodings.codes import Codes, distance_codes
from mjforage.graph_planner.encodings.encoder import TOP, Levels
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import Task

REACH = 7  # nodes to each side in the local_map
COARSE = 16  # cells per side of the coarse map
WORD = 8  # places that are looked at at once, a byte each


class Chart(NamedTuple):
    """A map with a frame of land, and its nodes by the cells of a coarse one."""

    framed: Int32Array  # (row + 2 REACH, column + 2 REACH) node of each cell, on land their number
    framed_water: Levels  # the same shape: level of water
    place: Int32Array  # (node,) its place in a map with a frame of one cell, all in one axis
    water_at: Levels  # (place,) 1 on water; some more than the map has, to fill the last word
    node_at: Int32Array  # (place,) the node there, 0 on land
    width: int  # columns of that map
    coarse: Int32Array  # (node,) cell of the coarse map
    wet: Int32Array  # (wet cell,) cells of the coarse map with water, those of few nodes first:
    # loops of one length after the other are foreseen by processors
    start: Int32Array  # (wet cell + 1,) where the nodes of each begin in `nodes`
    nodes: Int32Array  # (node,) by wet cells, ascending in each
    water: Levels  # (wet cell,) level of the share of water
    extent: Int32Array  # (COARSE^2,) nodes of each cell
    views: NodeLists
    disc: NDArray[np.int64]  # (radius,) nodes in view on open water
    codes: Codes  # of the distances between nodes

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
        by_size = np.argsort(nodes, kind="stable")
        rank = np.empty(COARSE**2, np.int64)
        wet, nodes = wet[by_size], nodes[by_size]
        rank[wet] = np.arange(wet.size)
        node_of_cell = np.where(graph.navigable, graph.node_of_cell, len(graph))
        framed = np.pad(node_of_cell, REACH, constant_values=len(graph)).astype(np.int32)
        discs = graph.discs(task.view_radii)
        place = ((graph.rows + 1) * (width + 2) + graph.cols + 1).astype(np.int32)
        places = -(-(height + 2) * (width + 2) // WORD) * WORD
        water_at, node_at = np.zeros(places, np.uint8), np.zeros(places, np.int32)
        water_at[place], node_at[place] = 1, np.arange(len(graph))
        return cls(
            framed=framed,
            framed_water=np.where(framed < len(graph), TOP, 0).astype(np.uint8),
            place=place,
            water_at=water_at,
            node_at=node_at,
            width=width + 2,
            coarse=coarse.astype(np.int32),
            wet=wet.astype(np.int32),
            start=np.concatenate(([0], np.cumsum(nodes))).astype(np.int32),
            nodes=np.argsort(rank[coarse], kind="stable").astype(np.int32),
            water=(TOP * nodes // area[wet]).astype(np.uint8),
            extent=np.bincount(coarse, minlength=COARSE**2).astype(np.int32),
            views=task.views,
            disc=np.diff(discs.start, axis=1).max(axis=1).astype(np.int64),
            codes=distance_codes(graph),
        )
