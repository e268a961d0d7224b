"""Keeping in touch: who brings news, who waits where, and who looks alone."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mjforage.graph_planner.belief_planner.connectivity import (
    ELSEWHERE,
    NOBODY,
    PATIENCE,
    SLACK,
    Connectivity,
    parts_of,
)
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.ways import ways_of
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.task import Observation
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, preferences, task_of

SEA = navigation_graph(np.ones((30, 30), np.bool_), 1.0, False)
TASK = replace(
    task_of(SEA, scouts=Role(1, 2, 4.0, False), foragers=Role(2, 1, 1.0, True)), reach_node=5.0
)
SCOUT, FORAGER, OTHER = range(3)
WAYS = ways_of(SEA, 2, TASK.rules)
NEWS = np.array([5, 18], np.int32)  # steps in which two items were first seen


def seen_by(holder: int, heard: dict[int, int], step: int = 21) -> Observation:
    """An observation of one holder: the scout in a corner, the foragers in two others."""
    observation = observation_of(TASK, [(0, 0), (0, 20), (20, 0)], step=step)
    observation.owner[:] = holder
    for agent, when in heard.items():
        observation.agent_seen[0, agent] = when
    return observation


def connectivity_of(**settings: Any) -> Connectivity:
    return Connectivity(TASK, replace(BeliefSettings(), **settings), 1)


def is_at(node: int, row: int, col: int) -> bool:
    """True if a node is a cell or one beside it: some scouts cannot end a move in every cell."""
    return max(abs(int(SEA.rows[node]) - row), abs(int(SEA.cols[node]) - col)) <= 1


def test_news_is_brought_to_the_nearest_who_lacks_it_and_is_idle() -> None:
    late = 20 - SLACK - 1
    seen = seen_by(SCOUT, {FORAGER: late, OTHER: late})
    assert is_at(connectivity_of().tells(seen, 0, NEWS, WAYS), 0, 20)
    both = seen_by(SCOUT, {FORAGER: 20, OTHER: late})
    assert is_at(connectivity_of().tells(both, 0, NEWS, WAYS), 20, 0), "the first is in touch"
    assert connectivity_of().tells(seen, 0, NEWS[:1], WAYS) == NOBODY, "old news"
    assert connectivity_of(report=False).tells(seen, 0, NEWS, WAYS) == NOBODY
    apart = Connectivity(replace(TASK, reach_node=0.0), BeliefSettings(), 1)
    assert apart.tells(seen, 0, NEWS, WAYS) == NOBODY, "nobody would receive it"
    assert Connectivity(replace(TASK, reach_node=np.inf), BeliefSettings(), 1).always
    many = np.concatenate((np.zeros(40, np.int32), [18])).astype(np.int32)
    assert connectivity_of().tells(seen, 0, many, WAYS) == NOBODY, "they have enough to do"


def test_who_is_not_found_is_not_looked_for_before_there_is_newer_news() -> None:
    touch, late = connectivity_of(), 20 - SLACK - 2
    seen = seen_by(SCOUT, {FORAGER: late, OTHER: 20})
    seen.agent_node[0, SCOUT] = SEA.node_of_cell[0, 19]
    assert touch.tells(seen, 0, NEWS, WAYS) == NOBODY
    seen.agent_node[0, SCOUT] = SEA.node_of_cell[9, 9]
    assert touch.tells(seen, 0, NEWS, WAYS) == NOBODY, "as long as nothing newer is heard"
    seen.agent_seen[0, FORAGER] = late + 1
    assert is_at(touch.tells(seen, 0, NEWS, WAYS), 0, 20)


def test_a_forager_waits_where_it_was_last_in_touch_and_then_looks_alone() -> None:
    touch = connectivity_of()
    touch.note(seen_by(FORAGER, {SCOUT: 20}), 0)
    away = seen_by(FORAGER, {SCOUT: 20}, step=21 + SLACK + 1)
    away.agent_node[0, FORAGER] = SEA.node_of_cell[9, 9]
    touch.note(away, 0)
    assert touch.waits(away, 0) == SEA.node_of_cell[0, 20]
    assert not touch.looks_alone(away, 0)
    apart = Connectivity(replace(TASK, reach_node=0.0), BeliefSettings(), 1)
    assert apart.looks_alone(away, 0), "at once where nobody is ever in contact"
    long = seen_by(FORAGER, {SCOUT: 20}, step=21 + PATIENCE)
    assert touch.looks_alone(long, 0) and not connectivity_of(alone=False).looks_alone(long, 0)
    assert touch.waits(seen_by(FORAGER, {SCOUT: 20}), 0) == NOBODY, "in touch"


@pytest.mark.parametrize("number", [1, 2, 5])
def test_parts_share_the_map(number: int) -> None:
    part = parts_of(SEA, 0, number)
    sizes = np.bincount(part, minlength=number)
    assert sizes.size == number and sizes.min() > len(SEA) / (3 * number)


def test_each_who_looks_alone_has_a_part_of_its_own() -> None:
    mine, other = (connectivity_of().part(seen_by(who, {}), 0) for who in (FORAGER, OTHER))
    assert ((mine == 1.0) != (other == 1.0)).all()
    assert set(mine) == {ELSEWHERE, 1.0}


def test_two_who_look_alone_from_one_place_go_different_ways() -> None:
    """All else that they know is alike: both in the middle, nobody ever heard."""
    seen = observation_of(TASK, [(0, 0), (15, 15), (15, 15)], step=60, episodes=2)
    seen.agent_seen[:], seen.owner[:] = 0, [FORAGER, OTHER]
    answer = preferences("belief", replace(TASK, reach_node=0.0), seen)
    assert (answer[0, FORAGER] != answer[1, OTHER]).any()


def test_who_was_told_much_long_ago_has_done_with_it() -> None:
    """40 items keep a forager busy for 57 decisions; the scout is 10 to 14 away."""
    born = np.concatenate((np.zeros(40, np.int32), [40])).astype(np.int32)
    for step, goes in ((50, False), (75, True)):
        seen = seen_by(SCOUT, {FORAGER: 10, OTHER: step - 1}, step)
        assert (connectivity_of().tells(seen, 0, born, WAYS) != NOBODY) == goes


def test_beside_is_not_near_with_a_quay_between() -> None:
    cells = np.ones((30, 30), np.bool_)
    cells[:25, 10] = False
    graph = navigation_graph(cells, 1.0, False)
    team = task_of(graph, scouts=Role(1, 2, 4.0, False), foragers=Role(1, 1, 1.0, True))
    seen = observation_of(replace(team, reach_node=5.0), [(0, 9), (0, 11)], step=21)
    seen.owner[:], seen.agent_seen[0, 1] = 0, 10
    ways = ways_of(graph, 2, team.rules)
    touch = Connectivity(replace(team, reach_node=5.0), BeliefSettings(), 1)
    assert touch.tells(seen, 0, NEWS, ways) != NOBODY, "it has to go round"


def test_who_looks_alone_does_not_look_again_where_it_would_have_noticed() -> None:
    from mjforage.graph_planner.belief_planner.covers import NOTICED, hotspot_cover

    cover, _ = hotspot_cover(TASK, FORAGER, BeliefSettings())
    touch, here = connectivity_of(), int(SEA.node_of_cell[10, 10])
    cells = cover.cells[cover.start[here] : cover.start[here + 1]]
    assert cells.size
    for passes in (1, 2):
        mass = np.ones(cover.landmark.size)
        touch.passed(0, cover, here, mass)
        assert mass[cells] == pytest.approx((1.0 - NOTICED) ** passes)
        assert (np.delete(mass, cells) == 1.0).all()


def test_a_relay_beside_a_forager_brings_no_news() -> None:
    scouts, foragers = Role(1, 2, 4.0, False), Role(1, 1, 1.0, True)
    relays = Role(1, 1, 0.0, False, relays=True)
    team = task_of(SEA, scouts=scouts, foragers=foragers, relays=relays)
    task = replace(team, reach_node=5.0)
    observation = observation_of(task, [(0, 0), (0, 20), (0, 21)], step=21)
    observation.owner[:] = 1
    observation.agent_seen[0, 0] = 3
    touch = Connectivity(task, BeliefSettings(), 1)
    touch.note(observation, 0)
    assert touch.waits(observation, 0) == SEA.node_of_cell[0, 20]


def test_with_a_latency_news_is_older() -> None:
    late = Connectivity(replace(TASK, latency=5), BeliefSettings(), 1)
    seen = seen_by(SCOUT, {FORAGER: 20 - SLACK - 4, OTHER: 20 - SLACK - 5})
    assert late.tells(seen, 0, NEWS, WAYS) == NOBODY
    assert connectivity_of().tells(seen, 0, NEWS, WAYS) != NOBODY


def test_a_relay_stands_where_the_others_are_in_its_reach() -> None:
    """Reach 10, of which 8 count: between two who are 14 apart, and as near to one as to the other
    where they are 20 apart.
    """
    scout, forager = Role(1, 2, 4.0, False), Role(1, 1, 1.0, True)
    relay = Role(1, 2, 0.0, False, relays=True)
    task = replace(task_of(SEA, scouts=scout, foragers=forager, relays=relay), reach_node=10.0)
    for far, col_from, col_to in ((14, 5, 9), (20, 9, 11)):
        seen = observation_of(task, [(5, 0), (5, far), (25, 20)], step=9)
        for holder in (0, 1):
            seen.owner[:] = holder
            assert Connectivity(task, BeliefSettings(), 1).connects(seen, 0, WAYS) == NOBODY, (
                "no relay"
            )
        seen.owner[:] = 2
        node = Connectivity(task, BeliefSettings(), 1).connects(seen, 0, WAYS)
        away = [np.hypot(SEA.rows[node] - 5, SEA.cols[node] - col) for col in (0, far)]
        assert col_from <= SEA.cols[node] <= col_to and max(away) <= max(8.0, far / 2) + 1.5
        assert Connectivity(task, BeliefSettings(relay=False), 1).connects(seen, 0, WAYS) == NOBODY
        apart = Connectivity(replace(task, reach_node=0.0), BeliefSettings(), 1)
        assert apart.connects(seen, 0, WAYS) == NOBODY
        news = np.array([5, 8], np.int32)
        seen.agent_seen[0, 1] = 0
        assert Connectivity(task, BeliefSettings(), 1).tells(seen, 0, news, WAYS) == NOBODY
