"""Terms that all agents share alike: the share of items that was removed, and when."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, DeviceStep, Step


@kernel
def _share(
    item_node: Int32Array, when: NDArray[np.int16], step: Int32Array, horizon: int, out: Amounts
) -> None:
    """Write items (episode, item) removed in this step (episode,), over all of the episode and the
    number of agents; times the share of a horizon that is left, if it is not 0.
    """
    for e in range(step.size):
        items, removed = 0, 0
        for k in range(item_node.shape[1]):
            items += item_node[e, k] >= 0 or when[e, k] >= 0
            removed += when[e, k] == step[e]
        left = 1.0 - step[e] / horizon if horizon else 1.0
        for a in range(out.shape[1]):
            out[e, a] = removed / max(items, 1) / out.shape[1] * left


SHARE = Launch(_share)


def _removed_share(step: Step, horizon: int = 0) -> Amounts:
    mission, out = step.mission, np.empty(step.mission.state.agent_node.shape)
    _share(mission.state.item_node, mission.ledger.t_collected, mission.step, horizon, out)
    return out


@reward("collected")
class Collected:
    """Share of all items that was removed, by whomever."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [1]."""
        return _removed_share(step)

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        removed = step.state.item_node, step.ledger.t_collected
        return (bind(SHARE, *removed, step.after.step, 0, out),)


@reward("early")
class Early:
    """The same, times the share of the horizon that is left."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [1]."""
        return _removed_share(step, step.task.horizon)

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        removed = step.state.item_node, step.ledger.t_collected
        return (bind(SHARE, *removed, step.after.step, step.task.horizon, out),)
