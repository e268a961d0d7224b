"""The policy dec-mcts, by hand on small maps."""

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.dec_mcts.search import DecisionContext
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, preferences, task_of

N, NE, E, SE, S, SW, W, NW = range(8)


def foragers(count: int, capacity: int = 0) -> Role:
    return Role(count, 1, 1.0, True, capacity=capacity)


def lake(rows: int, cols: int) -> NavigationGraph:
    return navigation_graph(np.ones((rows, cols), np.bool_), 1.0, False)


def just_seen(nodes: int, step: int) -> NDArray[np.int16]:
    """When the nodes of a map were last seen, if all are in view: nothing is left unseen."""
    return np.full(nodes, step - 1, np.int16)


def test_foragers_share_out_what_is_known() -> None:
    task = task_of(lake(1, 11), foragers=foragers(2))
    seen = observation_of(task, [(0, 5), (0, 4)], {(0, 1): 1, (0, 9): 1}, just_seen(11, 5), 5)
    moves = preferences("dec-mcts", task, seen)[0].argmax(axis=1)
    assert moves.tolist() == [E, W]


def test_who_was_not_heard_of_for_long_is_not_left_the_items() -> None:
    task = task_of(lake(1, 21), scouts=Role(1, 2, 4.0, False), foragers=foragers(2))
    at, items = [(0, 0), (0, 10), (0, 14)], {(0, 7): 1, (0, 16): 3}
    seen = observation_of(task, at, items, just_seen(21, 90), 90)
    first = preferences("dec-mcts", task, seen)[0].argmax(axis=1)
    seen.agent_seen[0, 2] = 0
    later = preferences("dec-mcts(trust=2)", task, seen)[0].argmax(axis=1)
    assert first[1:].tolist() == [W, E] and later[1] == E


def test_who_was_not_heard_of_for_long_is_not_left_the_unseen() -> None:
    """More of it lies to the east, where the other scout was; alone, a scout goes there itself."""
    graph = lake(1, 41)
    task = task_of(graph, scouts=Role(2, 1, 2.0, False), foragers=foragers(1))
    last_seen = np.where((graph.cols < 12) | (graph.cols > 26), 0, 89).astype(np.int16)
    seen = observation_of(task, [(0, 20), (0, 24), (0, 19)], {(0, 19): 1}, last_seen, 90)
    first = preferences("dec-mcts", task, seen)[0, 0].argmax()
    seen.agent_seen[0, 1] = 0
    later = preferences("dec-mcts(trust=2)", task, seen)[0, 0].argmax()
    assert (first, later) == (W, E)


def test_trust_halves() -> None:
    task = task_of(lake(1, 4), foragers=foragers(3))
    seen = observation_of(task, [(0, 0), (0, 1), (0, 2)], step=21)
    seen.agent_seen[0] = 20, 15, 0
    context = DecisionContext(5.0)
    context.is_of(seen, 0)
    np.testing.assert_allclose(context.follows, [1.0, 0.5, 1 / 16])


def test_scouts_look_where_something_is_to_be_seen() -> None:
    graph = lake(3, 40)
    task = task_of(graph, scouts=Role(2, 2, 4.0, False), foragers=foragers(1))
    never = np.int16(-32768)
    last_seen = np.where(graph.cols < 30, 20, never).astype(np.int16)
    cells = [(1, 24), (1, 23), (0, 0)]
    seen = observation_of(task, cells, {(1, 28): 2}, last_seen, step=21)
    moves = preferences("dec-mcts", task, seen)[0].argmax(axis=1)
    assert {E, NE, SE} & set(moves[:2].tolist())
