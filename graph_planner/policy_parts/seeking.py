"""Going to known items by shortest paths: what the baselines' foragers have in common."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import (
    DIAGONAL,
    FAR,
    Int32Array,
    Workspace,
    distances_to_nearest,
)
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.moves import move_length
from mjforage.mission.task import Observation, Task, TaskArrays

TIE = 1e-7  # breaks ties at random: far below any real difference, far above rounding


@kernel
def possible_targets(arrays: TaskArrays, agent_node: Int32Array, targets: Int32Array) -> None:
    """Ends of each move of each agent, -1 where illegal.

    Parameters
    ----------
    agent_node : (agent,) of one episode
    targets : (agent, 9) filled; other agents' choices are not looked at
    """
    table, stride_number = arrays.targets, arrays.stride_number
    for a in range(agent_node.size):
        for move in range(9):
            targets[a, move] = table[stride_number[a], agent_node[a], move]


@kernel
def longest_move(arrays: TaskArrays) -> float:
    """Largest geodesic distance that a move of any agent covers [node]; infinite across land."""
    if arrays.jump:
        return np.inf
    most = 0
    for moves in arrays.moves:
        most = max(most, moves)
    return DIAGONAL * most


@kernel
def _seek(
    arrays: TaskArrays, workspace: Workspace, seen: Observation, preferences: NDArray[np.float64]
) -> None:
    """Fill the preferences of collectors, in episodes in which an item is known."""
    active, step, keys, agent_node = seen.active, seen.step, seen.keys, seen.agent_node
    known, n_known = seen.known, seen.n_known
    neighbours, distances = arrays.neighbours, arrays.distances
    moves, collects = arrays.moves, arrays.collects
    n_agents, slack = agent_node.shape[1], longest_move(arrays)
    targets = np.empty((n_agents, 9), np.int32)
    nearest = np.empty((n_agents, 9))
    for e in range(active.size):
        if not active[e] or n_known[e] == 0:
            continue
        possible_targets(arrays, agent_node[e], targets)
        for a in range(n_agents):
            if not collects[a]:
                targets[a] = -1
        items = known[e, : n_known[e]]
        distances_to_nearest(
            neighbours, distances, items, agent_node[e], targets, slack, workspace, nearest
        )
        key = stream_key(keys[e], Stream.POLICY)
        for a in range(n_agents):
            if not collects[a]:
                continue
            for move in range(9):
                preferences[e, a, move] = -np.inf
                if targets[a, move] >= 0 and nearest[a, move] < FAR:
                    cost = 1.0 if move == STAY else move_length(move, moves[a])
                    tie = TIE * uniform(key, n_agents * (move + 2) + a, step[e])
                    preferences[e, a, move] = tie - cost - nearest[a, move]


class ItemSeeker:
    """Preferences that take foragers to the nearest known item by a shortest path."""

    def __init__(self, task: Task) -> None:
        self._seek = BoundKernel(_seek, task.arrays, Workspace.of(len(task.graph)))

    def guide(self, observation: Observation, preferences: NDArray[np.float64]) -> None:
        """Overwrite the foragers' rows of preferences (episode, agent, 9) where items are known."""
        self._seek(observation, preferences)
