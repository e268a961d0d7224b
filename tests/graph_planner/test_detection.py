"""Detection probability: what is in view is seen or not, by item and step."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.fleet import Fleet, Role
from graph_planner.moves import MoveRules
from graph_planner.navigation import navigation_graph
from graph_planner.randomness import episode_keys
from graph_planner.shared_model import SharedModel
from graph_planner.task import Task

GRAPH = navigation_graph(np.ones((1, 3), np.bool_), 1.0, True)
SCOUT = Fleet.of({"scouts": Role(count=1, moves=1, radius=1.0, collects=False)})
TASK = Task(GRAPH, SCOUT, MoveRules(True, True), 100)
EPISODES = 400
KEYS = episode_keys(0, np.arange(EPISODES))
AGENT = np.ones((EPISODES, 1), np.int32)  # in the middle: all three nodes are in view
ITEMS = np.tile(np.array([0, 0, 2], np.int32), (EPISODES, 1))
EVERYONE = np.ones(EPISODES, np.bool_)


def seen(detection: float, steps: int) -> SharedModel:
    model = SharedModel(TASK, detection)
    model.reset(AGENT, ITEMS, KEYS)
    nobody = np.full(ITEMS.shape, -1, np.int16)
    for step in range(1, steps + 1):
        model.update(EVERYONE, np.full(EPISODES, step, np.int32), AGENT, ITEMS, nobody)
    return model


def share(values: NDArray[np.bool_]) -> float:
    return float(values.mean())


def test_certain_detection_sees_all_and_none_sees_nothing() -> None:
    assert (seen(1.0, 0).knowledge.belief == [2, 0, 1]).all()
    blind = seen(0.0, 3).knowledge
    assert (blind.belief == 0).all()
    assert (blind.t_discovered == -1).all()
    assert (blind.truth == [2, 0, 1]).all(), "the truth stays what it is"
    assert (blind.last_seen == 3).all(), "looking counts, whether or not anything is seen"


def test_each_item_is_seen_with_its_probability_at_every_step_anew() -> None:
    """Counts in a node are binomial; first discovery is geometric."""
    p, now, later = 0.3, seen(0.3, 0).knowledge, seen(0.3, 5).knowledge
    tolerance = 4 * 0.5 / np.sqrt(EPISODES)
    for count, expected in ((0, 0.7**2), (1, 2 * 0.3 * 0.7), (2, 0.3**2)):
        assert abs(share(now.belief[:, 0] == count) - expected) < tolerance
        assert abs(share(later.belief[:, 0] == count) - expected) < tolerance
    for step in range(3):
        assert abs(share(later.t_discovered == step) - p * (1 - p) ** step) < tolerance / np.sqrt(3)


def test_only_what_was_seen_is_credited() -> None:
    model = seen(0.5, 0).knowledge
    first = model.t_discovered == 0
    assert (model.discovered_by[first] == 0).all()
    assert (model.discovered_by[~first] == -1).all()
    in_node = first[:, :2].sum(axis=1)
    assert (model.belief[:, 0] == in_node).all()


def test_draws_do_not_depend_on_the_batch() -> None:
    whole = seen(0.5, 0).knowledge.belief
    model = SharedModel(TASK, 0.5)
    model.reset(AGENT[5:7], ITEMS[5:7], KEYS[5:7])
    assert (model.knowledge.belief == whole[5:7]).all()
