"""The paper's Greedy: the move with the largest instant reward, per agent, ties at random.

Reward of a move (published code's weights, scenario section 3): 5.91 x known items in the node
(foragers) + 2.23 x idleness in view (scouts; the sum ignores line of sight) - 1.7 x geodesic
distance to the nearest known item (both teams; 0 on an item and when nothing is known).
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import FAR, Workspace, distances_to_nearest
from graph_planner.policies.registry import register
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.seeking import TIE, longest_move, possible_targets
from graph_planner.task import Ground, Observation, Task
from graph_planner.visibility import NodeLists

ITEM_WEIGHT = 5.91
IDLENESS_WEIGHT = 2.23
DISTANCE_WEIGHT = 1.7


@kernel
def _idleness_around(
    seen: Observation, ground: Ground, discs: NodeLists, episode: int, agent: int, target: int
) -> float:
    """Sum of idleness within the agent's sensing radius of a node."""
    now, radius = seen.step[episode] - 1, ground.radius_number[agent]
    total = 0.0
    for i in range(discs.start[radius, target], discs.start[radius, target + 1]):
        age = now - np.int64(seen.last_seen[episode, discs.nodes[i]])
        total += min(1.0, age * ground.forgetting)
    return total


@kernel
def _rewards(
    seen: Observation,
    ground: Ground,
    discs: NodeLists,
    workspace: Workspace,
    preferences: NDArray[np.float64],
) -> None:
    n_agents = seen.agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    nearest = np.empty((n_agents, 9))
    for e in range(seen.active.size):
        if not seen.active[e]:
            continue
        key = stream_key(seen.keys[e], Stream.POLICY)
        possible_targets(ground, seen.agent_node[e], targets)
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
        for a in range(n_agents):
            for move in range(9):
                target = targets[a, move]
                if target < 0:
                    preferences[e, a, move] = -np.inf
                    continue
                reward = TIE * uniform(key, 9 * a + move, seen.step[e])
                if nearest[a, move] < FAR:
                    reward -= DISTANCE_WEIGHT * nearest[a, move]
                if ground.collects[a]:
                    reward += ITEM_WEIGHT * seen.belief[e, target]
                else:
                    idle = _idleness_around(seen, ground, discs, e, a, target)
                    reward += IDLENESS_WEIGHT * idle
                preferences[e, a, move] = reward


@register("greedy")
class GreedyPolicy:
    """Largest instant reward: known items, idleness in view, distance to the nearest known item."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._ground = task.ground
        self._discs = task.graph.discs(task.view_radii)
        self._workspace = Workspace.of(len(task.graph))
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Instant rewards (episode, agent, 9) of all moves."""
        _rewards(observation, self._ground, self._discs, self._workspace, self._preferences)
        return self._preferences
