"""Going to known items by shortest paths: what the baselines' foragers have in common."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import DIAGONAL, FAR, Int32Array, Workspace, distances_to_nearest
from graph_planner.moves import free_move, move_length
from graph_planner.navigation import STAY
from graph_planner.randomness import Stream, stream_key, uniform
from graph_planner.task import Ground, Observation, Task

NO_TOKEN = -1
TIE = 1e-7  # breaks ties at random: far below any real difference, far above rounding


@kernel
def possible_targets(ground: Ground, agent_node: Int32Array, targets: Int32Array) -> None:
    """Where each move of each agent would end, -1 where illegal.

    Parameters
    ----------
    agent_node : (agent,) of one episode
    targets : (agent, 9) filled; other agents' choices are not looked at
    """
    nobody = np.empty(0, np.int64)
    for a in range(agent_node.size):
        for move in range(9):
            end, _ = free_move(
                ground.neighbours,
                nobody,
                NO_TOKEN,
                agent_node[a],
                move,
                ground.moves[a],
                ground.stay,
                ground.shorten,
            )
            targets[a, move] = end


@kernel
def longest_move(ground: Ground) -> float:
    """Length of the longest move of any agent [node]."""
    return DIAGONAL * ground.moves.max() if ground.moves.size else 0.0


@kernel
def _seek(
    seen: Observation, ground: Ground, workspace: Workspace, preferences: NDArray[np.float64]
) -> None:
    n_agents = seen.agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    nearest = np.empty((n_agents, 9))
    for e in range(seen.active.size):
        if not seen.active[e] or seen.n_known[e] == 0:
            continue
        possible_targets(ground, seen.agent_node[e], targets)
        for a in range(n_agents):
            if not ground.collects[a]:
                targets[a] = -1
        distances_to_nearest(
            ground.neighbours,
            ground.distances,
            seen.known[e, : seen.n_known[e]],
            seen.agent_node[e],
            targets,
            longest_move(ground),
            workspace,
            nearest,
        )
        key = stream_key(seen.keys[e], Stream.POLICY)
        for a in range(n_agents):
            if not ground.collects[a]:
                continue
            for move in range(9):
                preferences[e, a, move] = -np.inf
                if targets[a, move] >= 0 and nearest[a, move] < FAR:
                    cost = 1.0 if move == STAY else move_length(move, ground.moves[a])
                    tie = TIE * uniform(key, n_agents * (move + 2) + a, seen.step[e])
                    preferences[e, a, move] = tie - cost - nearest[a, move]


class ItemSeeker:
    """Preferences that take foragers to the nearest known item by a shortest path."""

    def __init__(self, task: Task) -> None:
        self._ground = task.ground
        self._workspace = Workspace.of(len(task.graph))

    def guide(self, observation: Observation, preferences: NDArray[np.float64]) -> None:
        """Overwrite the foragers' rows of preferences (episode, agent, 9) where items are known."""
        _seek(observation, self._ground, self._workspace, preferences)
