"""Distances as codes: the same numbers as those of the table, to the bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.graph_planner.encodings import codes as module
from mjforage.graph_planner.encodings.codes import (
    PARTS,
    Codes,
    Hopeful,
    distance_codes,
    nearest_by_code,
    targets_to_nearest,
)
from mjforage.graph_planner.encodings.samples import Distances, Sample, choose_evenly, measure
from mjforage.graph_planner.graph.geodesics import DIAGONAL, Workspace, distances_to_nearest
from mjforage.graph_planner.graph.navigation import navigation_graph
from tests.graph_planner.charts import grid

GRAPH = navigation_graph(
    grid(
        "..........",
        ".####.###.",
        "..........",
        ".#.#######",
        "..........",
        "##########",
        "...#......",
    ),
    1.0,
    False,
)
TABLE, NODES = GRAPH.distances, len(GRAPH)
CODES = Codes.of(TABLE)
seeds = st.integers(0, 2**32 - 1)


def test_a_code_is_the_rank_of_its_distance() -> None:
    np.testing.assert_array_equal(CODES.values[CODES.code], TABLE)
    assert (np.diff(CODES.values[:-1]) > 0).all() and CODES.values[-1] == np.inf
    assert np.isinf(TABLE).any() and np.isinf(Codes.of(np.zeros((1, 1), np.float32)).values[-1])
    assert distance_codes(GRAPH) is distance_codes(GRAPH)


def test_there_are_no_codes_without_a_table_or_for_too_many_distances(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert Codes.of(np.empty((0, 0), np.float32)).code.shape == (0, 0)
    monkeypatch.setattr(module, "MOST_CODES", CODES.values.size)
    assert Codes.of(TABLE).code.shape == TABLE.shape
    monkeypatch.setattr(module, "MOST_CODES", CODES.values.size - 1)
    assert Codes.of(TABLE).code.shape == (0, 0)


@given(seeds, st.integers(0, 30))
def test_distances_to_the_nearest_by_code_are_those_of_the_table(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    sources = random.permutation(NODES)[:count].astype(np.int32)
    found = np.zeros(NODES, np.float32)
    nearest_by_code(CODES, sources, np.zeros(NODES, np.uint16), found)
    np.testing.assert_array_equal(found, TABLE[sources].min(axis=0, initial=np.inf))
    centres = random.integers(0, NODES, 3).astype(np.int32)
    targets = np.full((3, 9), -1, np.int32)
    targets[:, :8] = GRAPH.neighbours[centres]
    by_table, by_code = np.zeros((3, 9)), np.zeros((3, 9))
    about, workspace = (sources, centres, targets, DIAGONAL), Workspace.of(NODES)
    distances_to_nearest(GRAPH.neighbours, TABLE, *about, workspace, by_table)
    targets_to_nearest(CODES, *about, Hopeful.of(NODES), by_code)
    np.testing.assert_array_equal(by_code, by_table)
    plain = TABLE[sources][:, targets].min(axis=0, initial=np.inf)
    np.testing.assert_array_equal(by_code, np.where(targets >= 0, plain, np.inf))


@pytest.mark.parametrize("codes", [CODES, Codes.of(np.empty((0, 0), np.float32))])
def test_a_sample_is_measured_from_where_every_move_ends(codes: Codes) -> None:
    random = np.random.default_rng(0)
    targets = random.integers(-1, NODES, (2, 9)).astype(np.int32)
    samples = Sample.empty(2), Sample.empty(2), Sample.empty(2)
    for sample, count in zip(samples, (0, 5, NODES), strict=True):
        choose_evenly(random.permutation(NODES).astype(np.int32), count, sample)
    distances = Distances(GRAPH.distance_rows, Workspace.of(NODES))
    measure(GRAPH.neighbours, codes, targets, distances, (samples[0], samples[2]), samples[1])
    legal, ends = targets.reshape(-1) >= 0, targets.reshape(-1)
    for sample in samples:
        nodes = sample.nodes[: sample.size[0]]
        distance = TABLE[ends[legal]][:, nodes].astype(np.float64)
        whole = np.where(np.isfinite(distance), distance, 0.0).sum(axis=1) * PARTS
        np.testing.assert_array_equal(sample.total[legal], whole)
        if sample is not samples[1]:  # of which the total alone is asked
            np.testing.assert_array_equal(
                sample.bits[legal, : nodes.size].view(np.float32), distance
            )
