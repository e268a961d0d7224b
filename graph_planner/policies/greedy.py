"""The paper's Greedy: the move with the largest instant reward, per agent, ties at random.

Reward of a move (published code's weights, definitions, section 3): 5.91 x known items in the node
(foragers) + 2.23 x idleness in view (scouts; the sum ignores line of sight) - 1.7 x geodesic
distance to the nearest known item (both teams; 0 on an item and when nothing is known). The three
weights are options: `greedy(distance=0)`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, fill_bits, stream_key, to_uniform
from mjforage.graph_planner.graph.geodesics import FAR, Workspace, distances_to_nearest
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import TIE, longest_move, possible_targets
from mjforage.mission.task import Observation, Task, TaskArrays

_FULL_BITS = 40
_FULL = 1 << _FULL_BITS  # stands for idleness 1 among ages, which never add up to as much


class Weights(NamedTuple):
    """Weights of a move's reward; the defaults are the published ones."""

    item: float = 5.91  # known item in the node
    idleness: float = 2.23  # node of idleness 1 in view
    distance: float = 1.7  # node of distance to the nearest known item, as a cost


@kernel
def _saturation(forgetting: float) -> int:
    """The least age of a node at which its idleness is 1 [step]."""
    age = int(1.0 / forgetting)
    while age * forgetting < 1.0:
        age += 1
    return age


@kernel
def _rewards(
    weights: Weights,
    arrays: TaskArrays,
    discs: NodeLists,
    workspace: Workspace,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Fill the instant rewards of all moves, -inf where illegal."""
    active, step, keys, agent_node = seen.active, seen.step, seen.keys, seen.agent_node
    belief, last_seen, known, n_known = seen.belief, seen.last_seen, seen.known, seen.n_known
    neighbours, distances, collects = arrays.neighbours, arrays.distances, arrays.collects
    radius_number, forgetting = arrays.radius_number, arrays.forgetting
    start, nodes = discs.start, discs.nodes
    per_item, per_idleness, per_distance = weights.item, weights.idleness, weights.distance
    n_agents, slack = agent_node.shape[1], longest_move(arrays)
    saturated = _saturation(forgetting)
    draws = np.empty(9 * n_agents, np.uint64)
    targets = np.empty((n_agents, 9), np.int32)
    nearest = np.empty((n_agents, 9))
    for e in range(active.size):
        if not active[e]:
            continue
        items, now = known[e, : n_known[e]], step[e] - 1
        fill_bits(stream_key(keys[e], Stream.POLICY), step[e], draws.size, draws)
        possible_targets(arrays, agent_node[e], targets)
        distances_to_nearest(
            neighbours, distances, items, agent_node[e], targets, slack, workspace, nearest
        )
        for a in range(n_agents):
            radius = radius_number[a]
            for move in range(9):
                target = targets[a, move]
                if target < 0:
                    preferences[e, a, move] = -np.inf
                    continue
                reward = TIE * to_uniform(draws[9 * a + move])
                if nearest[a, move] < FAR:
                    reward -= per_distance * nearest[a, move]
                if collects[a]:
                    reward += per_item * belief[e, target]
                else:
                    found = 0  # ages [step], or `_FULL` for idleness 1: no order matters to a sum
                    for i in range(start[radius, target], start[radius, target + 1]):
                        around = np.uint64(nodes[np.uint64(i)])  # never counted from the end
                        age = now - np.int64(last_seen[e, around])
                        found += age if age < saturated else _FULL
                    idle = (found & (_FULL - 1)) * forgetting + (found >> _FULL_BITS)
                    reward += per_idleness * idle
                preferences[e, a, move] = reward


@register("greedy")
class GreedyPolicy(KernelPolicy):
    """Largest instant reward: known items, idleness in view, distance to the nearest known item."""

    def __init__(
        self,
        item: float = Weights().item,
        idleness: float = Weights().idleness,
        distance: float = Weights().distance,
    ) -> None:
        self._weights = Weights(item, idleness, distance)

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """Instant rewards of all moves."""
        discs, workspace = task.graph.discs(task.view_radii), Workspace.of(len(task.graph))
        return BoundKernel(_rewards, self._weights, task.arrays, discs, workspace, preferences)
