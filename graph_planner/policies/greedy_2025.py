"""Greedy of the group's paper of 2025 (IEEE RA-L 10(5):4930, preprint arXiv 2412.02316).

The agents choose one after the other; end nodes that are taken are closed to the next. Score of a
move: minus the Euclidean distance from its end node to the nearest believed item (0 if none is
believed); foragers + 50 x believed items there; scouts + 2 x nodes never seen in the disc around
it, 1 x once more than 80 % of the nodes were seen. Ties at random; without a free end node any move
at random.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, UInt64Array, fill_bits, stream_key, to_uniform
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.final_moves import (
    FARTHEST,
    is_taken,
    make_final,
    squared_distance,
)
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.plain import Plain
from mjforage.mission.task import NEVER, Observation, Task, TaskArrays

PER_ITEM, PER_NEW_NODE, PER_NEW_NODE_LATE = 50.0, 2.0, 1.0
LATE = 0.8
"""Share of the nodes seen, above which a new one counts less."""


@kernel
def _score(
    arrays: TaskArrays,
    discs: NodeLists,
    seen: Observation,
    e: int,
    agent: int,
    end: int,
    new: float,
) -> float:
    """Score of a move of an agent that ends in a node; `new` of a node never seen."""
    belief, last_seen, score = seen.belief, seen.last_seen, 0.0
    if seen.n_known[e] > 0:
        nearest = FARTHEST
        for item in seen.known[e, : seen.n_known[e]]:
            nearest = min(nearest, squared_distance(arrays.rows, arrays.cols, end, item))
        score -= math.sqrt(nearest)
    if arrays.collects[agent]:
        return score + PER_ITEM * float(belief[e, end])
    radius, start, nodes, count = arrays.radius_number[agent], discs.start, discs.nodes, 0
    for i in range(start[radius, end], start[radius, end + 1]):
        count += last_seen[e, np.uint64(nodes[np.uint64(i)])] == NEVER
    return score + new * count


@kernel
def _choose(
    arrays: TaskArrays,
    order: NDArray[np.int64],
    discs: NodeLists,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Choose for all agents of every episode, one after the other; fill preferences."""
    n_agents, n_nodes = seen.agent_node.shape[1], seen.belief.shape[1]
    targets, ends = np.empty((n_agents, 9), np.int32), np.empty(n_agents, np.int32)
    draws = np.empty(9 * n_agents, np.uint64)
    for e in range(seen.active.size):
        if not seen.active[e]:
            continue
        fill_bits(stream_key(seen.keys[e], Stream.POLICY), seen.step[e], draws.size, draws)
        possible_targets(arrays, seen.agent_node[e], targets)
        known_nodes = 0
        for node in range(n_nodes):
            known_nodes += seen.last_seen[e, node] != NEVER
        new = PER_NEW_NODE_LATE if known_nodes > LATE * n_nodes else PER_NEW_NODE
        for chosen, a in enumerate(order):
            best, largest, lot = -1, -np.inf, np.uint64(0)
            for move in range(8):
                end = targets[a, move]
                if end < 0 or is_taken(ends, chosen, end):
                    continue
                score = _score(arrays, discs, seen, e, a, end, new)
                if score > largest or (score == largest and draws[9 * a + move] > lot):
                    best, largest, lot = move, score, draws[9 * a + move]
            if best < 0:
                best = int(8 * to_uniform(draws[9 * a + 8]))
            end = targets[a, best]
            ends[chosen] = end if end >= 0 else seen.agent_node[e, a]
            make_final(preferences[e, a], best)


@register("greedy-2025")
class Greedy2025Policy:
    """Greedy of the paper of 2025: nearest item, items at the end node, nodes never seen."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._plain = Plain(task, keys.size)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))
        about = task.fleet.order, task.graph.discs(task.view_radii), self._preferences
        self._choose = BoundKernel(_choose, task.arrays, *about)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): the chosen move."""
        self._choose(self._plain(observation))
        return self._preferences
