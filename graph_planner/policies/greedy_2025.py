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
from mjforage.base.randomness import Stream, fill_bits, stream_key, to_uniform
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.final_moves import is_taken, make_final, squared_to_nearest
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.task import NEVER, Observation, Task, TaskArrays

PER_ITEM, PER_NEW_NODE, PER_NEW_NODE_LATE = 50.0, 2.0, 1.0
LATE = 0.8
"""Share of the nodes seen, above which a new one counts less."""


@kernel
def _choose(
    arrays: TaskArrays,
    order: NDArray[np.int64],
    discs: NodeLists,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Choose for all agents of every episode, one after the other; fill preferences."""
    active, step, keys, agent_node = seen.active, seen.step, seen.keys, seen.agent_node
    belief, last_seen, known, n_known = seen.belief, seen.last_seen, seen.known, seen.n_known
    rows, cols, collects = arrays.rows, arrays.cols, arrays.collects
    start, nodes, radius_number = discs.start, discs.nodes, arrays.radius_number
    n_agents, n_nodes = agent_node.shape[1], belief.shape[1]
    targets, ends = np.empty((n_agents, 9), np.int32), np.empty(n_agents, np.int32)
    draws, squared = np.empty(9 * n_agents, np.uint64), np.empty(9, np.int64)
    for e in range(active.size):
        if not active[e]:
            continue
        fill_bits(stream_key(keys[e], Stream.POLICY), step[e], draws.size, draws)
        possible_targets(arrays, agent_node[e], targets)
        late = (last_seen[e] != NEVER).sum() > LATE * n_nodes
        per_new = PER_NEW_NODE_LATE if late else PER_NEW_NODE
        items = known[e, : n_known[e]]
        for chosen in range(n_agents):
            a = order[chosen]
            squared_to_nearest(rows, cols, items, targets[a], squared)
            best, largest, lot, radius = -1, -np.inf, np.uint64(0), radius_number[a]
            for move in range(8):
                end = targets[a, move]
                if end < 0 or is_taken(ends, chosen, end):
                    continue
                score = -math.sqrt(squared[move]) if items.size else 0.0
                if collects[a]:
                    score += PER_ITEM * belief[e, end]
                else:
                    new = 0
                    for i in range(start[radius, end], start[radius, end + 1]):
                        around = np.uint64(nodes[np.uint64(i)])  # never counted from the end
                        new += last_seen[e, around] == NEVER
                    score += per_new * new
                draw = draws[9 * a + move]
                if score > largest or (score == largest and draw > lot):
                    best, largest, lot = move, score, draw
            if best < 0:
                best = int(8 * to_uniform(draws[9 * a + 8]))
            end = targets[a, best]
            ends[chosen] = end if end >= 0 else agent_node[e, a]
            make_final(preferences[e, a], best)


@register("greedy-2025")
class Greedy2025Policy(KernelPolicy):
    """Greedy of the paper of 2025: nearest item, items at the end node, nodes never seen."""

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """The chosen move."""
        about = task.fleet.order, task.graph.discs(task.view_radii), preferences
        return BoundKernel(_choose, task.arrays, *about)
