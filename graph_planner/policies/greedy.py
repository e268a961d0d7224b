"""The paper's Greedy: the move with the largest instant reward, per agent, ties at random.

Reward of a move (published code's weights, scenario section 3): 5.91 x known items in the node
(foragers) + 2.23 x idleness in view (scouts; the sum ignores line of sight) - 1.7 x geodesic
distance to the nearest known item (both teams; 0 on an item and when nothing is known).
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import DIAGONAL, FAR, Float32Array, Int32Array, distances_to_nearest
from graph_planner.policies.registry import register
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.seeking import possible_targets
from graph_planner.task import Observation, Task

ITEM_WEIGHT = 5.91
IDLENESS_WEIGHT = 2.23
DISTANCE_WEIGHT = 1.7
TIE = 1e-7  # far below any real difference of rewards, far above their rounding


@kernel
def _rewards(
    active: NDArray[np.bool_],
    keys: UInt64Array,
    step: Int32Array,
    agent_node: Int32Array,
    belief: NDArray[np.int16],
    last_seen: NDArray[np.int16],
    known: Int32Array,
    n_known: Int32Array,
    neighbours: Int32Array,
    table: Float32Array,
    disc_start: NDArray[np.int64],
    disc_nodes: Int32Array,
    radius_number: NDArray[np.int64],
    moves: NDArray[np.int64],
    collects: NDArray[np.bool_],
    stay: bool,
    shorten: bool,
    forgetting: float,
    distance: NDArray[np.float64],
    touched: Int32Array,
    preferences: NDArray[np.float64],
) -> None:
    n_agents = agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    nearest = np.empty((n_agents, 9))
    full = np.int64(np.ceil(1.0 / forgetting))
    slack = DIAGONAL * moves.max() if n_agents else 0.0
    for e in range(active.size):
        if not active[e]:
            continue
        key, now = stream_key(keys[e], Stream.POLICY), step[e] - 1
        possible_targets(neighbours, agent_node[e], moves, stay, shorten, targets)
        distances_to_nearest(
            neighbours,
            table,
            known[e, : n_known[e]],
            agent_node[e],
            targets,
            slack,
            distance,
            touched,
            nearest,
        )
        for a in range(n_agents):
            for move in range(9):
                target = targets[a, move]
                if target < 0:
                    preferences[e, a, move] = -np.inf
                    continue
                reward = TIE * uniform(key, 9 * a + move, step[e])
                if nearest[a, move] < FAR:
                    reward -= DISTANCE_WEIGHT * nearest[a, move]
                if collects[a]:
                    reward += ITEM_WEIGHT * belief[e, target]
                else:
                    radius = radius_number[a]
                    unseen_for = 0.0
                    for i in range(disc_start[radius, target], disc_start[radius, target + 1]):
                        age = now - np.int64(last_seen[e, disc_nodes[i]])
                        unseen_for += min(1.0, age * forgetting) if age < full else 1.0
                    reward += IDLENESS_WEIGHT * unseen_for
                preferences[e, a, move] = reward


@register("greedy")
class GreedyPolicy:
    """Largest instant reward: known items, idleness in view, distance to the nearest known item."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._task = task
        self._discs = task.graph.discs(task.view_radii)
        self._radius_number = task.radius_number
        self._distance = np.full(len(task.graph), FAR)
        self._touched = np.empty(len(task.graph), np.int32)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Instant rewards (episode, agent, 9) of all moves."""
        task = self._task
        _rewards(
            observation.active,
            observation.keys,
            observation.step,
            observation.agent_node,
            observation.belief,
            observation.last_seen,
            observation.known,
            observation.n_known,
            task.graph.neighbours,
            task.graph.distances,
            self._discs.start,
            self._discs.nodes,
            self._radius_number,
            task.fleet.moves,
            task.fleet.collects,
            task.rules.stay,
            task.rules.shorten,
            task.forgetting,
            self._distance,
            self._touched,
            self._preferences,
        )
        return self._preferences
