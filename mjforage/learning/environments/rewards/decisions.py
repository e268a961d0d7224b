"""Terms of the decisions themselves: those without a legal move, and each that was needed."""

import numpy as np

from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Step
from mjforage.mission.dynamics import BLOCKED


@reward("blocked")
class Blocked:
    """1 where an agent had no legal move."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) 0 or 1."""
        return np.asarray(step.mission.state.outcome == BLOCKED, np.float64)


@reward("time")
class TimePassed:
    """1 for every step until the episode is over."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) 0 or 1."""
        left = np.asarray((step.mission.state.item_node >= 0).any(axis=1), np.float64)
        return np.repeat(left[:, None], len(step.task.fleet), axis=1)
