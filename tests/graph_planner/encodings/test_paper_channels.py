import numpy as np

from mjforage.graph_planner.encodings.paper_channels import PaperChannels
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, task_of

ROW = np.zeros(1, np.int64)


def test_the_six_channels_of_a_hand_made_state() -> None:
    graph = navigation_graph(grid("....", ".#..", "...."), 1.0, True)
    task = task_of(graph, scouts=Role(1, 2, 4.0, False), foragers=Role(1, 1, 1.0, True))
    view = PaperChannels(task)
    view.reset(1)
    last_seen = np.zeros(len(graph), np.int16)
    last_seen[graph.node_of_cell[0, 0]] = -32768
    first = observation_of(task, [(0, 0), (2, 3)], {(0, 1): 3}, last_seen, step=1)
    view.see(first, ROW)
    second = observation_of(task, [(0, 2), (2, 3)], {(0, 1): 1, (2, 2): 12}, last_seen, step=28)
    seen = view.see(second, ROW)["map"][0]
    scout = seen[0]
    assert scout.shape == (6, 3, 4)
    idle = int(255 * 27 / (0.9 * 150))  # unseen since step 0, now step 27
    assert scout[0].tolist() == [[255, idle, idle, idle], [idle, 0, idle, idle], [idle] * 4]
    assert scout[1].tolist() == [[0, 25, 0, 0], [0] * 4, [0, 0, 255, 0]]  # 10 and more are full
    assert scout[2].tolist() == [[0, 76, 0, 0], [0] * 4, [0] * 4]
    assert not scout[3].any()
    assert scout[4].tolist() == [[229, 0, 255, 0], [0] * 4, [0] * 4]  # now, and one step ago
    assert scout[5].tolist() == [[0] * 4, [0] * 4, [0, 0, 0, 255]]  # the forager
    assert seen[1, 5, 0, 2] == 128  # the scout, as the forager sees it


def test_looking_twice_changes_nothing_and_step_1_forgets() -> None:
    graph = navigation_graph(grid("....."), 1.0, True)
    task = task_of(graph, scouts=Role(1, 1, 1.0, False))
    view = PaperChannels(task)
    view.reset(1)
    view.see(observation_of(task, [(0, 0)], {(0, 4): 1}, step=1), ROW)
    now = observation_of(task, [(0, 1)], {(0, 4): 2}, step=2)
    once = view.see(now, ROW)["map"].copy()
    np.testing.assert_array_equal(view.see(now, ROW)["map"], once)
    assert once[0, 0, 4].any(axis=0).sum() == 2
    anew = view.see(observation_of(task, [(0, 3)], step=1), ROW)["map"]
    assert np.flatnonzero(anew[0, 0, 4]).tolist() == [3]
    assert not anew[0, 0, 1:4].any()
