"""Uniformly random legal moves."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, fill_bits, stream_key, to_uniform
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.mission.task import Observation, Task


@kernel
def _draw(preferences: NDArray[np.float64], seen: Observation) -> None:
    """Fill preferences with uniform draws."""
    active, keys, step = seen.active, seen.keys, seen.step
    agents = preferences.shape[1]
    draws = np.empty(9 * agents, np.uint64)
    for e in range(active.size):
        if active[e]:
            fill_bits(stream_key(keys[e], Stream.POLICY), step[e], draws.size, draws)
            for a in range(agents):
                for move in range(9):
                    preferences[e, a, move] = to_uniform(draws[9 * a + move])


@register("random")
class RandomPolicy(KernelPolicy):
    """Every legal move is equally likely, staying included where it is legal."""

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """Independent uniform draws."""
        return BoundKernel(_draw, preferences)
