"""Going to known items by shortest paths: what the baselines' foragers have in common."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import DIAGONAL, FAR, Float32Array, Int32Array, distances_to_nearest
from graph_planner.moves import free_move, move_length
from graph_planner.navigation import STAY
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.task import Observation, Task

NO_TOKEN = -1


@kernel
def possible_targets(
    neighbours: Int32Array,
    agent_node: Int32Array,
    moves: NDArray[np.int64],
    stay: bool,
    shorten: bool,
    targets: Int32Array,
) -> None:
    """Where each move of each agent would end, -1 where illegal: fills (agent, 9)."""
    nobody = np.empty(0, np.int64)
    for a in range(agent_node.size):
        for move in range(9):
            end, _ = free_move(
                neighbours, nobody, NO_TOKEN, agent_node[a], move, moves[a], stay, shorten
            )
            targets[a, move] = end


@kernel
def _seek(
    active: NDArray[np.bool_],
    keys: UInt64Array,
    step: Int32Array,
    agent_node: Int32Array,
    known: Int32Array,
    n_known: Int32Array,
    neighbours: Int32Array,
    table: Float32Array,
    moves: NDArray[np.int64],
    collects: NDArray[np.bool_],
    stay: bool,
    shorten: bool,
    distance: NDArray[np.float64],
    touched: Int32Array,
    preferences: NDArray[np.float64],
) -> None:
    n_agents = agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    nearest = np.empty((n_agents, 9))
    for e in range(active.size):
        if not active[e] or n_known[e] == 0:
            continue
        possible_targets(neighbours, agent_node[e], moves, stay, shorten, targets)
        for a in range(n_agents):
            if not collects[a]:
                targets[a] = -1
        distances_to_nearest(
            neighbours,
            table,
            known[e, : n_known[e]],
            agent_node[e],
            targets,
            DIAGONAL * moves.max(),
            distance,
            touched,
            nearest,
        )
        key = stream_key(keys[e], Stream.POLICY)
        for a in range(n_agents):
            if not collects[a]:
                continue
            for move in range(9):
                preferences[e, a, move] = -np.inf
                if targets[a, move] >= 0 and nearest[a, move] < FAR:
                    cost = 1.0 if move == STAY else move_length(move, moves[a])
                    tie = 1e-7 * uniform(key, n_agents * (move + 2) + a, step[e])
                    preferences[e, a, move] = tie - cost - nearest[a, move]


class ItemSeeker:
    """Preferences that take foragers to the nearest known item by a shortest path."""

    def __init__(self, task: Task) -> None:
        self._task = task
        nodes = len(task.graph)
        self._distance = np.full(nodes, FAR)
        self._touched = np.empty(nodes, np.int32)

    def guide(self, observation: Observation, preferences: NDArray[np.float64]) -> None:
        """Overwrite the foragers' rows of preferences (episode, agent, 9) where items are known."""
        task = self._task
        _seek(
            observation.active,
            observation.keys,
            observation.step,
            observation.agent_node,
            observation.known,
            observation.n_known,
            task.graph.neighbours,
            task.graph.distances,
            task.fleet.moves,
            task.fleet.collects,
            task.rules.stay,
            task.rules.shorten,
            self._distance,
            self._touched,
            preferences,
        )
