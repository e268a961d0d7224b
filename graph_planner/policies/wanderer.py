"""Wandering: scouts keep their heading until blocked, foragers take the shortest path to the
nearest known item.

A heading is kept until it is blocked; the new one is uniform over the legal moves except straight
back (definitions, section 3). With nothing known, foragers wander like scouts.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.seeking import ItemSeeker
from mjforage.graph_planner.policy_parts.walking import Walker
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task


@register("wanderer")
class WandererPolicy:
    """Straight on until blocked, never straight back; foragers go to the nearest known item."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._plain = Plain(task, keys.size)
        self._walker = Walker(task, keys.size, levy=False)
        self._seeker = ItemSeeker(task)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9)."""
        observation = self._plain(observation)
        preferences = self._walker.walk(observation)
        self._seeker.guide(observation, preferences)
        return preferences
