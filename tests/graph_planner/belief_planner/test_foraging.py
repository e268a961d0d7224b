"""Collectors that can still collect, and for how long."""

from dataclasses import replace

import numpy as np

from mjforage.graph_planner.belief_planner.foraging import USUAL_STEP, Collecting
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.task import Pickup
from mjforage.scenario.roles import UNLIMITED, Role
from tests.graph_planner.driver import task_of

SEA = navigation_graph(np.ones((9, 9), np.bool_), 1.0, False)
TASK = task_of(
    SEA,
    scout=Role(1, 2, 4.0, False),
    tug=Role(3, 1, 1.0, True, 4, 60.0),
    boat=Role(1, 2, 1.0, True),
)
ROOM = np.array([0, 0, 3, 1, UNLIMITED])  # of the scout, the tugs and the boat
ENERGY = np.array([9.0, 9.0, 1.0, 0.5, 48.0])


def test_those_with_room_and_energy_are_able_for_as_long_as_it_lasts() -> None:
    able = Collecting(TASK, BeliefSettings()).able_now(ROOM, ENERGY)
    assert able.agents.tolist() == [2, 4]
    assert able.kind.tolist() == [0, 1]  # by one node, and by two
    assert able.room.tolist() == [3.0, np.inf]
    np.testing.assert_allclose(able.lasts, [1.0, 48.0 / (2 * USUAL_STEP)])


def test_picking_up_takes_no_energy() -> None:
    first = np.zeros((5, 3, 4))
    first[2, 1, 1] = 2.5
    task = replace(TASK, pickup=Pickup(first, np.zeros(5)))
    able = Collecting(task, BeliefSettings()).able_now(ROOM, ENERGY)
    np.testing.assert_allclose(able.lasts, [3.5, 48.0 / (2 * USUAL_STEP) + 2.5])


def test_only_those_who_are_able_are() -> None:
    collecting = Collecting(TASK, BeliefSettings())
    assert [collecting.is_able(a, ROOM, ENERGY) for a in range(5)] == [False] * 2 + [
        True,
        False,
        True,
    ]


def test_those_who_are_not_able_stay() -> None:
    preferences, at = np.zeros((5, 9)), np.full(5, 40, np.int32)
    Collecting(TASK, BeliefSettings()).hold(at, ROOM, ENERGY, preferences)
    assert preferences[[1, 3]].argmax(axis=1).tolist() == [8, 8]
    assert not preferences[[0, 2, 4]].any()
