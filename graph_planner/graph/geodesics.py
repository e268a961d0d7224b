"""Shortest distances over the navigation graph: 1 per straight edge, sqrt(2) per diagonal one.

The queue is a bucket queue of width 1, the smallest edge cost: two nodes of one bucket cannot
improve each other, so a bucket is settled whole and in any order (Denardo and Fox, "Shortest-route
methods: 1", Operations Research 27, 1979). With edges of at most sqrt(2) three buckets in rotation
are enough.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.row_cache import RowCache, row_of, rows_worth_keeping
from mjforage.base.wholes import rounded

Int32Array = NDArray[np.int32]
Float32Array = NDArray[np.float32]

DIAGONAL = 1.4142135623730951
FAR = np.inf


class Workspace(NamedTuple):
    """Scratch memory of a search, kept between searches: all inf in `distance` when not in use."""

    distance: NDArray[np.float64]  # (node,)
    touched: Int32Array  # (node,) nodes whose distance a search has set
    buckets: Int32Array  # (3, 8 x node) a node comes in once for each edge to it at most
    source: Int32Array  # (1,) of a search from one node
    wanted: Int32Array  # (node,) of a search for some nodes

    @classmethod
    def of(cls, nodes: int) -> "Workspace":
        """Memory for a graph of so many nodes."""
        return cls(*_workspace(nodes))


@kernel
def _workspace(
    nodes: int,
) -> tuple[NDArray[np.float64], Int32Array, Int32Array, Int32Array, Int32Array]:
    """The arrays of a `Workspace`."""
    touched, buckets = np.empty(nodes, np.int32), np.empty((3, 8 * nodes + 1), np.int32)
    source, wanted = np.empty(1, np.int32), np.empty(nodes, np.int32)
    return np.full(nodes, np.inf), touched, buckets, source, wanted


@kernel
def canonical(distance: float) -> float:
    """Round off the summation order, so that equal distances compare equal."""
    return np.float64(np.float32(rounded(distance * 1e6) / 1e6))


@kernel
def spread(
    neighbours: Int32Array,
    sources: Int32Array,
    wanted: int,
    workspace: Workspace,
) -> int:
    """Distances from the nearest source, outwards until every wanted node is settled.

    Returns: n, the number of nodes touched.

    Parameters
    ----------
    neighbours : (node, 8) int32, -1 where there is no edge; odd directions are diagonal
    sources : (source,) nodes at distance 0
    wanted : how many of `workspace.wanted` must be settled; 0: all nodes are
    workspace : `distance` holds the result; the first `n` of `touched` are the nodes that were set
    """
    distance, touched, buckets = workspace.distance, workspace.touched, workspace.buckets
    first, second, third = 0, 1, 2
    n_0, n_1, n_2, n_touched = 0, 0, 0, 0
    for source in sources:
        if distance[source] != 0.0:
            distance[source] = 0.0
            touched[n_touched] = source
            n_touched += 1
            buckets[first, n_0] = source
            n_0 += 1
    level = 0
    while n_0 + n_1 + n_2 > 0:
        for i in range(n_0):
            node = buckets[first, i]
            here = distance[node]
            if here < level:  # an older entry of a node that was settled earlier
                continue
            for direction in range(8):
                other = neighbours[node, direction]
                if other < 0:
                    continue
                there = here + (DIAGONAL if direction & 1 else 1.0)
                if there < distance[other]:
                    if distance[other] == FAR:
                        touched[n_touched] = other
                        n_touched += 1
                    distance[other] = there
                    if there < level + 2:
                        buckets[second, n_1] = other
                        n_1 += 1
                    else:
                        buckets[third, n_2] = other
                        n_2 += 1
        level += 1
        first, second, third = second, third, first
        n_0, n_1, n_2 = n_1, n_2, 0
        if wanted > 0:
            settled = True
            for i in range(wanted):
                if distance[workspace.wanted[i]] >= level:
                    settled = False
                    break
            if settled:
                break
    return n_touched


@kernel
def _fill(row: Float32Array, neighbours: Int32Array, source: int, workspace: Workspace) -> None:
    """Distances (node,) from a source, inf where there is no way."""
    distance, touched = workspace.distance, workspace.touched
    row[:] = np.float32(np.inf)
    workspace.source[0] = source
    for j in range(spread(neighbours, workspace.source, 0, workspace)):
        row[touched[j]] = np.float32(canonical(distance[touched[j]]))
        distance[touched[j]] = FAR


@kernel
def all_pairs(neighbours: Int32Array) -> Float32Array:
    """Distances between all nodes: (node, node) float32, inf where there is no way."""
    n = neighbours.shape[0]
    table = np.empty((n, n), np.float32)
    distance, touched, buckets, source, wanted = _workspace(n)
    workspace = Workspace(distance, touched, buckets, source, wanted)
    for i in range(n):
        _fill(table[i], neighbours, i, workspace)
    return table


class DistanceRows(NamedTuple):
    """Distances from single nodes: all of them on a small graph, those asked for last on others."""

    cache: RowCache
    distance: Float32Array  # (row, node) [node], inf where there is no way

    @classmethod
    def of_table(cls, table: Float32Array) -> "DistanceRows":
        """All rows, from the table of all pairs (node, node)."""
        every = np.arange(table.shape[0], dtype=np.int32)
        return cls(RowCache(every, every, np.zeros(1, np.int64)), table)

    @classmethod
    def none_yet(cls, nodes: int) -> "DistanceRows":
        """Memory for as many rows of a large graph as are worth keeping."""
        rows = rows_worth_keeping(nodes, 4)
        return cls(RowCache.of(nodes, rows), np.empty((rows, nodes), np.float32))


@kernel
def filled_row(rows: DistanceRows, neighbours: Int32Array, node: int, workspace: Workspace) -> int:
    """Number of the row of distances from a node, searched where it is not kept; asking for another
    node may overwrite it.
    """
    number, missing = row_of(rows.cache, node)
    if missing:
        _fill(rows.distance[number], neighbours, node, workspace)
    return number


@kernel
def distances_of(
    rows: DistanceRows, neighbours: Int32Array, node: int, workspace: Workspace
) -> Float32Array:
    """Distances (node,) from a node; asking for another's may overwrite them."""
    row: Float32Array = rows.distance[filled_row(rows, neighbours, node, workspace)]
    return row


@kernel
def distances_to_nearest(
    neighbours: Int32Array,
    table: Float32Array,
    sources: Int32Array,
    centres: Int32Array,
    targets: Int32Array,
    slack: float,
    workspace: Workspace,
    out: NDArray[np.float64],
) -> None:
    """Distance of each agent's possible targets to the nearest of the sources; inf without sources.

    With the all-pairs table at hand only those sources are compared that can be nearest to some
    target; without it (`table` of shape (0, 0)) one search spreads from the sources.

    Parameters
    ----------
    neighbours : (node, 8) int32
    table : (node, node) float32 or (0, 0)
    sources : (source,) nodes
    centres : (agent,) node of each agent
    targets : (agent, 9) nodes, none farther than `slack` from the agent's; -1 is skipped
    slack : distance [node]
    workspace : scratch memory, left as it was found
    out : (agent, 9) the result [node]
    """
    out[:] = FAR
    if table.shape[0] == 0:
        distance, touched, wanted = workspace.distance, workspace.touched, 0
        for a in range(targets.shape[0]):
            for move in range(9):
                if targets[a, move] >= 0:
                    if wanted < workspace.wanted.size:
                        workspace.wanted[wanted] = targets[a, move]
                    wanted += 1
        some = wanted if wanted <= workspace.wanted.size else 0  # without room for them: all nodes
        n_touched = spread(neighbours, sources, some, workspace)
        for a in range(targets.shape[0]):
            for move in range(9):
                if targets[a, move] >= 0:
                    out[a, move] = canonical(distance[targets[a, move]])
        for i in range(n_touched):
            distance[touched[i]] = FAR
        return
    for a in range(targets.shape[0]):
        centre, nearest = np.uint64(centres[a]), np.float32(np.inf)  # unsigned: see `hear_some`
        for source in sources:
            nearest = min(nearest, table[centre, np.uint64(source)])
        limit = nearest + np.float32(2.0 * slack + 1e-3)
        for source in sources:
            if table[centre, np.uint64(source)] <= limit:
                for move in range(9):
                    target = targets[a, move]
                    if target >= 0:
                        there = np.float64(table[np.uint64(source), np.uint64(target)])
                        out[a, move] = min(out[a, move], there)
