"""Some nodes of many, evenly chosen, and which agent of each kind is nearest to each."""

from typing import NamedTuple

import numpy as np

from graph_planner.compiled import inlined, kernel
from graph_planner.geodesics import (
    DistanceRows,
    Float32Array,
    Int32Array,
    Workspace,
    distances_of,
)
from graph_planner.task import TaskArrays

MOST_SAMPLES = 96


class Sample(NamedTuple):
    """Some nodes of interest, and which agent of each kind is nearest to each."""

    nodes: Int32Array  # (MOST_SAMPLES,)
    nearest: Int32Array  # (2, MOST_SAMPLES) agent: of those that do not collect, of those that do
    shortest: Float32Array  # (2, MOST_SAMPLES) its distance [node]
    size: Int32Array  # (1,) how many there are

    @classmethod
    def empty(cls) -> "Sample":
        """Memory for a sample."""
        return cls(
            np.zeros(MOST_SAMPLES, np.int32),
            np.zeros((2, MOST_SAMPLES), np.int32),
            np.zeros((2, MOST_SAMPLES), np.float32),
            np.zeros(1, np.int32),
        )


class Distances(NamedTuple):
    """Distances from single nodes, and memory to search them with."""

    rows: DistanceRows
    workspace: Workspace


@inlined
def distances_from(distances: Distances, neighbours: Int32Array, node: int) -> Float32Array:
    """(node,) distances of all nodes from one [node]; the next call may overwrite them."""
    return distances_of(distances.rows, neighbours, node, distances.workspace)


@kernel
def take_sample(
    candidates: Int32Array,
    agent_node: Int32Array,
    arrays: TaskArrays,
    distances: Distances,
    sample: Sample,
) -> None:
    """Choose evenly among the candidates (candidate,), and find who is nearest to each."""
    nodes, nearest, shortest = sample.nodes, sample.nearest, sample.shortest
    total, collects = candidates.size, arrays.collects
    count = min(total, MOST_SAMPLES)
    sample.size[0] = count
    for i in range(count):
        nodes[i] = candidates[i * total // count]
    nearest[:, :count] = -1
    shortest[:, :count] = np.float32(np.inf)
    if count == 0:
        return
    for a in range(agent_node.size):
        kind = int(collects[a])
        row = distances_from(distances, arrays.neighbours, agent_node[a])
        for i in range(count):
            if row[nodes[i]] < shortest[kind, i]:
                nearest[kind, i], shortest[kind, i] = a, row[nodes[i]]
