"""A scenario by hand: what missions and policies are told of it, in whose unit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import COMPASS
from mjforage.mission.task import Task
from mjforage.scenario.link import Link
from mjforage.scenario.scenario import CorruptionChoice, Items, MapChoice, Rules, Weather
from tests.mjforage.mission.by_hand import CALM, PERIOD_S, PITCH_M, SCENARIO, by_hand, water

KEYS = episode_keys(3, np.arange(4))
BLOWS = {  # from where, in compass degrees -> (rows, columns) that it takes an item in a unit
    0.0: (1.0, 0.0),
    90.0: (0.0, -1.0),
    180.0: (-1.0, 0.0),
    270.0: (0.0, 1.0),
    225.0: (-math.sqrt(0.5), math.sqrt(0.5)),
    -45.0: (math.sqrt(0.5), math.sqrt(0.5)),
}


def test_cells_are_nodes_by_rows_from_the_northwest() -> None:
    """Cell (1, 2) is land: 7 nodes in the first row, so (1, 5) is the fifth of the second."""
    setup = by_hand()
    assert len(setup.graph) == 28 - 3 and setup.graph.shape == (4, 7)
    assert setup.start_nodes.tolist() == [7 + 4, 7 + 6 + 1, 3]
    # Row 1 of 4 is two rows of 5 m from the south edge's centres, column 5 is 25 m from the west.
    assert setup.graph.metres(np.array([1.0, 5.0])).tolist() == [25.0, 10.0]
    assert setup.graph.row_column(np.array([25.0, 10.0])).tolist() == [1.0, 5.0]


@pytest.mark.parametrize("degrees", BLOWS)
def test_a_wind_from_a_compass_point_takes_items_to_the_other_side(degrees: float) -> None:
    """4 m/s take an item 0.03 * 4 * 8 = 0.96 m a decision, which is 0.192 node of 5 m."""
    weather = replace(CALM, wind_speed_mps=4.0, wind_from_deg=degrees, drift_node_per_step=0.1)
    drift = by_hand(weather=weather).create_initial_state(KEYS).drift_rc
    expected = 0.03 * 4.0 * PERIOD_S / PITCH_M * np.array(BLOWS[degrees])
    np.testing.assert_allclose(drift, np.tile(expected, (4, 1)), atol=1e-12)


def test_the_papers_drift_is_in_nodes_whatever_their_length() -> None:
    drift = by_hand(weather=Weather(drift_node_per_step=0.1)).create_initial_state(KEYS).drift_rc
    longer = by_hand(map=replace(SCENARIO.map, pitch_m=50.0), weather=Weather())
    assert 0.05 < np.abs(drift).max() <= 0.1
    np.testing.assert_array_equal(longer.create_initial_state(KEYS).drift_rc, drift)


def test_the_team_that_is_named_is_corrupted() -> None:
    for team, epsilon in (("scouts", [0.3, 0.3, 0.0]), ("foragers", [0.0, 0.0, 0.3])):
        found = by_hand(corruption=CorruptionChoice(team, 0.3)).corruption
        assert found.epsilon.tolist() == epsilon
        assert not found.whole_team
    assert by_hand(corruption=CorruptionChoice("scouts", 0.3, whole_team=True)).corruption[1]
    assert not by_hand().corruption.epsilon.any()


def task_of(**link: object) -> Task:
    return by_hand(link=Link(**link)).task  # type: ignore[arg-type]


def test_planners_know_how_far_radios_reach_in_nodes() -> None:
    assert task_of(model="disk", range_m=64.0).reach_node == 64.0 / PITCH_M
    assert task_of().reach_node == np.inf
    assert task_of(model="none").reach_node == 0.0


def test_what_is_received_after_the_mission_is_never_received() -> None:
    for latency, reach_node in ((0, 12.8), (19, 12.8), (20, 0.0)):
        task = task_of(model="disk", range_m=64.0, latency=latency)
        assert (task.latency, task.reach_node) == (latency, reach_node)


def test_starts_are_those_of_the_scenario_and_every_agent_has_one() -> None:
    setup = by_hand()
    placed = setup.create_initial_state(episode_keys(0, np.arange(30))).agent_node
    assert (np.sort(placed, axis=1) == [3, 11, 14]).all()
    assert len({tuple(each) for each in placed.tolist()}) == 6, "every order comes up"
    cluster = by_hand(map=MapChoice("by-hand", starts=())).create_initial_state(KEYS).agent_node
    assert {tuple(sorted(each)) for each in cluster.tolist()} != {(3, 11, 14)}


def test_a_role_reaches_what_its_moves_end_on() -> None:
    """A channel of 1 x 6: all or nothing, two-node moves end on every other node."""
    channel = water(("111111",))
    where = MapChoice("channel", starts=((0, 1), (0, 2), (0, 3)))
    shares = by_hand(channel, map=where, rules=Rules(shorten=False)).reachable_shares
    assert shares == {"scouts": 3 / 6, "foragers": 1.0}
    assert by_hand(channel, map=where).reachable_shares == {"scouts": 1.0, "foragers": 1.0}


def test_corners_are_cut_where_the_map_says_so() -> None:
    """Of two squares that touch in a corner the first is reached alone, unless it may be cut."""
    squares = water(("1100", "1100", "0011", "0011"))
    one = MapChoice("squares", starts=((0, 0), (0, 1), (1, 0)), largest_component=True)
    assert len(by_hand(squares, map=one).graph) == 4
    cut = replace(one, corner_cutting=True)
    graph = by_hand(squares, map=cut).graph
    assert len(graph) == 8
    assert graph.neighbours[3, COMPASS.index("SE")] == 4  # from (1, 1) to (2, 2)
    assert by_hand(squares, map=cut).reachable_shares["foragers"] == 1.0


def test_of_two_parts_the_larger_is_kept_wherever_it_lies() -> None:
    parts = water(("1100000", "0000111", "0000111"))
    where = MapChoice("parts", starts=((1, 4), (1, 5), (2, 6)), largest_component=True)
    assert by_hand(parts, map=where).grid.navigable.tolist() == [
        *([False] * 7, [False] * 4 + [True] * 3, [False] * 4 + [True] * 3)
    ]


def test_items_on_land_are_put_back_as_the_scenario_says() -> None:
    """Into a pond of one node amidst land: each side cut to 0.49, or the longer one alone."""
    pond = np.zeros((41, 61), np.bool_)
    pond[20, 30] = True
    one = {
        "team": {"foragers": SCENARIO.team["foragers"]},
        "map": MapChoice("pond", starts=((20, 30),)),
        "items": Items(mean=50.0, std=0.0, covariance_node2=16.0),
    }
    for rules, both in ((Rules(), True), (Rules(walls="project"), False)):
        state = by_hand(pond, rules=rules, **one).create_initial_state(KEYS[:1])
        off = np.abs(state.item_rc[0] - (20.0, 30.0))
        assert off.max() == pytest.approx(0.49)
        corners = np.isclose(off, 0.49).all(axis=1).mean()
        assert (corners > 0.5) if both else (corners == 0.0)


def test_sight_across_land_is_the_whole_disc() -> None:
    """(1, 2) is land: from (1, 1) it hides (1, 3), two nodes away; the disc has all within 2.5."""
    line, disc = by_hand(), by_hand(rules=Rules(sight="disc"))
    at, behind = (line.graph.node_of_cell[cell] for cell in ((1, 1), (1, 3)))
    scouts = line.task.radius_number[0]
    seen = [set(each.task.views.of(at, scouts).tolist()) for each in (line, disc)]
    rows, cols = line.graph.rows, line.graph.cols
    within = np.flatnonzero((rows - 1) ** 2 + (cols - 1) ** 2 <= 2.5**2)
    assert behind not in seen[0] and seen[0] < seen[1] == set(within.tolist())
