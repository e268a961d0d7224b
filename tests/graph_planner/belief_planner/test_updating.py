"""Actions of foragers in the step just made, as the beliefs take them in."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.belief_planner import updating as up
from mjforage.graph_planner.belief_planner.beliefs import Beliefs
from mjforage.graph_planner.belief_planner.routes import NOWHERE
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.task import UNREACHABLE, Observation, Pickup, Task
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, task_of

SEA = navigation_graph(np.ones((12, 12), np.bool_), 1.0, False)
AT_ONCE = task_of(SEA, scout=Role(1, 2, 4.0, False), tugs=Role(3, 1, 1.0, True, 4))
HULLS = replace(AT_ONCE, pickup=Pickup(np.ones((4, 3, 4)), np.ones(4)))
CELLS = [(0, 0), (3, 3), (6, 6), (9, 9)]
NODES = [int(SEA.node_of_cell[cell]) for cell in CELLS[1:]]
KEYS = episode_keys(0, np.arange(2))


def seen_at(task: Task, step: int) -> Observation:
    """Two rows alike; the last tug was not heard of in the step just made."""
    seen = observation_of(task, CELLS, {}, np.full(len(SEA), step - 2, np.int16), step, episodes=2)
    seen.agent_seen[:, 3] = step - 2
    return seen


@pytest.mark.parametrize("task", [AT_ONCE, HULLS])
def test_who_had_room_took_all_there_was_unless_hulls_pick_up_one_by_one(task: Task) -> None:
    store = Beliefs(task, BeliefSettings(), KEYS)._store
    first, second = seen_at(task, 1), seen_at(task, 2)
    first.room_left[1, 1] = 0
    up.begin(store, first, 1)
    everywhere = [*NODES[:2], NOWHERE]  # the last one is not where it was
    expected = [NOWHERE, *everywhere[1:]] if task is AT_ONCE else [NOWHERE] * 3
    assert up.begin(store, second, 1).tolist() == expected
    again = everywhere if task is AT_ONCE else [NOWHERE] * 3
    assert up.begin(store, seen_at(task, 3), 1).tolist() == again


def test_what_hulls_took_is_what_they_have_more_than_before() -> None:
    store = Beliefs(HULLS, BeliefSettings(), KEYS)._store
    first, second = seen_at(HULLS, 1), seen_at(HULLS, 2)
    first.taken[1] = [0, 2, 0, 1]
    second.taken[1] = [0, 3, 0, 1]
    assert up.catch_of(store, first, 1).left.tolist() == [2, 0, 1]
    caught = up.catch_of(store, second, 1)
    assert caught.left.tolist() == [1, 0, 0] and caught.at.tolist() == NODES
    at_once = Beliefs(AT_ONCE, BeliefSettings(), KEYS)._store
    assert up.catch_of(at_once, first, 1).at.size == 0


def test_where_a_hull_gave_up_just_now_an_item_counts_less_for_a_while() -> None:
    beliefs, seen = Beliefs(HULLS, BeliefSettings(), KEYS), seen_at(HULLS, 11)
    seen.pickup[1, [1, 3]] = UNREACHABLE
    up.catch_of(beliefs._store, seen, 1)
    assert np.flatnonzero(beliefs.later[1]).tolist() == NODES[:1]
    assert beliefs.later[1, NODES[0]] == 10 + up.LATER
    assert not beliefs.later[0].any()


def test_where_nobody_met_anything_nothing_is_expected_while_eyes_miss_nothing() -> None:
    beliefs = Beliefs(AT_ONCE, BeliefSettings(), KEYS)
    seen = seen_at(AT_ONCE, 1)
    seen.last_seen[0], seen.last_seen[1] = -1, np.where(SEA.rows < 5, 0, -1)
    for e in range(2):
        beliefs.learn(seen, e)
    assert (beliefs.expected[0] > 0).all()
    np.testing.assert_array_equal(beliefs.expected[1] == 0, SEA.rows < 5)
