"""Planners of any fleet on small maps, by hand, and options that are refused."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.graph_planner.graph.navigation import STAY, NavigationGraph, navigation_graph
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.moves import MoveRules
from mjforage.mission.policy import Policy
from mjforage.mission.task import NEVER, Observation, Task
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, preferences, task_of

SW, W, NW = 5, 6, 7
WEST = {SW, W, NW}
Cell = tuple[int, int]


def foragers(count: int = 1, capacity: int = 0, energy: float = 0.0) -> Role:
    return Role(count, 1, 1.0, True, capacity=capacity, energy=energy)


def scouts(count: int = 1) -> Role:
    return Role(count, 2, 4.0, False)


def lake(rows: int, cols: int) -> NavigationGraph:
    return navigation_graph(np.ones((rows, cols), np.bool_), 1.0, False)


def all_seen(graph: NavigationGraph, step: int = 0) -> NDArray[np.int16]:
    return np.full(len(graph), step, np.int16)


def chosen(name: str, task: Task, seen: Observation) -> list[int]:
    """The move that each agent of the first row prefers."""
    return [int(move) for move in preferences(name, task, seen)[0].argmax(axis=1)]


def walked(policy: Policy, task: Task, seen: Observation, steps: int) -> list[Cell]:
    """Nodes of the agents of one row after some decisions in which nothing new is seen."""
    graph = task.graph
    for _ in range(steps):
        for agent, move in enumerate(policy.act(seen)[0].argmax(axis=1)):
            table = task.arrays.targets[task.arrays.stride_number[agent]]
            seen.agent_node[0, agent] = table[seen.agent_node[0, agent], move]
        seen.step[:] += 1
        seen.agent_seen[:] += 1
    return [(int(graph.rows[v]), int(graph.cols[v])) for v in seen.agent_node[0]]


def after(name: str, task: Task, seen: Observation, steps: int) -> list[Cell]:
    policy = create_policy(name)
    policy.reset(task, seen.keys)
    return walked(policy, task, seen, steps)


@pytest.mark.parametrize("name", ["auction", "belief", "oracle"])
def test_a_full_forager_and_one_out_of_energy_stay_and_leave_items_to_others(name: str) -> None:
    task = task_of(lake(5, 21), foragers=foragers(2, capacity=2, energy=50.0))
    for spent in ("room_left", "energy_left"):
        seen = observation_of(task, [(2, 5), (2, 15)], {(2, 4): 1}, all_seen(task.graph))
        assert chosen(name, task, seen)[0] in WEST
        getattr(seen, spent)[0, 0] = 0
        stays, goes = chosen(name, task, seen)
        assert stays == STAY and goes in WEST


def test_scouts_split_over_unseen_water() -> None:
    graph = lake(9, 41)
    task = task_of(graph, scouts=scouts(2))
    last_seen = np.full(len(graph), NEVER)
    last_seen[(graph.cols > 10) & (graph.cols < 30)] = 9
    seen = observation_of(task, [(4, 20), (4, 20)], last_seen=last_seen, step=10)
    columns = sorted(col for _, col in after("auction", task, seen, 4))
    assert columns[0] <= 14 and columns[1] >= 26


def test_a_fleet_without_scouts_looks_for_itself() -> None:
    graph = lake(9, 41)
    task = task_of(graph, foragers=foragers(capacity=1))
    last_seen = np.full(len(graph), 9, np.int16)
    last_seen[graph.cols > 30] = NEVER
    seen = observation_of(task, [(4, 20)], last_seen=last_seen, step=10)
    assert after("auction", task, seen, 5)[0][1] >= 24
    seen = observation_of(task, [(4, 20)], last_seen=last_seen, step=10)
    seen.room_left[:] = 0
    assert after("auction", task, seen, 5) == [(4, 20)], "who is full has nothing to look for"


@pytest.mark.parametrize(
    "name", ["auction", "belief(fast=true)", "dec-mcts(rounds=2, simulations=8)"]
)
@pytest.mark.parametrize("rules", [MoveRules(False, False), MoveRules(True, True)])
@pytest.mark.parametrize("teams", [(0, 0), (1, 0), (0, 3), (5, 2), (16, 16)])
def test_any_fleet_on_any_map(
    ragged_coast: NavigationGraph, name: str, rules: MoveRules, teams: tuple[int, int]
) -> None:
    rng = np.random.default_rng(2)
    task = task_of(ragged_coast, rules, scouts=scouts(teams[0]), foragers=foragers(teams[1]))
    nodes = rng.choice(len(ragged_coast), sum(teams) + 90, replace=False)
    cells = [(int(ragged_coast.rows[v]), int(ragged_coast.cols[v])) for v in nodes]
    known = dict.fromkeys(cells[sum(teams) :], 1)
    for items in ({}, known):
        seen = observation_of(task, cells[: sum(teams)], items, all_seen(ragged_coast), episodes=2)
        got = preferences(name, task, seen)
        assert got.shape == (2, sum(teams), 9) and not np.isnan(got).any()
        arrays = task.arrays
        can = (arrays.targets[arrays.stride_number, seen.agent_node] >= 0).any(axis=2)
        assert (np.isfinite(got).any(axis=2) == can).all()


@pytest.mark.parametrize(
    ("reference", "words"),
    [
        ("auction(lots=0)", "lots 0 is too small; give 1 or more"),
        ("auction(patience=inf)", "patience inf is not finite; give 1 or more"),
        ("auction(warm=-1)", "warm -1.0 is too small; give 0 or more"),
        ("dec-mcts(rounds=0)", "dec-mcts: rounds 0 is too small; give 1 or more"),
        ("dec-mcts(discount=1)", "discount 1.0 is too large; give less than 1"),
        ("dec-mcts(forget=1.5)", "forget 1.5 is no share; give above 0 to 1"),
        ("dec-mcts(explore=-1)", "explore -1.0 is too small; give 0 or more"),
        ("dec-mcts(trust=inf)", "trust inf is not finite; give more than 0"),
    ],
)
def test_options_that_do_not_fit_are_refused(reference: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        create_policy(reference)
