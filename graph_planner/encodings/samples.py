"""Some nodes of many, evenly chosen, how far they are, and whose they are."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import inlined, kernel
from graph_planner.geodesics import (
    DistanceRows,
    Float32Array,
    Int32Array,
    Workspace,
    filled_row,
)

MOST_SAMPLES = 96


class Sample(NamedTuple):
    """Some nodes of interest; only the first `size` entries count."""

    nodes: Int32Array  # (MOST_SAMPLES,)
    here: Float32Array  # (agent, MOST_SAMPLES) distance of each agent [node]
    own: Int32Array  # (agent, MOST_SAMPLES) the nodes to which no other of its kind is nearer
    owned: Int32Array  # (agent,) how many are each one's own
    own_way: Float32Array  # (agent,) distance of each agent from the nearest of them, or inf
    nearest: Int32Array  # (MOST_SAMPLES,) memory: the nearest agent of a kind, or -1
    shortest: Float32Array  # (MOST_SAMPLES,) memory: its distance [node]
    size: Int32Array  # (1,) how many nodes there are

    @classmethod
    def empty(cls, agents: int) -> "Sample":
        """Memory for a sample."""
        return cls(
            np.zeros(MOST_SAMPLES, np.int32),
            np.zeros((agents, MOST_SAMPLES), np.float32),
            np.zeros((agents, MOST_SAMPLES), np.int32),
            np.zeros(agents, np.int32),
            np.zeros(agents, np.float32),
            np.zeros(MOST_SAMPLES, np.int32),
            np.zeros(MOST_SAMPLES, np.float32),
            np.zeros(1, np.int32),
        )


class Distances(NamedTuple):
    """Distances from single nodes, and memory to search them with."""

    rows: DistanceRows
    workspace: Workspace


@inlined
def row_from(distances: Distances, whole: bool, neighbours: Int32Array, node: int) -> int:
    """Row of `distances.rows.distance` with those from a node; the next call may overwrite it.

    Parameters
    ----------
    whole : whether there is a row for every node: theirs, and no time is lost to asking
    """
    return node if whole else filled_row(distances.rows, neighbours, node, distances.workspace)


@kernel
def choose_evenly(candidates: Int32Array, count: int, sample: Sample) -> None:
    """Choose evenly among the first `count` candidates (candidate,)."""
    nodes, size = sample.nodes, min(count, MOST_SAMPLES)
    sample.size[0] = size
    every, more = count // max(1, size), count % max(1, size)
    place, rest = np.uint64(0), 0  # of i * count / size: divisions would take longer
    for i in range(size):
        nodes[i] = candidates[place]
        place, rest = place + np.uint64(every), rest + more
        if rest >= size:
            place, rest = place + np.uint64(1), rest - size


@kernel
def measure(table: Float32Array, row: int, nodes: Int32Array, size: int, out: Float32Array) -> None:
    """Pick the distances of the first `size` nodes from a row of a table into `out` (place,)."""
    for i in range(size):
        out[i] = table[row, np.uint64(nodes[i])]


@kernel
def share_out(collects: NDArray[np.bool_], sample: Sample) -> None:
    """Give every node of a measured sample to the nearest agent of each kind, the first of equals.

    Parameters
    ----------
    collects : (agent,) which of the two kinds each is of
    """
    nodes, here, own, owned = sample.nodes, sample.here, sample.own, sample.owned
    own_way, nearest, shortest, size = (
        sample.own_way,
        sample.nearest,
        sample.shortest,
        sample.size[0],
    )
    own_way[:] = np.float32(np.inf)
    for kind in (False, True):
        for i in range(size):
            nearest[i], shortest[i] = -1, np.float32(np.inf)
        for a in range(collects.size):
            if collects[a] == kind:
                for i in range(size):
                    closer = here[a, i] < shortest[i]
                    nearest[i] = a if closer else nearest[i]
                    shortest[i] = here[a, i] if closer else shortest[i]
        for a in range(collects.size):
            if collects[a] == kind:
                count = np.uint64(0)
                for i in range(size):
                    mine = nearest[i] == a
                    own[a, count] = nodes[i]
                    count += np.uint64(1) if mine else np.uint64(0)
                    own_way[a] = shortest[i] if mine and shortest[i] < own_way[a] else own_way[a]
                owned[a] = count
