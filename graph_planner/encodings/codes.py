"""Distances between nodes as numbers of 16 bits, which are ordered as the distances are.

A map has few different distances: 1,173 on the comb port, of 1.7 million pairs of nodes. Looking up
pairs here and there waits for memory, of which this table takes half.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.views import read_only
from mjforage.graph_planner.graph.geodesics import Float32Array, Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph

MOST_CODES = 2**16
PARTS = 2.0**23  # of a node, which distances in float32 are multiples of: they are 0 or at least 1


@inlined
def parts_of(distance: np.float32) -> np.int64:
    """A distance [node] in whole parts, whose sums are exact; 0 where there is no way."""
    return np.int64(np.float64(distance) * PARTS if distance < np.inf else 0.0)


class Codes(NamedTuple):
    """Distance of each pair of nodes: `values[code[node, other]]`."""

    code: NDArray[np.uint16]  # (node, node), or (0, 0) without a table or with too many values
    values: Float32Array  # (code,) ascending [node]; the last is inf
    bits: Int32Array  # (code,) the same as bits
    parts: NDArray[np.int64]  # (code,) the same, see `parts_of`

    @classmethod
    def of(cls, table: Float32Array) -> "Codes":
        """Codes of a table of distances (node, node), or (0, 0)."""
        found = [np.unique(row) for row in table]
        values = np.unique(np.concatenate([*found, np.array([np.inf], np.float32)]))
        if not found or values.size > MOST_CODES:
            values = values[-1:].copy()
            return cls(np.empty((0, 0), np.uint16), values, values.view(np.int32), np.zeros(1, int))
        code = np.empty(table.shape, np.uint16)
        for node, row in enumerate(table):
            code[node] = np.searchsorted(values, row)
        parts = np.array([parts_of(value) for value in values])
        return cls(code, values, values.view(np.int32), parts)


@lru_cache(maxsize=8)
def distance_codes(graph: NavigationGraph) -> Codes:
    """Codes of a map's distances."""
    return read_only(Codes.of(graph.distances))


@kernel
def nearest_by_code(
    codes: Codes, sources: Int32Array, nearest: NDArray[np.uint16], out: Float32Array
) -> None:
    """Distance of every node to the nearest of some sources, or inf: `out` (node,) [node].

    `nearest`: (node,) memory.
    """
    code, values = codes.code, codes.values
    for node in range(out.size):
        nearest[node] = np.uint16(values.size - 1)
    for source in sources:
        row = code[source]
        for node in range(out.size):
            nearest[node] = row[node] if row[node] < nearest[node] else nearest[node]
    for node in range(out.size):
        out[node] = values[nearest[node]]


class Hopeful(NamedTuple):
    """Sources that may be the nearest of some target; memory."""

    here: NDArray[np.uint16]  # (node,) codes
    nodes: NDArray[np.uint64]  # (node,)

    @classmethod
    def of(cls, nodes: int) -> "Hopeful":
        """Memory for a map of so many nodes."""
        return cls(np.zeros(nodes, np.uint16), np.zeros(nodes, np.uint64))


@kernel
def targets_to_nearest(
    codes: Codes,
    sources: Int32Array,
    centres: Int32Array,
    targets: Int32Array,
    slack: float,
    memory: Hopeful,
    out: NDArray[np.float64],
) -> None:
    """`distances_to_nearest` by codes: of each agent's possible targets to the nearest source.

    It reads the rows of centres and targets only, which a scan reads for other things too.

    Parameters
    ----------
    sources : (source,) nodes
    centres : (agent,) node of each agent
    targets : (agent, 9) nodes, none farther than `slack` from the agent's; -1 is skipped
    slack : distance [node]
    out : (agent, 9) the result [node], inf without sources
    """
    code, values = codes.code, codes.values
    none, here, hopeful = np.uint16(values.size - 1), memory.here, memory.nodes
    for a in range(targets.shape[0]):
        centre, nearest = np.uint64(centres[a]), none
        for i in range(sources.size):
            here[i] = code[centre, np.uint64(sources[i])]
        for i in range(sources.size):
            nearest = here[i] if here[i] < nearest else nearest
        limit = values[nearest] + np.float32(2.0 * slack + 1e-3)
        most, count = np.searchsorted(values, limit, "right"), np.uint64(0)
        for i in range(sources.size):  # without a branch
            hopeful[count] = sources[i]
            count += np.uint64(here[i] < most)
        for move in range(9):
            target, shortest = targets[a, move], none
            if target >= 0:
                for i in range(count):
                    there = code[np.uint64(target), hopeful[i]]
                    shortest = there if there < shortest else shortest
            out[a, move] = values[shortest]
