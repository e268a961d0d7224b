"""What holders know at a step, as it is copied from a mission."""

import numpy as np
import pytest

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs.holders_seen import UNSEEN, HoldersMaps, HoldersSeen
from mjforage.scenario.scenario_file import load_scenario

STEP = 3


def played(*link: str, horizon: int = 6) -> tuple[Mission, HoldersMaps]:
    setup = Setup.of(load_scenario("comb-port", [f"horizon={horizon}", *link]))
    mission = create_mission(setup, "graph")
    mission.reset(7, np.array([2, 5], np.int64))
    seen = HoldersSeen(STEP)
    mission.run(create_policy("greedy"), (seen,))
    return mission, seen.maps


def test_without_a_link_each_knows_what_it_saw_and_where_all_began() -> None:
    mission, maps = played("link.model=none")
    start = mission.setup.graph
    assert (maps.step, maps.names[0]) == (STEP, "scouts_0")
    assert maps.owner_of.tolist() == [0, 1, 2, 3]
    assert maps.belief.shape == maps.age.shape == (4, *start.shape)
    assert maps.agent_age.tolist() == [[0 if h == a else STEP for a in range(4)] for h in range(4)]
    begun = mission.initial.agent_node[0]
    for holder, place in enumerate(maps.agent_rc):
        for agent, (row, col) in enumerate(place):
            if agent != holder:
                assert (row, col) == (start.rows[begun[agent]], start.cols[begun[agent]])
        row, col = place[holder]
        assert maps.age[holder, row, col] == 0, "its own node is in view"
    assert (maps.age[:, mission.setup.grid.navigable] == UNSEEN).any()
    assert maps.age.max() <= STEP


def test_one_mind_is_one_holder() -> None:
    _, maps = played()
    assert maps.owner_of.tolist() == [0, 0, 0, 0]
    assert maps.belief.shape[0] == 1
    assert maps.agent_age.tolist() == [[0, 0, 0, 0]]


@pytest.mark.parametrize("horizon", [2, 3])
def test_of_a_shorter_episode_it_is_the_end(horizon: int) -> None:
    _, maps = played("link.model=disk", horizon=horizon)
    assert maps.step == horizon
