"""Terms that all agents share alike: the share of items that was removed, and when."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Step


@kernel
def _share(item_node: Int32Array, when: NDArray[np.int16], step: Int32Array) -> NDArray[np.float64]:
    """(episode,) items (episode, item) removed in this step (episode,), over all of the episode."""
    shares = np.zeros(step.size)
    for e in range(step.size):
        items, removed = 0, 0
        for k in range(item_node.shape[1]):
            items += item_node[e, k] >= 0 or when[e, k] >= 0
            removed += when[e, k] == step[e]
        shares[e] = removed / max(items, 1)
    return shares


def _removed_share(step: Step) -> Amounts:
    mission, agents = step.mission, len(step.task.fleet)
    share = _share(mission.state.item_node, mission.ledger.t_collected, mission.step)
    return np.repeat(share[:, None] / agents, agents, axis=1)


@reward("collected")
class Collected:
    """Share of all items that was removed, by whomever."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [1]."""
        return step.cached(_removed_share)


@reward("early")
class Early:
    """The same, times the share of the horizon that is left."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [1]."""
        left = 1.0 - step.mission.step / step.task.horizon
        return step.cached(_removed_share) * left[:, None]
