"""The auction policy, by hand on small maps."""

import itertools

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policy_parts.auctions import Bidders, Lots, sell_items
from mjforage.mission.task import NEVER, Observation, Task
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, preferences, task_of

N, NE, E, SE, S, SW, W, NW = range(8)
Cell = tuple[int, int]


def foragers(count: int = 1, **more: float) -> Role:
    return Role(
        count, 1, 1.0, True, capacity=int(more.get("capacity", 0)), energy=more.get("energy", 0.0)
    )


def scouts(count: int = 1, moves: int = 2) -> Role:
    return Role(count, moves, 4.0, False)


def lake(rows: int, cols: int) -> NavigationGraph:
    return navigation_graph(np.ones((rows, cols), np.bool_), 1.0, False)


def chosen(task: Task, seen: Observation, policy: str = "auction") -> list[int]:
    """The move that each agent of the first row prefers."""
    return [int(move) for move in preferences(policy, task, seen)[0].argmax(axis=1)]


def after(task: Task, seen: Observation, steps: int, policy: str = "auction") -> list[Cell]:
    """Nodes of the agents of one row after some decisions in which nothing new is seen."""
    made, graph = create_policy(policy), task.graph
    made.reset(task, seen.keys)
    for _ in range(steps):
        moves = made.act(seen)[0].argmax(axis=1)
        for agent, move in enumerate(moves):
            table = task.arrays.targets[task.arrays.stride_number[agent]]
            seen.agent_node[0, agent] = table[seen.agent_node[0, agent], move]
        seen.step[:] += 1
    return [(int(graph.rows[v]), int(graph.cols[v])) for v in seen.agent_node[0]]


def tours(
    ways: NDArray[np.float64], bidders: int, room: int = 99, energy: float = np.inf
) -> list[list[int]]:
    """Sales of `sell_items`, ways being (place, place) with the bidders' places first."""
    lots = ways.shape[0] - bidders
    sold, size = np.zeros((bidders, lots), np.int32), np.zeros(bidders, np.int32)
    ones = np.ones(lots, np.int64)
    first, between = ways[:bidders, bidders:].copy(), ways[bidders:, bidders:].copy()
    who = Bidders(
        np.ones(bidders),
        np.full(bidders, room),
        np.full(bidders, energy),
        np.linspace(0.0, 1e-7, bidders),
    )
    goods = Lots(first, between, ones, np.linspace(0.0, 1e-8, lots))
    sell_items(who, goods, sold, size)
    return [sold[b, : size[b]].tolist() for b in range(bidders)]


def on_a_line(*places: float) -> NDArray[np.float64]:
    at = np.array(places)
    ways: NDArray[np.float64] = np.abs(at[:, None] - at[None, :])
    return ways


def test_two_foragers_do_not_cross() -> None:
    task = task_of(lake(5, 21), foragers=foragers(2))
    for known in ({(2, 4): 1, (2, 16): 1}, {(2, 16): 1, (2, 4): 1}):
        seen = observation_of(task, [(2, 8), (2, 12)], known)
        assert chosen(task, seen) == [W, E]


def test_one_of_two_foragers_leaves_the_nearest_item_to_the_other() -> None:
    """Greedy sends both to the item between them; here one of them goes for the far one."""
    task = task_of(lake(5, 21), foragers=foragers(2))
    seen = observation_of(task, [(2, 8), (2, 11)], {(2, 9): 1, (2, 19): 1})
    assert chosen(task, seen) == [E, E]
    seen = observation_of(task, [(2, 6), (2, 11)], {(2, 9): 1, (2, 0): 1})
    assert chosen(task, seen) == [W, W]


def test_an_item_is_sold_anew_when_a_nearer_one_appears() -> None:
    task = task_of(lake(5, 21), foragers=foragers())
    policy = create_policy("auction")
    far = observation_of(task, [(2, 8)], {(2, 16): 1})
    policy.reset(task, far.keys)
    assert int(policy.act(far)[0, 0].argmax()) == E
    near = observation_of(task, [(2, 9)], {(2, 16): 1, (2, 7): 1}, step=2)
    assert int(policy.act(near)[0, 0].argmax()) == W


def test_ways_are_geodesic() -> None:
    graph = navigation_graph(grid(".....", ".###.", ".....", "....."), 1.0, False)
    task = task_of(graph, foragers=foragers(2))
    seen = observation_of(task, [(0, 2), (3, 4)], {(2, 2): 1})  # two away by air, six by water
    west, east = (chosen(task, seen)[1], chosen(task, seen)[0])
    assert west in (W, NW) and east == STAY


def test_a_scout_buys_no_place_that_its_energy_does_not_reach() -> None:
    """What is unseen begins 11 nodes to the east, of which a scout sees 4 ahead."""
    graph = lake(3, 41)
    task = task_of(graph, scouts=Role(1, 1, 4.0, False, energy=99.0))
    last_seen = np.where(graph.cols > 30, NEVER, 9).astype(np.int16)
    for energy, goes in ((99.0, True), (5.0, False)):
        seen = observation_of(task, [(1, 20)], last_seen=last_seen, step=10)
        seen.energy_left[:] = energy
        move = int(preferences("auction", task, seen)[0, 0].argmax())
        assert move in ((NE, E, SE) if goes else (STAY,))


def test_nobody_buys_an_item_that_its_energy_does_not_reach() -> None:
    task = task_of(lake(5, 21), foragers=foragers(1, energy=6.0))
    seen = observation_of(task, [(2, 10)], {(2, 2): 1, (2, 15): 1})
    assert tours(on_a_line(10, 2, 15), 1, energy=6.0) == [[1]]
    assert chosen(task, seen) == [E]


def test_nobody_buys_more_than_it_has_room_for() -> None:
    sold = tours(on_a_line(0, 30, 1, 2, 3, 4), 2, room=2)
    assert sorted(itertools.chain(*sold)) == [0, 1, 2, 3] and [len(tour) for tour in sold] == [2, 2]


def test_a_bid_is_the_time_until_items_are_met() -> None:
    """Two foragers stand together, 10 from two items that are 3 apart: each takes one."""
    at = np.array([(0.0, 0.0), (0.0, 0.0), (10.0, 0.0), (10.0, 3.0)])
    ways = np.hypot(*(at[:, None] - at[None, :]).T)
    assert tours(ways, 2) == [[0], [1]]


def test_a_tour_is_of_the_cheapest_insertions() -> None:
    """Every sale adds least to the sum of the times of arrival, all places tried one by one."""
    rng = np.random.default_rng(0)
    at = rng.random((7, 2))
    ways = np.hypot(*(at[:, None] - at[None, :]).T)
    (tour,) = tours(ways, 1)

    def waiting(path: list[int]) -> float:
        stops = [0, *(1 + lot for lot in path)]
        return float(np.cumsum([ways[a, b] for a, b in itertools.pairwise(stops)]).sum())

    path: list[int] = []
    while len(path) < 6:
        tried = [
            [*path[:i], lot, *path[i:]]
            for lot in range(6)
            if lot not in path
            for i in range(len(path) + 1)
        ]
        path = min(tried, key=waiting)
    assert tour == path


def test_a_scout_takes_the_nearer_of_two_frontiers() -> None:
    graph = lake(9, 41)
    task = task_of(graph, scouts=scouts())
    last_seen = np.full(len(graph), np.iinfo(np.int16).min)
    last_seen[(graph.cols > 4) & (graph.cols < 36)] = 9
    for col, end in ((12, 0), (28, 40)):
        seen = observation_of(task, [(4, col)], last_seen=last_seen, step=10)
        assert abs(after(task, seen, 3)[0][1] - end) < abs(col - end) - 3


def test_foragers_without_items_go_where_scouts_look() -> None:
    graph = lake(9, 41)
    task = task_of(graph, scouts=scouts(), foragers=foragers())
    last_seen = np.full(len(graph), 9, np.int16)
    last_seen[graph.cols > 30] = np.iinfo(np.int16).min
    seen = observation_of(task, [(4, 22), (4, 10)], last_seen=last_seen, step=10)
    assert after(task, seen, 5)[1][1] >= 14


def test_water_near_known_items_is_looked_at_again_sooner() -> None:
    """Everything was last seen at once; an item is known at the west end alone."""
    graph = lake(9, 41)
    task = task_of(graph, scouts=scouts())
    last_seen = np.full(len(graph), 1, np.int16)
    seen = observation_of(task, [(4, 20)], {(4, 5): 1}, last_seen, step=25)
    assert after(task, seen, 4)[0][1] <= 16
