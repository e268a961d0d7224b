"""The four baselines of the paper of 2025, sentence by sentence, on maps with known answers."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from mjforage.graph_planner.graph.navigation import OFFSETS, NavigationGraph, navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.lawnmower_2025 import Lawnmower2025Policy
from mjforage.graph_planner.policies.walk_2025 import Walk2025Policy
from mjforage.mission.moves import FINAL, MoveRules
from mjforage.mission.task import NEVER, Observation, Task
from mjforage.scenario.roles import Role
from tests.graph_planner.charts import grid
from tests.graph_planner.driver import observation_of, preferences, task_of

N, NE, E, SE, S, SW, W, NW = range(8)
JUMP = MoveRules(stay=False, shorten=False, jump=True)
Cell = tuple[int, int]


def scouts(count: int = 1, moves: int = 2, radius: float = 4.0) -> Role:
    return Role(count, moves, radius, False)


def foragers(count: int = 1) -> Role:
    return Role(count, 1, 1.0, True)


def water(rows: int, cols: int) -> NavigationGraph:
    return navigation_graph(np.ones((rows, cols), np.bool_), 1.0, True)


def chosen(name: str, task: Task, seen: Observation) -> NDArray[np.int64]:
    """(episode, agent) the final moves."""
    found = preferences(name, task, seen)
    assert ((found >= FINAL).sum(axis=2) == 1).all()
    moves: NDArray[np.int64] = found.argmax(axis=2)
    return moves


def seen_all(task: Task, step: int = 0) -> NDArray[np.int16]:
    return np.full(len(task.graph), step, np.int16)


# greedy-2025


def greedy_scores(task: Task, seen: Observation, agent: int) -> NDArray[np.float64]:
    """(move,) scores straight from the sentences, -inf where the end is no node."""
    graph, role_moves = task.graph, int(task.fleet.moves[agent])
    at, known = seen.agent_node[0, agent], seen.known[0, : seen.n_known[0]]
    fresh = seen.last_seen[0] == NEVER
    weight = 1.0 if (~fresh).mean() > 0.8 else 2.0
    scores = np.full(8, -np.inf)
    for move in range(8):
        row, col = (graph.rows[at], graph.cols[at]) + role_moves * OFFSETS[move]
        if not (0 <= row < graph.shape[0] and 0 <= col < graph.shape[1]):
            continue
        if not graph.navigable[row, col]:
            continue
        away = np.hypot(graph.rows - row, graph.cols - col)
        score = -away[known].min(initial=np.inf) if known.size else 0.0
        if task.fleet.collects[agent]:
            score += 50 * seen.belief[0, graph.node_of_cell[row, col]]
        else:
            score += weight * (fresh & (away <= task.fleet.radius[agent])).sum()
        scores[move] = score
    return scores


@pytest.mark.parametrize("share", [0.3, 0.79, 0.82, 1.0])
@pytest.mark.parametrize("items", [0, 1, 9])
def test_greedy_takes_the_largest_score(
    ragged_coast: NavigationGraph, share: float, items: int
) -> None:
    """Of all moves, in 40 situations: distances across land, the disc through it, the 80 % rule."""
    graph, rng = ragged_coast, np.random.default_rng(items)
    for role in (scouts(), foragers()):
        task = task_of(graph, JUMP, team=role)
        for _ in range(20):
            nodes = rng.choice(len(graph), 1 + items, replace=False)
            near = graph.neighbours[nodes[0]]
            if items > 1:
                nodes[1:3] = near[near >= 0][:2]
            cells = [(int(graph.rows[v]), int(graph.cols[v])) for v in nodes]
            last_seen = np.full(len(graph), NEVER, np.int16)
            last_seen[rng.permutation(len(graph))[: round(share * len(graph))]] = 0
            known = {cell: int(rng.integers(1, 4)) for cell in cells[1:]}
            seen = observation_of(task, cells[:1], known, last_seen)
            scores = greedy_scores(task, seen, 0)
            move = chosen("greedy-2025", task, seen)[0, 0]
            assert scores[move] == pytest.approx(scores.max(), abs=1e-9)


def test_greedy_counts_a_new_node_twice_until_more_than_80_percent_were_seen() -> None:
    """Two nodes west the item is nearer by 4, two nodes east are 2 new nodes: as good while 16 of
    20 were seen, less at 17."""
    task = task_of(water(1, 20), JUMP, scouts=scouts(1, 2, 1.0))
    for far, share in (((18, 19), 0.5), ((19,), 0.0)):
        last_seen = seen_all(task)
        last_seen[[12, 13, *far]] = NEVER
        seen = observation_of(task, [(0, 10)], {(0, 4): 1}, last_seen, 9, 400)
        moves = chosen("greedy-2025", task, seen)
        assert (moves == E).mean() == pytest.approx(share, abs=0.1)
        assert np.isin(moves, (E, W)).all()


def test_greedy_lets_the_highest_number_choose_first_and_closes_its_end_node() -> None:
    """All want (2, 2): the last forager gets it, the other (1, 1); the scout, which chooses after
    them, ends at (0, 2), nearest to (1, 1)."""
    task = task_of(water(5, 9), JUMP, scouts=scouts(1, 2, 1.0), foragers=foragers(2))
    known = {(2, 2): 2, (1, 1): 1}
    seen = observation_of(task, [(2, 4), (2, 1), (2, 1)], known, seen_all(task))
    assert chosen("greedy-2025", task, seen)[0].tolist() == [NW, N, E]


def test_greedy_breaks_ties_at_random() -> None:
    task = task_of(water(7, 12), JUMP, foragers=foragers(2))
    apart = [(3, 3), (3, 8)]
    moves = chosen("greedy-2025", task, observation_of(task, apart, episodes=800))
    for agent in (0, 1):
        assert stats.chisquare(np.bincount(moves[:, agent], minlength=8)).pvalue > 0.001
    assert (moves[:, 0] == moves[:, 1]).mean() == pytest.approx(1 / 8, abs=0.05)
    two = observation_of(task, apart, {(2, 3): 1, (4, 3): 1}, episodes=800)
    north = int((chosen("greedy-2025", task, two)[:, 0] == N).sum())
    assert stats.binomtest(north, 800).pvalue > 0.001


def test_greedy_without_a_free_end_node_moves_at_random() -> None:
    """Onto land too, where it stays and closes its node, and onto the end node of another."""
    pair = navigation_graph(grid("..", "##"), 1.0, True)
    task = task_of(pair, JUMP, foragers=foragers(3))
    seen = observation_of(task, [(0, 1), (0, 0), (0, 0)], episodes=1600)
    first, second, third = chosen("greedy-2025", task, seen).T
    assert (third == E).all()
    assert stats.chisquare(np.bincount(second, minlength=8)).pvalue > 0.001
    assert (first[second == E] == W).all()
    assert stats.chisquare(np.bincount(first[second != E], minlength=8)).pvalue > 0.001


# lawnmower-2025 and walk-2025


def walked(
    policy: Lawnmower2025Policy | Walk2025Policy, task: Task, seen: Observation, steps: int
) -> list[list[Cell]]:
    """Cells of every agent of the first row after each of some decisions."""
    graph, cells = task.graph, []
    for _ in range(steps):
        for agent, move in enumerate(policy.act(seen)[0].argmax(axis=1)):
            table = task.arrays.targets[task.arrays.stride_number[agent]]
            end = table[seen.agent_node[0, agent], move]
            seen.agent_node[0, agent] = end if end >= 0 else seen.agent_node[0, agent]
        seen.step[:] += 1
        cells.append([(int(graph.rows[v]), int(graph.cols[v])) for v in seen.agent_node[0]])
    return cells


def mown(rows: list[str], start: Cell, forward: int, steps: int) -> list[Cell]:
    task = task_of(navigation_graph(grid(*rows), 1.0, True), JUMP, foragers=foragers())
    seen = observation_of(task, [start], {(0, 0): 9})
    policy = create_policy("lawnmower-2025")
    assert isinstance(policy, Lawnmower2025Policy)
    policy.reset(task, seen.keys)
    policy.mower.forward[:] = forward
    return [one for (one,) in walked(policy, task, seen, steps)]


def test_the_lawnmower_goes_forward_aside_back_and_aside() -> None:
    """North, two to the east, south, two to the same side, north again, and one where land is."""
    path = mown(["......"] * 3, (1, 0), N, 11)
    assert path == [
        *((0, 0), (0, 1), (0, 2), (1, 2), (2, 2)),
        *((2, 3), (2, 4), (1, 4), (0, 4), (0, 5), (1, 5)),
    ]


def test_the_lawnmower_backs_out_until_its_side_is_free() -> None:
    """North into a dead end at (0, 0); the side is land there and at (1, 0), and free at (2, 0)."""
    path = mown([".##", ".##", "...", "..."], (3, 0), N, 8)
    assert path == [(2, 0), (1, 0), (0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (3, 2)]


def test_a_blocked_choice_makes_the_side_the_forward_direction_and_is_tried_at_once() -> None:
    """At (0, 1) north, east and the way out, south, are blocked: east becomes forward, blocked too,
    and the agent stays. Then south is its side: out is west, and at the end of it south is tried.
    """
    assert mown(["..", "##"], (0, 1), N, 3) == [(0, 1), (0, 0), (0, 0)]


def test_the_count_of_side_moves_is_kept_unless_a_lane_follows() -> None:
    """Two to the east, and no way back at (0, 2): east becomes forward, with two moves counted. Its
    sideways leg is one move then, and the next, after a lane, two again."""
    assert mown(["......", "..#...", "......", "......"], (0, 0), N, 10) == [
        *((0, 1), (0, 2), (0, 3), (0, 4), (0, 5)),
        *((1, 5), (1, 4), (1, 3), (2, 3), (3, 3)),
    ]


@pytest.mark.parametrize("name", ["lawnmower-2025", "walk-2025"])
def test_they_draw_their_directions_and_share_nodes(name: str) -> None:
    task = task_of(water(5, 5), JUMP, foragers=foragers(2))
    seen = observation_of(task, [(2, 2), (2, 2)], episodes=800)
    moves = chosen(name, task, seen)
    assert stats.chisquare(np.bincount(moves.ravel(), minlength=8)).pvalue > 0.001
    assert 0.05 < (moves[:, 0] == moves[:, 1]).mean() < 0.25


def test_a_walk_goes_on_until_it_is_blocked_and_never_straight_back() -> None:
    task = task_of(water(6, 6), JUMP, 400, foragers=foragers())
    seen = observation_of(task, [(0, 0)], {(0, 0): 3})
    policy = create_policy("walk-2025")
    assert isinstance(policy, Walk2025Policy)
    policy.reset(task, seen.keys)
    path = [(0, 0), *(cell for (cell,) in walked(policy, task, seen, 300))]
    steps = np.diff(np.array(path), axis=0)
    assert (np.abs(steps).max(axis=1) == 1).all()
    for at, before, after in zip(path[1:], steps, steps[1:], strict=False):
        onward = np.array(at) + before
        blocked = ((onward < 0) | (onward > 5)).any()
        assert (after == before).all() != blocked
        assert not (after == -before).all()


def test_a_walk_with_no_way_but_back_takes_any_of_eight() -> None:
    """It goes east to the end of a row of two nodes, in which it may also stay and turn back."""
    task = task_of(navigation_graph(grid(".."), 1.0, True), JUMP, foragers=foragers())
    first = observation_of(task, [(0, 0)], episodes=800)
    policy = create_policy("walk-2025")
    policy.reset(task, first.keys)
    assert (policy.act(first)[:, 0].argmax(axis=1) == E).all()
    there = observation_of(task, [(0, 1)], step=2, episodes=800)
    moves = policy.act(there)[:, 0].argmax(axis=1)
    assert stats.chisquare(np.bincount(moves, minlength=8)).pvalue > 0.001
