"""Terms that count items which agents removed or discovered."""

import numpy as np
from numpy.typing import NDArray

from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Step


def _count(agent: NDArray[np.int16], now: NDArray[np.bool_], agents: int) -> Amounts:
    """How many items (episode, item) an event gives to each agent now."""
    counts = [((agent == a) & now).sum(axis=1) for a in range(agents)]
    return np.stack(counts, axis=1).astype(np.float64)


def _removed(step: Step) -> Amounts:
    mission = step.mission
    now = mission.ledger.entries.t_collected == mission.step[:, None]
    return _count(mission.state.collected_by, now, len(step.task.fleet))


@reward("removed")
class Removed:
    """Items that each agent removed."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        return step.once(_removed)


@reward("team_removed")
class TeamRemoved:
    """Items removed by all, over the number of agents."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        removed = step.once(_removed)
        return np.repeat(removed.mean(axis=1, keepdims=True), removed.shape[1], axis=1)


@reward("discovered")
class Discovered:
    """Items first discovered by each agent."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        entries = step.mission.ledger.entries
        now = entries.t_discovered == step.mission.step[:, None]
        return _count(entries.discovered_by, now, len(step.task.fleet))
