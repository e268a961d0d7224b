"""Samples of nodes, evenly chosen, with their distances and owners."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.encodings.codes import PARTS, Codes, parts_of
from mjforage.graph_planner.graph.geodesics import (
    DistanceRows,
    Int32Array,
    Workspace,
    filled_row,
)
from mjforage.graph_planner.graph.navigation import STAY

MOST_SAMPLES = 96
_INF_BITS = np.float32(np.inf).view(np.int32)


class Sample(NamedTuple):
    """Some nodes of interest; only the first `size` entries count."""

    nodes: Int32Array  # (MOST_SAMPLES,)
    bits: Int32Array  # (agent x 9, MOST_SAMPLES) distance of where each move ends, or inf [node],
    # float32 as its bits: distances are not negative, so are ordered as these
    total: NDArray[np.int64]  # (agent x 9,) sum of them, see `parts_of`
    nearest: Int32Array  # (2, MOST_SAMPLES) the nearest agent that does not collect, and that does
    shortest: Int32Array  # (MOST_SAMPLES,) its distance as bits; memory of `share_out`
    size: Int32Array  # (1,) how many nodes there are

    @classmethod
    def empty(cls, agents: int) -> "Sample":
        """Memory for a sample."""
        return cls(
            np.zeros(MOST_SAMPLES, np.int32),
            np.zeros((9 * agents, MOST_SAMPLES), np.int32),
            np.zeros(9 * agents, np.int64),
            np.zeros((2, MOST_SAMPLES), np.int32),
            np.zeros(MOST_SAMPLES, np.int32),
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
    if size < MOST_SAMPLES:
        for i in range(size):
            nodes[i] = candidates[i]
        return
    for i in range(MOST_SAMPLES):  # divided by a constant, which takes no division
        nodes[i] = candidates[np.uint64(i) * np.uint64(count) // np.uint64(MOST_SAMPLES)]


@inlined
def _read(
    codes: Codes, end: np.uint64, nodes: Int32Array, size: int, bits: Int32Array, k: int
) -> np.int64:
    """Fill row k of `bits` with how far the first `size` nodes are from `end`; their total."""
    code, values, parts, total = codes.code, codes.bits, codes.parts, np.int64(0)
    for i in range(size):
        number = code[end, np.uint64(nodes[i])]
        bits[k, i] = values[number]
        total += parts[number]
    return total


@inlined
def _read_total(codes: Codes, end: np.uint64, nodes: Int32Array, size: int) -> np.int64:
    """The total alone; no distance is kept."""
    code, parts, total = codes.code, codes.parts, np.int64(0)
    for i in range(size):
        total += parts[code[end, np.uint64(nodes[i])]]
    return total


@kernel
def _measure_by_code(
    codes: Codes, ends: Int32Array, near: tuple[Sample, Sample], crowd: Sample
) -> None:
    """`measure` with codes: all samples from one row of them after the other."""
    one, other = near
    nodes, bits, total, size = one.nodes, one.bits, one.total, one.size[0]
    others, others_bits = other.nodes, other.bits
    others_total, others_size = other.total, other.size[0]
    many, many_total, many_size = crowd.nodes, crowd.total, crowd.size[0]
    for k in range(ends.size):
        if ends[k] >= 0:
            end = np.uint64(ends[k])
            many_total[k] = _read_total(codes, end, many, many_size)
            total[k] = _read(codes, end, nodes, size, bits, k)
            others_total[k] = _read(codes, end, others, others_size, others_bits, k)


@kernel
def measure(
    neighbours: Int32Array,
    codes: Codes,
    targets: Int32Array,
    distances: Distances,
    near: tuple[Sample, Sample],
    crowd: Sample,
) -> None:
    """Fill `bits` and `total` of two samples, and `total` alone of a third.

    Parameters
    ----------
    neighbours : (node, 8)
    targets : (agent, 9) where moves end; of illegal ones, -1, nothing is to be read
    distances : what is searched where there are no codes
    """
    rows = distances.rows.distance
    ends = targets.reshape(targets.size)
    if codes.code.shape[0] > 0:
        _measure_by_code(codes, ends, near, crowd)
        return
    for k in range(ends.size):
        if ends[k] >= 0:
            row = filled_row(distances.rows, neighbours, ends[k], distances.workspace)
            for sample in (*near, crowd):
                sample.total[k] = 0
                for i in range(sample.size[0]):
                    far = rows[row, sample.nodes[i]]
                    sample.bits[k, i] = np.float32(far).view(np.int32)
                    sample.total[k] += parts_of(far)


@kernel
def mean_gain(total: NDArray[np.int64], size: int, here: int, there: int) -> float:
    """Mean gain of a sample's nodes, by how much nearer they are to one end than to another [node].

    `total`, `size`: of a `Sample`; `here`, `there`: rows of its `bits`.
    """
    return float((total[here] - total[there]) / PARTS / max(1, size))


@kernel
def share_out(collects: NDArray[np.bool_], sample: Sample) -> None:
    """Give every node of a measured sample to the nearest agent of each kind, the first of equals.

    Where no agent of a kind gets, `nearest` is -1.

    `collects`: (agent,) which of the two kinds each is of.
    """
    bits, nearest, size, shortest = sample.bits, sample.nearest, sample.size[0], sample.shortest
    for kind in range(2):
        for i in range(size):
            nearest[kind, i], shortest[i] = -1, _INF_BITS
        for a in range(collects.size):
            if collects[a] == kind:
                here = np.uint64(9 * a + STAY)
                for i in range(size):
                    closer = bits[here, i] < shortest[i]
                    nearest[kind, i] = a if closer else nearest[kind, i]
                    shortest[i] = bits[here, i] if closer else shortest[i]


@kernel
def nearest_own(
    bits: Int32Array, nearest: Int32Array, size: int, kind: int, agent: int, end: int
) -> float:
    """Distance to the nearest node that is given to an agent of a kind, or inf [node].

    `bits`, `nearest`, `size`: of a `Sample`; `end`: row of `bits` from where.
    """
    shortest = _INF_BITS
    for i in range(size):
        own = bits[end, i] if nearest[kind, i] == agent else _INF_BITS
        shortest = own if own < shortest else shortest
    return np.float64(np.int32(shortest).view(np.float32))
