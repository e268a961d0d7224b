"""Distances to known items, kept while they are the same: never those of others."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mjforage.graph_planner.encodings.codes import PARTS, Codes
from mjforage.graph_planner.encodings.move_features import FADING, _attraction
from mjforage.graph_planner.encodings.samples import mean_gain
from mjforage.graph_planner.encodings.ways import MOST_ROWS, ItemWays, find_ways, way_level
from mjforage.graph_planner.graph.geodesics import Workspace
from mjforage.graph_planner.graph.navigation import navigation_graph

WATER = np.ones((20, 20), np.bool_)
WATER[5, 3:] = WATER[12, :17] = False
GRAPH = navigation_graph(WATER, 1.0, False)
NODES = len(GRAPH)
TABLE = GRAPH.distances
CODES, NO_CODES = Codes.of(TABLE), Codes.of(np.empty((0, 0), np.float32))
MEMORY = np.zeros(NODES, np.uint16)


def lists(random: np.random.Generator, count: int) -> list[NDArray[np.int32]]:
    """Known nodes one look after the other: much the same, and not quite."""
    found = [random.permutation(NODES)[: random.integers(0, 12)].astype(np.int32)]
    while len(found) < count:
        known = found[-1].copy()
        change = random.integers(0, 6)
        if change == 0 and known.size:
            known[random.integers(known.size)] = random.integers(NODES)
        elif change == 1:
            known = known[:-1]
        elif change == 2:
            known = np.append(known, np.int32(random.integers(NODES)))
        elif change == 3:
            known = random.permutation(NODES)[: MOST_ROWS + 5].astype(np.int32)
        elif change == 4:
            known = known[:6]
        found.append(known)
    return found


@given(st.integers(0, 2**32 - 1), st.sampled_from([CODES, NO_CODES]))
def test_ways_are_those_to_the_items_known_now(seed: int, codes: Codes) -> None:
    random = np.random.default_rng(seed)
    ways, workspace = ItemWays.none_yet(2, NODES), Workspace.of(NODES)
    for pair in zip(lists(random, 20), lists(random, 20), strict=True):
        for e, known in enumerate(pair):
            find_ways(e, known, GRAPH.neighbours, codes, workspace, MEMORY, ways)
        for e, known in enumerate(pair):
            expected = TABLE[known].min(axis=0, initial=np.inf)
            np.testing.assert_allclose(ways.distance[e], expected, rtol=1e-6)
            levels = [way_level(float(distance)) for distance in ways.distance[e]]
            assert ways.level[e].tolist() == levels


def test_ways_stand_while_the_same_items_are_known() -> None:
    ways, workspace = ItemWays.none_yet(1, NODES), Workspace.of(NODES)
    known = np.array([3, 77], np.int32)
    find_ways(0, known, GRAPH.neighbours, CODES, workspace, MEMORY, ways)
    ways.distance[0, 0] = -1.0
    find_ways(0, known.copy(), GRAPH.neighbours, CODES, workspace, MEMORY, ways)
    assert ways.distance[0, 0] == -1.0
    levels = [int(way_level(distance)) for distance in (0.0, 100.0, 127.5, np.inf)]
    assert levels == [255, 55, 0, 0]


def test_items_attract_less_the_farther_they_are_and_not_at_all_from_40_nodes_on() -> None:
    there = np.array([0.0, 0.5, 1.0, 2.9, 38.99, 39.5, 40.0, 41.0, 900.0, np.inf], np.float32)
    near = np.floor(there[there < 40]).astype(int)
    far = np.stack((np.zeros_like(there), there))
    assert _attraction(far.view(np.int32), 1, there.size) == pytest.approx(
        (FADING**near).sum(), rel=1e-12
    )
    assert _attraction(far.view(np.int32), 1, 2) == 2.0
    assert _attraction(far.view(np.int32), 1, 0) == 0.0


def test_a_mean_gain_is_of_the_nodes_that_count() -> None:
    total = np.array([[3.0, 2.0], [1.0, 2.5]]).sum(axis=1) * PARTS
    assert mean_gain(total.astype(np.int64), 2, 0, 1) == 0.75
    assert mean_gain(total.astype(np.int64), 2, 1, 0) == -0.75
    assert mean_gain(np.zeros(2, np.int64), 0, 0, 1) == 0.0
