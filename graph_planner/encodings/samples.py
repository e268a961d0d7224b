"""Some nodes of many, evenly chosen, how far they are, and whose they are."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.encodings.codes import Codes
from graph_planner.geodesics import (
    DistanceRows,
    Float32Array,
    Int32Array,
    Workspace,
    filled_row,
)
from graph_planner.navigation import STAY

MOST_SAMPLES = 96
_INF_BITS = np.float32(np.inf).view(np.int32)


class Sample(NamedTuple):
    """Some nodes of interest; only the first `size` entries count."""

    nodes: Int32Array  # (MOST_SAMPLES,)
    far: Float32Array  # (agent x 9, MOST_SAMPLES) distance of where each move ends, or inf [node]
    bits: Int32Array  # the same memory: distances are not negative, so are ordered as their bits
    nearest: Int32Array  # (2, MOST_SAMPLES) the nearest agent that does not collect, and that does
    size: Int32Array  # (1,) how many nodes there are

    @classmethod
    def empty(cls, agents: int) -> "Sample":
        """Memory for a sample."""
        far = np.zeros((9 * agents, MOST_SAMPLES), np.float32)
        return cls(
            np.zeros(MOST_SAMPLES, np.int32),
            far,
            far.view(np.int32),
            np.zeros((2, MOST_SAMPLES), np.int32),
            np.zeros(1, np.int32),
        )


class Distances(NamedTuple):
    """Distances from single nodes, and memory to search them with."""

    rows: DistanceRows
    workspace: Workspace


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
def _measure_by_code(codes: Codes, ends: Int32Array, sample: Sample) -> None:
    """Fill `far` from the ends (agent x 9,) that are not -1."""
    code, values, nodes, far = codes.code, codes.values, sample.nodes, sample.far
    for k in range(ends.size):
        if ends[k] >= 0:
            end = np.uint64(ends[k])
            for i in range(sample.size[0]):
                far[k, i] = values[code[end, np.uint64(nodes[i])]]


@kernel
def measure(
    neighbours: Int32Array,
    codes: Codes,
    targets: Int32Array,
    distances: Distances,
    samples: tuple[Sample, Sample, Sample],
) -> None:
    """Fill `far` of some samples.

    Parameters
    ----------
    neighbours : (node, 8)
    targets : (agent, 9) where moves end; of illegal ones, -1, nothing is to be read in `far`
    distances : what is searched where there are no codes
    """
    rows = distances.rows.distance
    ends = targets.copy().reshape(targets.size)
    if codes.code.shape[0] > 0:
        for sample in samples:
            _measure_by_code(codes, ends, sample)
        return
    for k in range(ends.size):
        if ends[k] >= 0:
            row = filled_row(distances.rows, neighbours, ends[k], distances.workspace)
            for sample in samples:
                for i in range(sample.size[0]):
                    sample.far[k, i] = rows[row, sample.nodes[i]]


@kernel
def share_out(collects: NDArray[np.bool_], sample: Sample) -> None:
    """Give every node of a measured sample to the nearest agent of each kind, the first of equals.

    Where no agent of a kind gets, `nearest` is -1.

    Parameters
    ----------
    collects : (agent,) which of the two kinds each is of
    """
    far, nearest, size = sample.far, sample.nearest, sample.size[0]
    shortest = np.empty(MOST_SAMPLES, np.float32)
    for kind in range(2):
        for i in range(size):
            nearest[kind, i], shortest[i] = -1, np.float32(np.inf)
        for a in range(collects.size):
            if collects[a] == kind:
                here = np.uint64(9 * a + STAY)
                for i in range(size):
                    closer = far[here, i] < shortest[i]
                    nearest[kind, i] = a if closer else nearest[kind, i]
                    shortest[i] = far[here, i] if closer else shortest[i]


@kernel
def nearest_own(
    bits: Int32Array, nearest: Int32Array, size: int, kind: int, agent: int, end: int
) -> float:
    """Distance to the nearest node that is given to an agent of a kind, or inf [node].

    Parameters
    ----------
    bits, nearest, size : of a `Sample`
    end : row of `far` from where
    """
    shortest = _INF_BITS
    for i in range(size):
        own = bits[end, i] if nearest[kind, i] == agent else _INF_BITS
        shortest = own if own < shortest else shortest
    return np.float64(np.int32(shortest).view(np.float32))
