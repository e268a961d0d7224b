"""Uniformly random legal moves."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.randomness import Stream, UInt64Array, fill_bits, stream_key, to_uniform
from mjforage.graph_planner.policies.registry import register
from mjforage.mission.plain import Plain
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
class RandomPolicy:
    """Every legal move is equally likely, staying included where it is legal."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._plain = Plain(task, keys.size)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))
        self._draw = BoundKernel(_draw, self._preferences)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Independent uniform preferences (episode, agent, 9)."""
        self._draw(self._plain(observation))
        return self._preferences
