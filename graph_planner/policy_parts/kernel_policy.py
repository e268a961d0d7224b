"""Policies whose preferences one kernel fills."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.policy_parts.seeking import ItemSeeker
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task

Preferences = NDArray[np.float64]  # (episode, agent, 9)


class KernelPolicy:
    """Base of such policies: a subclass has its kernel.

    Attributes
    ----------
    seeks : True if foragers go to the nearest known item instead, by a shortest path
    """

    seeks: ClassVar[bool] = False

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._plain, self._seeker = Plain(task, keys.size), ItemSeeker(task) if self.seeks else None
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))
        self._fill = self.filled(task, self._preferences)

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """The kernel that fills `preferences` for an observation."""
        raise NotImplementedError

    def act(self, observation: Observation) -> Preferences:
        """Preferences (episode, agent, 9) of all moves."""
        observation = self._plain(observation)
        self._fill(observation)
        if self._seeker is not None:
            self._seeker.guide(observation, self._preferences)
        return self._preferences
