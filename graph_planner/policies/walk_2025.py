"""Random walk of the group's paper of 2025 (IEEE RA-L 10(5):4930, preprint arXiv 2412.02316).

Every agent keeps its direction until the end node is no node, then takes another free one at
random, never straight back; where none is free but back, one of all eight. All ignore items.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.final_moves import make_final
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.task import Observation, Task, TaskArrays

UNDRAWN = -1


@kernel
def _walk(
    arrays: TaskArrays,
    heading: NDArray[np.int64],
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Take the next step of every walk; fill preferences."""
    n_agents = seen.agent_node.shape[1]
    targets, free = np.empty((n_agents, 9), np.int32), np.empty(8, np.int64)
    for e in range(seen.active.size):
        if not seen.active[e]:
            continue
        key = stream_key(seen.keys[e], Stream.POLICY)
        possible_targets(arrays, seen.agent_node[e], targets)
        for a in range(n_agents):
            here = heading[e, a]
            if here == UNDRAWN or targets[a, here] < 0:
                count, draw = 0, uniform(key, a, seen.step[e])
                for move in range(8):
                    if targets[a, move] >= 0 and (here == UNDRAWN or move != (here + 4) % 8):
                        free[count] = move
                        count += 1
                heading[e, a] = free[int(draw * count)] if count else int(8 * draw)
            make_final(preferences[e, a], heading[e, a])


@register("walk-2025")
class Walk2025Policy(KernelPolicy):
    """Random walk of the paper of 2025: straight on until blocked, items ignored."""

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """On along each walk."""
        heading = np.full(preferences.shape[:2], UNDRAWN)
        return BoundKernel(_walk, task.arrays, heading, preferences)
