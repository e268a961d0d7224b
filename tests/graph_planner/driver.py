"""Observations made by hand, to look at one decision of a policy."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.fleet import Fleet, Role
from graph_planner.moves import MoveRules
from graph_planner.navigation import NavigationGraph
from graph_planner.policies import create_policy
from graph_planner.randomness import episode_keys
from graph_planner.task import NEVER, Observation, Task

FREE = MoveRules(stay=True, shorten=True)


def task_of(
    graph: NavigationGraph, rules: MoveRules = FREE, horizon: int = 150, **teams: Role
) -> Task:
    return Task(graph, Fleet.of(teams), rules, horizon)


def observation_of(
    task: Task,
    cells: list[tuple[int, int]],
    known: dict[tuple[int, int], int] | None = None,
    last_seen: NDArray[np.int16] | None = None,
    step: int = 1,
    episodes: int = 1,
) -> Observation:
    """One observation, the same in every episode of the batch but for its key."""
    graph, n = task.graph, len(task.graph)
    nodes = np.array([[graph.node_of_cell[rc] for rc in cells]] * episodes, np.int32)
    belief = np.zeros((episodes, n), np.int16)
    listed = np.zeros((episodes, n), np.int32)
    for i, (cell, items) in enumerate((known or {}).items()):
        belief[:, graph.node_of_cell[cell]] = items
        listed[:, i] = graph.node_of_cell[cell]
    seen = np.full(n, NEVER, np.int16) if last_seen is None else last_seen
    return Observation(
        active=np.ones(episodes, np.bool_),
        step=np.full(episodes, step, np.int32),
        keys=episode_keys(0, np.arange(episodes)),
        agent_node=nodes,
        energy_left=np.full(nodes.shape, np.inf),
        belief=belief,
        last_seen=np.tile(seen, (episodes, 1)),
        known=listed,
        n_known=np.full(episodes, len(known or {}), np.int32),
    )


def preferences(name: str, task: Task, observation: Observation) -> NDArray[np.float64]:
    """What a fresh policy prefers."""
    policy = create_policy(name)
    policy.reset(task, observation.keys)
    return policy.act(observation).copy()
