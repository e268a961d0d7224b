"""Covers of a map: cells that each kind of scout sees, and their distances."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.missed_detections import assumed_chances
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.spatial_prior import SpatialPrior, spatial_prior_of
from mjforage.graph_planner.belief_planner.sweeps import Cover
from mjforage.graph_planner.belief_planner.ways import UInt16Array, Ways, search_back, ways_of
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import TABLE_LIMIT, NavigationGraph
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.moves import MoveRules
from mjforage.mission.task import Task

LANDMARKS = 40
BLOCK = 2  # nodes across a block of possible hotspots
NOTICED = 0.8  # chance of seeing an item with which a hotspot counts as seen


@lru_cache(maxsize=16)
def landmarks_of(graph: NavigationGraph) -> tuple[Int32Array, Int32Array]:
    """Nodes spread over a map, each the farthest from those before: (landmark,), and the nearest
    one's number for every node: (node,).
    """
    off_middle = (graph.rows - graph.rows.mean()) ** 2 + (graph.cols - graph.cols.mean()) ** 2
    marks = [int(np.argmin(off_middle))]
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
def _until_seen(
    ways: Ways, start: NDArray[np.int64], cells: Int32Array, wanted: Int32Array
) -> UInt16Array:
    """(node, landmark) decisions until some node is reached that sees a landmark's cell."""
    nodes = ways.ends.shape[0]
    rows = np.empty((wanted.size, nodes), np.uint16)
    seers = np.empty(nodes, np.int32)
    for mark in range(wanted.size):
        n = 0
        for v in range(nodes):
            for i in range(start[v], start[v + 1]):
                if cells[i] == wanted[mark]:
                    seers[n] = v
                    n += 1
                    break
        search_back(ways.before_start, ways.before, seers[:n], rows[mark])
    return np.ascontiguousarray(rows.T)


@kernel
def _fresh(
    ends: Int32Array, start: NDArray[np.int64], cells: Int32Array, seen: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Int32Array]:
    """Lists of the cells that are seen after a move and not before it, as in `Cover`."""
    fresh_start = np.zeros(ends.size + 1, np.int64)
    for fills in range(2):  # counts first
        fresh = np.empty(fresh_start[-1], np.int32)
        n = 0
        for v in range(ends.shape[0]):
            for i in range(start[v], start[v + 1]):
                seen[cells[i]] = v + fills * ends.shape[0]
            for move in range(9):
                end = ends[v, move]
                if end >= 0:
                    for i in range(start[end], start[end + 1]):
                        if seen[cells[i]] != v + fills * ends.shape[0]:
                            if fills:
                                fresh[n] = cells[i]
                            n += 1
                fresh_start[9 * v + move + 1] = n
    return fresh_start, fresh


def _cover(
    ways: Ways,
    start: NDArray[np.int64],
    cells: Int32Array,
    landmark: Int32Array,
    wanted: Int32Array,
) -> Cover:
    """The cover of an agent that moves by `ways`; the cells (landmark,) that show a landmark."""
    decisions = _until_seen(ways, start, cells, wanted)
    fresh = _fresh(ways.ends, start, cells, np.full(landmark.size, -1, np.int64))
    return Cover(start, cells, landmark, decisions, *fresh)


@lru_cache(maxsize=32)
def view_cover(
    graph: NavigationGraph,
    radii: tuple[float, ...],
    radius: int,
    moves: int,
    rules: MoveRules,
    across_land: bool = False,
) -> Cover:
    """Cover by plain sight: cells are nodes, seen within a radius.

    Parameters
    ----------
    radii, radius : the fleet's radii, and the number of the one that is meant
    moves, rules : how the scout moves
    across_land : True if it sees across land
    """
    lists = graph.discs(radii) if across_land else graph.views(radii)
    marks, belongs = landmarks_of(graph)
    ways = ways_of(graph, moves, rules)
    start = lists.start[radius]
    return _cover(ways, start, lists.nodes, belongs, marks)


class BlockCover(NamedTuple):
    """Cover by what would be noticed: cells are blocks of nodes in which a hotspot may be."""

    cover: Cover
    block: Int32Array  # (node,) the block of a hotspot's node


@kernel
def _shown(
    lists: NodeLists,
    radius: int,
    prior: SpatialPrior,
    detection: NDArray[np.float64],
    node: int,
    share: NDArray[np.float64],
) -> None:
    """Fill share (hotspot,) with the part of each hotspot's items that a scan from a node shows."""
    nodes, cells, cell_start, shares = lists.nodes, prior.cells, prior.cell_start, prior.shares
    rows, cols, reach, width = prior.rows, prior.cols, prior.reach, prior.node.shape[1]
    share[:] = 0.0
    for i in range(lists.start[radius, node], lists.start[radius, node + 1]):
        x = nodes[i]
        chance = detection[(rows[x] - rows[node]) ** 2 + (cols[x] - cols[node]) ** 2]
        for k in range(cell_start[x], cell_start[x + 1]):
            row, col = cells[k] // width - reach, cells[k] % width - reach
            for c in range(share.size):
                down, right = row - rows[c] + reach, col - cols[c] + reach
                if 0 <= down <= 2 * reach and 0 <= right <= 2 * reach:
                    share[c] += chance * (shares[down] * shares[right])


@kernel
def _noticed(
    lists: NodeLists,
    radius: int,
    prior: SpatialPrior,
    block: Int32Array,
    size: NDArray[np.int64],
    detection: NDArray[np.float64],
    least: float,
) -> NDArray[np.bool_]:
    """(node, block) whether half the hotspots of a block show at least a share `least` there."""
    n = block.size
    share, noticed = np.empty(n), np.zeros(size.size, np.int64)
    found = np.empty((n, size.size), np.bool_)
    for v in range(n):
        _shown(lists, radius, prior, detection, v, share)
        noticed[:] = 0
        for c in range(n):
            noticed[block[c]] += share[c] >= least
        for b in range(size.size):
            found[v, b] = 2 * noticed[b] >= size[b]
    return found


@lru_cache(maxsize=32)
def _block_cover(
    graph: NavigationGraph,
    radii: tuple[float, ...],
    radius: int,
    moves: int,
    rules: MoveRules,
    across_land: bool,
    spread: float,
    detection: tuple[float, ...],
    least: float,
) -> BlockCover:
    if len(graph) > TABLE_LIMIT:  # plain sight, one block per node
        plain = view_cover(graph, radii, radius, moves, rules, across_land)
        return BlockCover(plain, np.arange(len(graph), dtype=np.int32))
    across = graph.shape[1] // BLOCK + 1
    names = graph.rows // BLOCK * across + graph.cols // BLOCK
    found, block = np.unique(names, return_inverse=True)
    block, size = block.astype(np.int32), np.bincount(block).astype(np.int64)
    lists = graph.discs(radii) if across_land else graph.views(radii)
    prior = spatial_prior_of(graph, spread)
    noticed = _noticed(lists, radius, prior, block, size, np.array(detection), least)
    start = np.concatenate(([0], np.cumsum(noticed.sum(axis=1))))
    cells = np.nonzero(noticed)[1].astype(np.int32)
    marks, belongs = landmarks_of(graph)
    landmark = np.zeros(found.size, np.int32)
    landmark[block[::-1]] = belongs[::-1]
    ways = ways_of(graph, moves, rules)
    return BlockCover(_cover(ways, start, cells, landmark, block[marks]), block)


LEAST_SHAPE = 0.02  # of the number of items: a deviation of seven times its mean


def hotspot_cover(task: Task, agent: int, settings: BeliefSettings) -> BlockCover:
    """Hotspots that an agent would notice from every node: `NOTICED` sure to see an item."""
    shape = max((settings.items / settings.items_sd) ** 2, LEAST_SHAPE)
    rate = shape * settings.hotspots / settings.items
    least = rate * ((1.0 - NOTICED) ** (-1.0 / shape) - 1.0)
    return _block_cover(
        task.graph,
        task.view_radii,
        int(task.radius_number[agent]),
        int(task.fleet.moves[agent]),
        task.rules,
        task.across_land,
        settings.spread_node,
        tuple(assumed_chances(task, settings).tolist()),
        least,
    )
