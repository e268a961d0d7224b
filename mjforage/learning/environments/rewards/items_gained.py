"""Terms that count items which agents removed or discovered."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Step


@kernel
def _count(
    agent: NDArray[np.int16], when: NDArray[np.int16], step: Int32Array, agents: int
) -> Amounts:
    """Number of items that each agent (episode, agent) is given in this step (episode,)."""
    counts = np.zeros((step.size, agents))
    for e in range(step.size):
        for k in range(agent.shape[1]):
            if when[e, k] == step[e] and agent[e, k] >= 0:
                counts[e, agent[e, k]] += 1.0
    return counts


def _removed(step: Step) -> Amounts:
    mission = step.mission
    when = mission.ledger.t_collected
    return _count(mission.state.collected_by, when, mission.step, len(step.task.fleet))


@reward("removed")
class Removed:
    """Items that each agent removed."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        return step.cached(_removed)


@reward("team_removed")
class TeamRemoved:
    """Items removed by all, over the number of agents."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        removed = step.cached(_removed)
        return np.repeat(removed.mean(axis=1, keepdims=True), removed.shape[1], axis=1)


@reward("discovered")
class Discovered:
    """Items first discovered by each agent."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        entries = step.mission.ledger
        about = entries.discovered_by, entries.t_discovered, step.mission.step
        return _count(*about, len(step.task.fleet))
