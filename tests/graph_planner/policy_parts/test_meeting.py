"""Meetings with drifting items: time, place, and the agent of each item."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.boundary import boundary_of, drifted
from mjforage.graph_planner.belief_planner.foraging import Able
from mjforage.graph_planner.belief_planner.stops import FAR, Floating, floating
from mjforage.graph_planner.belief_planner.taking import Taking
from mjforage.graph_planner.belief_planner.ways import UNREACHED, row_to, ways_of
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.graph_planner.policy_parts.meeting import Sea, assign, groups_of, meet
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import float_item

NO_TIME = Taking(np.zeros((1, 3, 4)), np.zeros(3), 0.0)


def lake(rows: int, cols: int) -> NavigationGraph:
    return navigation_graph(np.ones((rows, cols), np.bool_), 1.0, False)


def sea_of(graph: NavigationGraph, *drift: float, moves: int = 1, taking: Taking = NO_TIME) -> Sea:
    ways = (ways_of(graph, moves, True, True),)
    return Sea(boundary_of(graph), ways, np.array(drift or (0.0, 0.0)), taking, True, 999.0)


def items_of(*placed: tuple[float, float, float]) -> Floating:
    items = floating(16)
    for row, col, weight in placed:
        float_item(items, row, col, weight)
    return items


def able_of(count: int, room: float = np.inf, lasts: float = 999.0) -> Able:
    who, none = np.arange(count), np.zeros(count, np.int64)
    return Able(who, none, np.full(count, room), np.full(count, lasts))


def given(
    graph: NavigationGraph,
    sea: Sea,
    cells: list[tuple[int, int]],
    items: Floating,
    able: Able | None = None,
    ahead: int = 9,
) -> list[tuple[int, int] | None]:
    """The cell that each forager is sent to."""
    at = np.array([graph.node_of_cell[cell] for cell in cells], np.int32)
    goal = np.zeros(len(cells), np.int32)
    about = able or able_of(len(cells))
    assign(sea, about, at, items, ahead, goal)
    return [None if v < 0 else (int(graph.rows[v]), int(graph.cols[v])) for v in goal]


def first_meeting(
    sea: Sea, at: int, place: NDArray[np.float64], free: int, latest: int
) -> tuple[float, int]:
    """The first decision in which an agent can be where the item is, each tried."""
    ways = sea.ways[0]
    for when in range(free + 1, latest + 1):
        _, _, node = drifted(
            sea.boundary, place[0], place[1], sea.drift[0], sea.drift[1], when - 1.0
        )
        decisions = int(ways.decisions[row_to(ways, node), at])
        if decisions < UNREACHED and free + max(decisions, 1) <= when:
            return float(when), int(node)
    return FAR, -1


@pytest.mark.parametrize("moves", [1, 2])
@pytest.mark.parametrize("free", [0, 3])
def test_items_are_met_in_the_first_decision_in_which_they_can_be(moves: int, free: int) -> None:
    graph, rng, met = lake(21, 33), np.random.default_rng(3), 0
    for _ in range(150):
        sea = sea_of(graph, *rng.uniform(-0.15, 0.15, 2), moves=moves)
        at, place = int(rng.integers(len(graph))), rng.uniform((0, 0), (20, 32))
        when, node = meet(sea, 0, at, place[0], place[1], float(free), 25.0)
        first = first_meeting(sea, at, place, free, 25)
        if moves == 1:
            assert (when, node) == first
        elif when < FAR:  # who leaps over nodes may be there in later decisions only
            assert (
                when >= first[0]
                and free + sea.ways[0].decisions[row_to(sea.ways[0], node), at] <= when
            )
        met += when < FAR
    assert met > 90


def test_nobody_meets_what_lies_in_other_water() -> None:
    graph = navigation_graph(grid("..#..", "..#.."), 1.0, False)
    assert meet(sea_of(graph), 0, 0, 0.0, 4.0, 0.0, 99.0) == (FAR, -1)


def test_picking_up_takes_its_time() -> None:
    slow = Taking(np.zeros((1, 3, 4)), np.array([2.0, 4.0, 6.0]), 5.0)
    graph = lake(9, 9)
    assert meet(sea_of(graph, taking=slow), 0, 0, 4.0, 4.0, 0.0, 99.0)[0] == 4.0 + 2.0


def test_a_forager_goes_to_where_the_item_will_be() -> None:
    graph = lake(21, 41)
    still, away = sea_of(graph), sea_of(graph, 0.0, 0.1)
    items = items_of((2.0, 20.0, 1.0))
    assert given(graph, still, [(18, 20)], items) == [(2, 20)]
    assert given(graph, away, [(18, 20)], items) == [(2, 22)]  # after 15 decisions of 0.1


def test_drift_decides_which_of_two_items_is_met_first() -> None:
    graph = lake(5, 61)
    items = items_of((2.0, 20.0, 1.0), (2.0, 41.0, 1.0))
    assert given(graph, sea_of(graph), [(2, 30)], items) == [(2, 20)]
    ((_, col),) = [
        cell for cell in given(graph, sea_of(graph, 0.0, -0.1), [(2, 30)], items) if cell
    ]
    assert col > 30


def test_a_better_pair_changes_hands() -> None:
    graph, items = lake(5, 41), items_of((2.0, 20.0, 1.0))
    assert given(graph, sea_of(graph), [(2, 10), (2, 35)], items) == [(2, 20), None]
    assert given(graph, sea_of(graph), [(2, 10), (2, 25)], items) == [None, (2, 20)]


def test_one_forager_takes_a_cluster_and_the_other_the_rest() -> None:
    graph = lake(5, 61)
    items = items_of(*((2.0, float(col), 1.0) for col in (10, 11, 12)), (2.0, 59.0, 1.0))
    at = [(2, 8), (2, 32)]
    assert given(graph, sea_of(graph), at, items) == [(2, 10), (2, 59)]
    assert given(graph, sea_of(graph), at, items, ahead=1) == [(2, 10), (2, 12)]


def test_ratios_are_of_rewards_over_times() -> None:
    graph = lake(5, 41)
    items = items_of((2.0, 15.0, 1.0), (2.0, 30.0, 3.0))  # 5 and 10 decisions away
    assert given(graph, sea_of(graph), [(2, 20)], items) == [(2, 30)]


def test_items_of_a_node_are_one_lot() -> None:
    graph = lake(5, 21)
    items = items_of((2.2, 5.0, 1.0), (1.8, 5.2, 0.5), (2.0, 8.0, 2.0), (0.0, 0.0, 0.0))
    lots = groups_of(items, boundary_of(graph))
    assert lots.weight.tolist() == [1.5, 2.0]
    assert lots.row[0] == pytest.approx(3.1 / 1.5) and lots.col[0] == pytest.approx(7.6 / 1.5)


def test_room_and_energy_limit_what_is_given() -> None:
    graph = lake(5, 61)
    items = items_of((2.0, 10.0, 2.0), (2.0, 12.0, 2.0))
    at = [(2, 9), (2, 50)]
    assert given(graph, sea_of(graph), at, items) == [(2, 10), None]
    full = able_of(2, room=2.0)
    assert given(graph, sea_of(graph), at, items, full) == [(2, 10), (2, 12)]
    spent = able_of(2, room=2.0, lasts=37.0)
    assert given(graph, sea_of(graph), at, items, spent) == [(2, 10), None]
    assert given(graph, sea_of(graph), at, items, able_of(2, 2.0, 38.0)) == [(2, 10), (2, 12)]
