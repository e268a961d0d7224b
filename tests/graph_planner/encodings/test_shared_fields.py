"""Shared fields of the egocentric encoding, against plain numpy over random states."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.graph_planner.encodings.chart import Chart
from mjforage.graph_planner.encodings.egocentric import Egocentric
from mjforage.graph_planner.encodings.move_features import MIDDLE
from mjforage.graph_planner.encodings.samples import (
    MOST_SAMPLES,
    Sample,
    choose_evenly,
    nearest_own,
    share_out,
)
from mjforage.graph_planner.encodings.shared_fields import AGAIN_RADIUS
from mjforage.graph_planner.encodings.unseen import Unseen, list_nodes
from mjforage.graph_planner.graph.navigation import STAY, navigation_graph
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, task_of

HARBOUR = grid("..........", ".####.###.", "..........", ".#.#######", "..........", "...#....#.")
GRAPH = navigation_graph(HARBOUR, 1.0, False)
SCOUTS, FORAGERS = Role(2, 2, 4.0, False), Role(2, 1, 1.0, True)
TASK = task_of(GRAPH, scouts=SCOUTS, foragers=FORAGERS)
NODES, ROW = len(GRAPH), np.zeros(1, np.int64)
seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.sampled_from([0.0, 0.1, 0.5, 0.9, 1.0]))
def test_lists_of_unseen_nodes_and_of_their_edge(seed: int, share: float) -> None:
    random = np.random.default_rng(seed)
    fresh = random.random(NODES) < share
    idle = np.where(fresh, 1.0, random.random(NODES) * 0.99)
    chart = Chart.of(TASK)
    lists = Unseen.of(NODES, chart.water_at.size)
    for other in (np.ones(NODES), np.zeros(NODES), idle):  # nothing is left of those before
        counts = list_nodes(other, chart.place, chart.water_at, chart.node_at, chart.width, lists)
    near = [
        any(
            not fresh[other]
            and max(abs(GRAPH.rows[n] - GRAPH.rows[other]), abs(GRAPH.cols[n] - GRAPH.cols[other]))
            == 1
            for other in range(NODES)
        )
        for n in range(NODES)
    ]
    expected = fresh, fresh & np.array(near)
    for found, count, chosen in zip((lists.nodes, lists.edge), counts, expected, strict=True):
        assert found[:count].tolist() == np.flatnonzero(chosen).tolist()


@given(seeds, st.sampled_from([0.05, 0.5, 0.95, 1.0]))
def test_gains_towards_the_unseen_by_all_unseen_nodes(seed: int, share: float) -> None:
    """The encoding searches only their edge."""
    random = np.random.default_rng(seed)
    fresh = random.random(NODES) < share
    last_seen = np.where(fresh, -32768, 30).astype(np.int16)
    nodes = random.choice(NODES, 4, replace=False)
    cells = [(int(GRAPH.rows[n]), int(GRAPH.cols[n])) for n in nodes]
    view = Egocentric(TASK)
    view.reset(1)
    moves = view.see(observation_of(TASK, cells, {}, last_seen, step=31), ROW)["moves"][0]
    distance = GRAPH.distances.astype(np.float64)  # gains are differences of these in float64
    for a, node in enumerate(nodes):
        for move in range(9):
            end = TASK.arrays.targets[TASK.arrays.stride_number[a], node, move]
            if end < 0:
                assert not moves[a, move].any()
                continue
            gain = gains = 0.0
            if fresh.any():
                gain = distance[node, fresh].min() - distance[end, fresh].min()
                gains = (distance[node, fresh] - distance[end, fresh]).mean()
            assert moves[a, move, 4] == int(np.clip(MIDDLE + 40 * gain, 0, 255))
            assert moves[a, move, 6] == pytest.approx(np.clip(MIDDLE + 40 * gains, 0, 255), abs=1)


@given(seeds)
def test_gains_towards_items_and_nodes_to_look_at_again(seed: int) -> None:
    """On average, and to the nearest to which no teammate of the kind is nearer."""
    random = np.random.default_rng(seed)
    last_seen = random.integers(-20, 60, NODES).astype(np.int16)
    nodes, items = random.choice(NODES, 4, replace=False), random.choice(NODES, 3, replace=False)
    cells = [(int(GRAPH.rows[n]), int(GRAPH.cols[n])) for n in (*nodes, *items)]
    view = Egocentric(TASK)
    view.reset(1)
    seen = observation_of(TASK, cells[:4], dict.fromkeys(cells[4:], 1), last_seen, step=61)
    moves = view.see(seen, ROW)["moves"][0]
    distance = GRAPH.distances.astype(np.float64)
    idle = np.minimum(1.0, (60 - last_seen.astype(float)) / 135.0)
    due = np.flatnonzero(view._memory.nearby.marked[0] & (4 * idle >= 0.5))
    for a, node in enumerate(nodes):
        kind = np.flatnonzero(TASK.fleet.collects == TASK.fleet.collects[a])
        for move in range(8):
            end = TASK.arrays.targets[TASK.arrays.stride_number[a], node, move]
            for mean, own, there in ((5, 7, items), (9, 10, due)):
                if end < 0 or not there.size:
                    continue
                gains = (distance[node, there] - distance[end, there]).mean()
                assert moves[a, move, mean] == pytest.approx(
                    np.clip(MIDDLE + 40 * gains, 0, 255), abs=1
                )
                mine = there[kind[distance[nodes[kind]][:, there].argmin(axis=0)] == a]
                gain = distance[node, mine].min() - distance[end, mine].min() if mine.size else 0.0
                assert moves[a, move, own] == int(np.clip(MIDDLE + 40 * gain, 0, 255))


@given(seeds, st.integers(0, 3 * MOST_SAMPLES))
def test_a_sample_is_shared_out_to_the_nearest_of_each_kind(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    candidates = random.permutation(1000)[:count].astype(np.int32)
    sample, collects = Sample.empty(5), np.array([False, True, False, True, True])
    choose_evenly(candidates, count, sample)
    size = sample.size[0]
    assert size == min(count, MOST_SAMPLES)
    assert sample.nodes[:size].tolist() == [candidates[i * count // size] for i in range(size)]
    distance = sample.bits.view(np.float32)
    distance[:] = random.integers(0, 6, distance.shape)
    distance[random.random(distance.shape) < 0.2] = np.inf
    share_out(collects, sample)
    far = distance.reshape(5, 9, -1)[..., :size]
    for a in range(5):
        kind = np.flatnonzero(collects == collects[a])
        here = far[:, STAY]
        first = kind[here[kind].argmin(axis=0)] == a  # the first of equals
        own = first & np.isfinite(here[a])
        assert (sample.nearest[int(collects[a]), :size] == a).tolist() == own.tolist()
        for move in range(9):
            shortest = nearest_own(
                sample.bits, sample.nearest, size, int(collects[a]), a, 9 * a + move
            )
            assert shortest == far[a, move][own].min(initial=np.inf)


def test_the_coarse_map_is_the_mean_of_its_cells() -> None:
    large = navigation_graph(np.ones((40, 33), np.bool_), 1.0, False)
    task, random = task_of(large, scouts=SCOUTS, foragers=FORAGERS), np.random.default_rng(0)
    last_seen = random.integers(-200, 60, len(large)).astype(np.int16)
    known = {(0, 0): 3, (0, 1): 4, (39, 32): 11, (20, 20): 1}
    view = Egocentric(task)
    view.reset(1)
    seen = observation_of(task, [(5, 5), (9, 9), (20, 3), (30, 30)], known, last_seen, step=61)
    first = {name: levels.copy() for name, levels in view.see(seen, ROW).items()}
    for name, levels in view.see(seen, ROW).items():
        np.testing.assert_array_equal(levels, first[name])
    global_map = first["global_map"][0].reshape(4, 7, -1)
    cell = (large.rows * 16 // 40) * 16 + large.cols * 16 // 33
    idle = np.minimum(1.0, (60 - last_seen.astype(float)) / 135.0)
    items = np.bincount(cell, seen.belief[0], 256)
    for a in range(4):
        assert (global_map[a, 0] == 255).all()
        mean = np.bincount(cell, idle) / np.bincount(cell)
        np.testing.assert_allclose(global_map[a, 1], 255 * mean, atol=1.0)
        assert global_map[a, 2].tolist() == (np.minimum(items, 10) * 255 // 10).tolist()
        for kind, who in ((4, {a}), (5, {0, 1} - {a}), (6, {2, 3} - {a})):
            cells = sorted(cell[seen.agent_node[0, b]] for b in who)
            assert np.flatnonzero(global_map[a, kind]).tolist() == cells
        near = view._memory.nearby.marked[0]
        again = np.bincount(cell, np.minimum(1.0, 4 * idle) * near) / np.bincount(cell)
        np.testing.assert_allclose(global_map[a, 3], 255 * again, atol=1.0)


def test_nodes_near_items_of_before_are_due_once_they_are_idle() -> None:
    random = np.random.default_rng(1)
    last_seen = random.integers(-100, 60, NODES).astype(np.int16)
    cells = [(0, 0), (0, 1), (2, 5), (4, 9)]
    view = Egocentric(TASK)
    view.reset(1)
    for known in ({(4, 4): 1}, {(4, 4): 1, (0, 6): 2}, {(2, 0): 1}):  # all are remembered
        view.see(observation_of(TASK, cells, known, last_seen, step=61), ROW)
    marked, nearby = view._memory.nearby.marked[0], view._memory.nearby
    assert nearby.nodes[0, : nearby.size[0]].tolist() == np.flatnonzero(marked).tolist()
    for node in np.flatnonzero(marked):
        assert (
            min(
                np.hypot(GRAPH.rows[node] - row, GRAPH.cols[node] - col)
                for row, col in ((4, 4), (0, 6), (2, 0))
            )
            <= AGAIN_RADIUS
        )
    idle = np.minimum(1.0, (60 - last_seen.astype(float)) / 135.0)
    due = np.flatnonzero(marked & (4 * idle >= 0.5))
    sample = view._fields.some_due
    assert 0 < due.size < marked.sum()
    assert sample.nodes[: sample.size[0]].tolist() == due.tolist()
    view.see(observation_of(TASK, cells, {}, last_seen, step=1), ROW)  # another episode
    assert sample.size[0] == 0 and nearby.size[0] == 0
    view.see(observation_of(TASK, cells, {(4, 9): 1}, last_seen, step=2), ROW)
    around = nearby.nodes[0, : nearby.size[0]]
    far = np.hypot(GRAPH.rows[around] - 4, GRAPH.cols[around] - 9)
    assert far.size > 0 and far.max() <= AGAIN_RADIUS, "nothing is left of the one before"
