"""Straight walks until a length is used up or the way is blocked: Levy walks and wandering.

Levy walks: paper, section "Experimental Study"; walk lengths are true Levy lengths (the published
code draws them and then never uses them). Wandering: definitions, section 3. With nothing known,
foragers walk like scouts.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, normal, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import possible_targets
from mjforage.mission.task import Observation, Task, TaskArrays

NO_HEADING = -1
NO_LIMIT = 2**31 - 1  # decisions; a walk that only obstacles end
_DRAWS = 16  # numbers one agent may draw per step; keeps the agents' draws apart


@kernel
def levy_length(key: np.uint64, index: int, step: int, cap: int) -> int:
    """A walk's length in decisions: floor of a Levy variate (scale 1), at least 1, at most `cap`.

    The inverse square of a standard normal has the Levy distribution (paper, section "Experimental
    Study"; definitions, section 3).
    """
    z = normal(key, index, step)
    return cap if z * z * cap <= 1.0 else max(1, int(1.0 / (z * z)))


@kernel
def _walk(
    arrays: TaskArrays,
    cap: int,
    heading: NDArray[np.int8],
    left: Int32Array,
    preferences: NDArray[np.float64],
    seen: Observation,
) -> None:
    """Take the next step of every walk, and turn where it ends; fill preferences."""
    active, step, keys, agent_node = seen.active, seen.step, seen.keys, seen.agent_node
    n_agents = agent_node.shape[1]
    targets = np.empty((n_agents, 9), np.int32)
    legal = np.empty(8, np.int64)
    for e in range(active.size):
        if not active[e]:
            continue
        key = stream_key(keys[e], Stream.POLICY)
        possible_targets(arrays, agent_node[e], targets)
        for a in range(n_agents):
            here = heading[e, a]
            back = (here + 4) % 8 if here != NO_HEADING else NO_HEADING
            n_legal, straight_on = 0, False
            for d in range(8):
                if targets[a, d] >= 0:
                    straight_on = straight_on or d == here
                    if d != back:
                        legal[n_legal] = d
                        n_legal += 1
            if left[e, a] <= 0 or not straight_on:
                if n_legal > 0:
                    draw = uniform(key, _DRAWS * a, step[e])
                    heading[e, a] = legal[int(draw * n_legal)]
                elif back != NO_HEADING:
                    heading[e, a] = back
            if left[e, a] <= 0:
                left[e, a] = cap
                if cap < NO_LIMIT:
                    left[e, a] = levy_length(key, _DRAWS * a + 1, step[e], cap)
            left[e, a] -= 1
            for d in range(8):
                tie = uniform(key, _DRAWS * a + 4 + d, step[e])
                preferences[e, a, d] = tie - (d == back)
            preferences[e, a, heading[e, a]] = 2.0
            preferences[e, a, STAY] = -2.0


class Walks(KernelPolicy):
    """Straight walks; turns are uniform over the legal moves except straight back.

    Preference goes to the heading, then to the other moves at random, then back, then to staying.
    Where items are known, foragers go to the nearest one by a shortest path.
    """

    seeks = True

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """On along each walk."""
        agents, longest = preferences.shape[:2], self._longest(task)
        heading, left = np.full(agents, NO_HEADING, np.int8), np.zeros(agents, np.int32)
        return BoundKernel(_walk, task.arrays, longest, heading, left, preferences)

    def _longest(self, task: Task) -> int:
        """Longest walk [decision]."""
        return NO_LIMIT


@register("wanderer")
class WandererPolicy(Walks):
    """Straight on until blocked, never straight back; foragers go to the nearest known item."""


@register("levy")
class LevyPolicy(Walks):
    """Levy walks; foragers go to the nearest known item."""

    def _longest(self, task: Task) -> int:
        return max(1, int(0.8 * max(task.graph.shape)))
