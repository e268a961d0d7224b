"""Observations made by hand, to look at one decision of a policy."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.belief_planner.missed_detections import missed_detections
from mjforage.graph_planner.belief_planner.reconciling import Doubts
from mjforage.graph_planner.belief_planner.stops import Floating
from mjforage.graph_planner.graph.navigation import NavigationGraph
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.moves import MoveRules
from mjforage.mission.policy import UpperBound
from mjforage.mission.task import NEVER, GroundTruth, Observation, Task, no_delayed_scans
from mjforage.scenario.roles import Fleet, Role

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
        energy_left=np.tile(task.fleet.energy, (episodes, 1)),
        room_left=np.tile(task.fleet.capacity, (episodes, 1)),
        belief=belief,
        last_seen=np.tile(seen, (episodes, 1)),
        known=listed,
        n_known=np.full(episodes, len(known or {}), np.int32),
        agent_seen=np.full(nodes.shape, step - 1, np.int32),
        taken=np.zeros(nodes.shape, np.int64),
        pickup=np.zeros(nodes.shape, np.int8),
        agent_yaw=np.zeros(nodes.shape),
        **{f"delayed_{name}": part for name, part in no_delayed_scans(episodes)._asdict().items()},
        owner=np.full(episodes, -1, np.int32),
    )


def float_item(items: Floating, row: float, col: float, weight: float) -> None:
    """Add an item."""
    n = items.number[0]
    items.row[n], items.col[n], items.weight[n] = row, col, weight
    items.number[0] = n + 1


def no_doubts(nodes: int) -> Doubts:
    """Views show all that is in view, and nothing else."""
    return Doubts(missed_detections(1, nodes, 0, np.ones(1)), 0.0, np.zeros(nodes), 0.0)


def truth_of(task: Task, observation: Observation) -> GroundTruth:
    """A truth in which one item lies in the middle of every node that is known to hold some."""
    count = int(observation.n_known[0])
    node = observation.known[:, :count].astype(np.int32)
    places = np.stack((task.graph.rows[node], task.graph.cols[node]), axis=-1).astype(np.float64)
    return GroundTruth(places, node, np.zeros((node.shape[0], 2)), np.zeros_like(places))


def preferences(name: str, task: Task, observation: Observation) -> NDArray[np.float64]:
    """Preferences of a fresh policy."""
    policy = create_policy(name)
    policy.reset(task, observation.keys)
    if isinstance(policy, UpperBound):
        policy.set_ground_truth(truth_of(task, observation))
    return policy.act(observation).copy()
