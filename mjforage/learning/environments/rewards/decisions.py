"""Terms of the decisions themselves: those without a legal move, and each that was needed."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, DeviceStep, Step
from mjforage.mission.dynamics import BLOCKED


@kernel
def _blocked(outcome: NDArray[np.int8], out: Amounts) -> None:
    """Write 1 where an agent had no legal move, else 0."""
    for e in range(out.shape[0]):
        for a in range(out.shape[1]):
            out[e, a] = 1.0 if outcome[e, a] == BLOCKED else 0.0


@kernel
def _left(item_node: Int32Array, out: Amounts) -> None:
    """Write 1 while there are items, else 0."""
    for e in range(out.shape[0]):
        out[e] = 0.0
        for k in range(item_node.shape[1]):
            if item_node[e, k] >= 0:
                out[e] = 1.0
                break


IS_BLOCKED, LEFT = Launch(_blocked), Launch(_left)


@reward("blocked")
class Blocked:
    """1 where an agent had no legal move."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) 0 or 1."""
        out = np.empty(step.mission.state.outcome.shape)
        _blocked(step.mission.state.outcome, out)
        return out

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        return (bind(IS_BLOCKED, step.state.outcome, out),)


@reward("time")
class TimePassed:
    """1 for every step until the episode is over."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) 0 or 1."""
        out = np.empty(step.mission.state.agent_node.shape)
        _left(step.mission.state.item_node, out)
        return out

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        return (bind(LEFT, step.state.item_node, out),)
