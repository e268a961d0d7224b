"""Covers of a map: what each kind of scout sees, cell by cell, and how far off it is."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.sweeps import Cover
from graph_planner.belief_planner.ways import UInt16Array, Ways, search_back, ways_of
from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.navigation import NavigationGraph
from graph_planner.visibility import NodeLists

LANDMARKS = 40


@lru_cache(maxsize=16)
def landmarks_of(graph: NavigationGraph) -> tuple[Int32Array, Int32Array]:
    """Nodes spread over a map, each the farthest from those before: (landmark,), and the nearest
    one's number for every node: (node,)."""
    marks = [int(np.argmin((graph.rows - graph.rows.mean()) ** 2 + (graph.cols - graph.cols.mean()) ** 2))]
    nearest = graph.distances_from(np.array(marks, np.int32)).copy()
    belongs = np.zeros(len(graph), np.int32)
    while len(marks) < min(LANDMARKS, len(graph)):
        far = int(np.argmax(np.where(np.isfinite(nearest), nearest, -1.0)))
        away = graph.distances_from(np.array([far], np.int32))
        closer = away < nearest
        belongs[closer], nearest = len(marks), np.minimum(nearest, away)
        marks.append(far)
    return np.array(marks, np.int32), belongs


@kernel
def _seers(lists: NodeLists, radius: int, node: int, out: Int32Array) -> int:
    """Nodes from which a node is seen: those it sees, for lines of sight are nearly symmetric."""
    n = 0
    for i in range(lists.start[radius, node], lists.start[radius, node + 1]):
        viewer = lists.nodes[i]
        for k in range(lists.start[radius, viewer], lists.start[radius, viewer + 1]):
            if lists.nodes[k] == node:
                out[n] = viewer
                n += 1
                break
    return n


@kernel
def _until_seen(ways: Ways, lists: NodeLists, radius: int, marks: Int32Array) -> UInt16Array:
    rows = np.empty((marks.size, ways.ends.shape[0]), np.uint16)
    seers = np.empty(ways.ends.shape[0], np.int32)
    for i in range(marks.size):
        n = _seers(lists, radius, marks[i], seers)
        search_back(ways.before_start, ways.before, seers[:n], rows[i])
    return rows


@lru_cache(maxsize=32)
def view_cover(
    graph: NavigationGraph,
    radii: tuple[float, ...],
    radius: int,
    moves: int,
    stay: bool,
    shorten: bool,
) -> Cover:
    """Cover by plain sight: cells are nodes, seen within a radius.

    Parameters
    ----------
    radii, radius : the fleet's radii, and the number of the one that is meant
    moves, stay, shorten : how the scout moves, see `MoveRules`
    """
    lists = graph.views(radii)
    marks, belongs = landmarks_of(graph)
    ways = ways_of(graph, moves, stay, shorten)
    rows = _until_seen(ways, lists, radius, marks)
    return Cover(lists.start[radius], lists.nodes, belongs, rows)
