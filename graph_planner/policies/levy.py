"""Levy walks: scouts walk, foragers take the shortest path to the nearest known item.

Paper, section "Experimental Study": with nothing known, foragers walk like scouts. Walk lengths
are true Levy lengths (the published code draws them and then never uses them).
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.seeking import ItemSeeker
from mjforage.graph_planner.policy_parts.walking import Walker
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task


@register("levy")
class LevyPolicy:
    """Levy walks; foragers go to the nearest known item."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._plain = Plain(task, keys.size)
        self._walker = Walker(task, keys.size, levy=True)
        self._seeker = ItemSeeker(task)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        observation = self._plain(observation)
        preferences = self._walker.walk(observation)
        self._seeker.guide(observation, preferences)
        return preferences
