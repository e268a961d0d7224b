"""A replay shows what there was: who saw what, and how long ago, by the agents' own ways."""

import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.mission.item_classes import draw_classes
from mjforage.mission.setup import Setup
from mjforage.runs.recording import record
from mjforage.scenario.scenario_file import load_scenario


def test_views_and_idleness_are_those_of_the_agents_ways() -> None:
    """Bit 0 is what scouts see, bit 1 what foragers do; idle is what was not seen for long."""
    setup = Setup.of(load_scenario("comb-port", ["horizon=8"]))
    replay, task, graph = record(setup, "graph", "greedy", 3, 2), setup.task, setup.graph
    last = np.full(len(graph), -(10**6))
    for step, places in enumerate(replay.agent_rc.astype(np.int64)):
        seen = np.zeros((2, len(graph)), np.bool_)
        for agent, (row, col) in enumerate(places):
            node = int(graph.node_of_cell[row, col])
            view = task.views.of(node, int(task.radius_number[agent]))
            seen[int(setup.fleet.collects[agent]), view] = True
        last[seen.any(axis=0)] = step
        expected = np.minimum(1.0, (step - last) * task.forgetting)
        in_view = replay.in_view[step][graph.rows, graph.cols]
        np.testing.assert_array_equal(in_view, seen[0] + 2 * seen[1])
        idle = replay.idleness[step][graph.rows, graph.cols]
        np.testing.assert_array_equal(idle, expected.astype(np.float16))
    assert (seen[0] & ~seen[1]).any() and (seen[1] & ~seen[0]).any()


def test_each_item_has_the_class_that_its_episode_draws() -> None:
    classes = ["physics.item_classes=['drifter', 'bag']", "horizon=20", "physics.items=graph"]
    setup = Setup.of(load_scenario("comb-port", classes))
    replay, keys = record(setup, "graph", "greedy", 3, 1), episode_keys(3, np.array([1]))
    drawn = draw_classes(keys, setup.create_initial_state(keys).item_node, np.array([4, 2]))[0]
    np.testing.assert_array_equal(replay.item_class, drawn)
    assert not replay.item_present[-1].all(), "those that were taken have theirs too"
    assert {*drawn.tolist()} == {2, 4}, "places of both among those that ship"
