import numpy as np
import pytest

from mjforage.graph_planner.encodings.chart import COARSE, REACH
from mjforage.graph_planner.encodings.egocentric import OWN, Egocentric
from mjforage.graph_planner.encodings.encoder import Levels
from mjforage.graph_planner.encodings.move_features import MOVE_FEATURES
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.mission.task import Task
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, task_of

ROW = np.zeros(1, np.int64)
SCOUT, FORAGER = Role(1, 2, 4.0, False), Role(2, 1, 1.0, True)
HARBOUR = grid(
    "..........",
    ".####.###.",
    "..........",
    ".#.#######",
    "..........",
)


def harbour() -> tuple[NavigationGraph, Task]:
    graph = navigation_graph(HARBOUR, 1.0, False)
    return graph, task_of(graph, scouts=SCOUT, foragers=FORAGER)


def look(
    task: Task, cells: list[tuple[int, int]], known: dict[tuple[int, int], int], step: int = 1
) -> dict[str, Levels]:
    view = Egocentric(task)
    view.reset(1)
    return {
        name: v[0]
        for name, v in view.see(observation_of(task, cells, known, step=step), ROW).items()
    }


def test_the_local_map_is_the_map_around_the_agent() -> None:
    graph, task = harbour()
    known = {(2, 2): 2, (4, 9): 1}
    local_map = look(task, [(2, 4), (0, 0), (4, 1)], known)["local_map"][0]
    for i in range(15):
        for j in range(15):
            row, col = 2 + i - REACH, 4 + j - REACH
            inside = 0 <= row < 5 and 0 <= col < 10
            wet = inside and bool(HARBOUR[row, col])
            assert (local_map[0, i, j] == 255) == wet
            if not wet:
                assert not local_map[1:4, i, j].any()
                continue
            node = graph.node_of_cell[row, col]
            way = min(graph.distances[node, graph.node_of_cell[rc]] for rc in known)
            assert local_map[1, i, j] == 255  # never seen
            assert local_map[2, i, j] == 255 * known.get((row, col), 0) // 10
            assert local_map[3, i, j] == int(255 - 2 * way)
    assert np.argwhere(local_map[5]).tolist() == []  # no other scout
    assert np.argwhere(local_map[6]).tolist() == [[REACH - 2, REACH - 4], [REACH + 2, REACH - 3]]
    assert np.argwhere(local_map[7]).tolist() == [[REACH, REACH]]


def test_the_global_map_counts_every_cell_once() -> None:
    _, task = harbour()
    global_map = look(task, [(2, 4), (0, 0), (4, 1)], {(2, 2): 2})["global_map"]
    assert global_map.shape == (3, 7, COARSE, COARSE)
    cells = 5 * 10
    assert (global_map[0, 0] == 255).sum() == HARBOUR.sum() < cells  # smaller than the coarse grid
    assert (global_map[0, 2] > 0).sum() == 1
    assert global_map[:, 4].reshape(3, -1).astype(bool).sum(axis=1).tolist() == [1, 1, 1]
    assert (global_map[0, 6] > 0).sum() == 2
    assert (global_map[1, 6] > 0).sum() == 1


def test_features_of_moves_by_their_definitions() -> None:
    graph, task = harbour()
    known = {(2, 0): 1, (4, 4): 3}
    cells = [(2, 5), (2, 2), (4, 9)]
    moves = look(task, cells, known)["moves"]
    items = [graph.node_of_cell[rc] for rc in known]
    at, north, west, east = (graph.node_of_cell[rc] for rc in ((2, 2), (1, 2), (2, 1), (2, 3)))
    assert north < 0
    assert not moves[1, 0].any()  # north is land
    for move, end in ((6, west), (2, east), (STAY, at)):
        here, there = graph.distances[at, items], graph.distances[end, items]
        assert moves[1, move, 0] == 255
        assert moves[1, move, 2] == int(128 + 40 * (here.min() - there.min()))
        assert moves[1, move, 5] == pytest.approx(128 + 40 * (here - there).mean(), abs=1)
        gain = (0.85 ** there.astype(int)).sum() - (0.85 ** here.astype(int)).sum()
        assert moves[1, move, 8] == pytest.approx(128 + 32 * gain, abs=1)
    assert moves[1, 5, 1] == 0 and moves[2, 6, 1] == 0
    nearest = graph.distances[[at, graph.node_of_cell[4, 9]]][:, items]
    assert nearest[0].argmin() == 0 and nearest[0, 1] < nearest[1, 1]  # both are the first one's
    assert (moves[2, :, 7][moves[2, :, 0] == 255] == 128).all()  # nothing is left to the other


def test_a_map_too_large_for_a_table_of_distances_looks_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("mjforage.graph_planner.graph.navigation.TABLE_LIMIT", 3)
    monkeypatch.setattr("mjforage.base.row_cache.FEWEST_ROWS", 2)
    monkeypatch.setattr("mjforage.base.row_cache.MEMORY", 0)
    graph = NavigationGraph(HARBOUR, 1.0, False)
    far = task_of(graph, scouts=SCOUT, foragers=FORAGER)
    _, near = harbour()
    assert graph.distances.size == 0 and graph.distance_rows.distance.shape[0] == 2
    random = np.random.default_rng(0)
    for _ in range(20):
        drawn = random.integers(0, len(graph), 5)
        cells = [(int(graph.rows[n]), int(graph.cols[n])) for n in drawn]
        known = {cells[3]: 2, cells[4]: 1}
        with_table, without = look(near, cells[:3], known), look(far, cells[:3], known)
        for name, levels in with_table.items():
            np.testing.assert_array_equal(levels, without[name])


def lake() -> NavigationGraph:
    return navigation_graph(np.ones((9, 9), np.bool_), 1.0, False)


def test_each_agent_knows_its_own_team_store_and_ways() -> None:
    """Of a scout and two foragers; two nodes of the east edge have never been seen."""
    graph = lake()
    task = task_of(graph, scouts=SCOUT, foragers=Role(2, 1, 1.0, True, energy=50.0))
    last_seen = np.full(81, 9, np.int16)
    last_seen[graph.node_of_cell[4, [6, 8]]] = -32768
    seen = observation_of(task, [(4, 8), (4, 4), (4, 1)], {}, last_seen, step=10)
    seen.energy_left[0, 1:] = 25.0, 10.0
    view = Egocentric(task)
    view.reset(1)
    own = {name: view.see(seen, ROW)["own"][0, :, i].tolist() for i, name in enumerate(OWN)}
    assert own["team size"] == [32, 64, 64] and own["others"] == [64, 32, 32]
    assert own["energy left"] == [255, 127, 51]
    assert own["unseen share"] == [255 * 2 // 81] * 3
    assert own["way to unseen"] == [255, 255 - 2 * 2, 255 - 2 * 5]


def test_moves_are_told_by_what_is_unseen_and_by_each_agents_own_energy() -> None:
    """In view of a move's end: itself and four nodes. One agent has no energy left."""
    graph = lake()
    task = task_of(graph, foragers=FORAGER)
    last_seen = np.full(81, 9, np.int16)
    last_seen[graph.node_of_cell[4, [6, 8]]] = -32768
    seen = observation_of(task, [(4, 4), (4, 5)], {(4, 3): 1, (4, 0): 1}, last_seen, step=10)
    seen.energy_left[0, 1] = 0.5
    view = Egocentric(task)
    view.reset(1)
    moves = view.see(seen, ROW)["moves"][0]
    east, west, feature = moves[0, 2], moves[0, 6], MOVE_FEATURES.index
    assert east[feature("idleness")] == 255 // 5 and west[feature("idleness")] == 0
    for name in ("nearer unseen", "nearer unseen on average"):
        assert (east[feature(name)], west[feature(name)]) == (128 + 40, 128 - 40)
    for name in ("nearer item", "nearer items on average"):
        assert (east[feature(name)], west[feature(name)]) == (128 - 40, 128 + 40)
    assert np.flatnonzero(moves[0, :, 0]).tolist() == list(range(9))
    assert np.flatnonzero(moves[1, :, 0]).tolist() == [STAY]


def test_the_trail_fades_by_a_tenth_per_step() -> None:
    """One agent goes east, one west, for twelve steps; both have their ten last places."""
    graph = navigation_graph(np.ones((3, 30), np.bool_), 1.0, False)
    task = task_of(graph, foragers=Role(2, 1, 1.0, True))
    view = Egocentric(task)
    view.reset(1)
    for step in range(1, 13):
        cells = [(0, 9 + step), (2, 20 - step)]
        seen = observation_of(task, cells, step=step)
        trail = view.see(seen, ROW)["local_map"][0, :, 7, REACH]
    fading = [255 * (10 - k) // 10 for k in range(8)]
    assert trail[0].tolist() == [*fading[::-1], *[0] * 7]
    assert trail[1].tolist() == [*[0] * 7, *fading]


def test_the_agent_knows_what_it_has_left_and_who_is_with_it() -> None:
    """Half of the energy, three of 28 nodes unseen, the nearest of them one node away."""
    graph, _ = harbour()
    scarce = Role(1, 2, 4.0, False, energy=40.0)
    task = task_of(graph, scouts=scarce, foragers=FORAGER)
    last_seen = np.zeros(len(graph), np.int16)
    last_seen[[graph.node_of_cell[rc] for rc in ((0, 0), (0, 1), (0, 9))]] = -32768
    cells = [(0, 2), (4, 2), (4, 9)]
    seen = observation_of(task, cells, {(0, 4): 1, (4, 4): 12}, last_seen, step=3)
    seen.energy_left[0, 0] = 20.0
    view = Egocentric(task)
    view.reset(1)
    levels = view.see(seen, ROW)
    facts = [dict(zip(OWN, own, strict=True)) for own in levels["own"][0]]
    assert facts[0]["energy left"] == 127 and facts[1]["energy left"] == 255
    assert [each["team size"] for each in facts] == [32, 64, 64]
    assert [each["others"] for each in facts] == [64, 32, 32]
    assert [each["moves"] for each in facts] == [64, 32, 32]
    assert [each["radius"] for each in facts] == [64, 16, 16]
    assert {each["unseen share"] for each in facts} == {255 * 3 // len(graph)}
    assert facts[0]["way to unseen"] == 253 and facts[0]["way to items"] == 251
    assert facts[1]["way to items"] == 251
    moves, here, nodes = levels["moves"][0], graph.node_of_cell[4, 2], graph.rows.size
    idle = np.where(last_seen < 0, 1.0, 2 / 135)
    assert moves[1, 2, 1] == 0 and moves[0, 2, 1] == 25  # two nodes east there is an item
    near = task.views.of(graph.node_of_cell[4, 3], int(task.radius_number[1]))
    assert nodes > here and moves[1, 2, 3] == int(255 * idle[near].sum() / 5)  # a disc of five
    global_map = levels["global_map"][0]
    assert sorted(global_map[0, 2][global_map[0, 2] > 0]) == [25, 255]
    assert [global_map[a, 5].astype(bool).sum() for a in range(3)] == [0, 1, 1]
    assert [global_map[a, 6].astype(bool).sum() for a in range(3)] == [2, 1, 1]
    assert global_map[0, 1, 0, 0] == 255 and global_map[0, 1].max() == 255


def test_nodes_to_look_at_again_are_where_items_were_and_nobody_has_looked_since() -> None:
    graph, task = harbour()
    view, cells = Egocentric(task), [(4, 9), (4, 8), (4, 7)]
    view.reset(1)
    last_seen = np.full(len(graph), 30, np.int16)
    last_seen[graph.node_of_cell[0, 1]] = 0
    view.see(observation_of(task, cells, {(0, 2): 1}, last_seen, step=31), ROW)
    lost = view.see(observation_of(task, cells, {}, last_seen, step=61), ROW)  # it is not there
    moves = lost["moves"][0, 0].copy()
    node = {name: graph.node_of_cell[rc] for name, rc in (("near", (0, 1)), ("far", (0, 9)))}
    marked = view._memory.nearby.marked[0]
    assert marked[node["near"]] and not marked[node["far"]]
    assert not marked[graph.node_of_cell[2, 2]]  # the pier hides it
    seen = observation_of(task, [(0, 3), *cells[1:]], {}, last_seen, step=62)
    local_map = view.see(seen, ROW)["local_map"]
    assert local_map[0, 0, 4, REACH, REACH - 2] == 255  # idle for longer than a quarter of 0.9 T
    assert local_map[0, 0, 4, REACH, REACH - 1] == int(255 * 4 * 31 / 135)
    assert moves[6, 0] == 255 and moves[6, 9] > 128  # west leads nearer to it
