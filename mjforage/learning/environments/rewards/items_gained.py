"""Terms that count items which agents removed or discovered."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, DeviceStep, Step


@kernel
def _count(
    agent: NDArray[np.int16],
    when: NDArray[np.int16],
    step: Int32Array,
    shared: bool,
    out: Amounts,
) -> None:
    """Write the number of items that each agent (episode, agent) is given in this step (episode,).

    `shared`: each has the mean of all.
    """
    agents = out.shape[1]
    for e in range(step.size):
        out[e] = 0.0
        for k in range(agent.shape[1]):
            if when[e, k] == step[e] and agent[e, k] >= 0:
                out[e, 0 if shared else agent[e, k]] += 1.0
        if shared:
            for a in range(agents - 1, -1, -1):
                out[e, a] = out[e, 0] / agents


COUNT = Launch(_count)


def _given(step: Step, agent: NDArray[np.int16], when: NDArray[np.int16], shared: bool) -> Amounts:
    out = np.empty(step.mission.state.agent_node.shape)
    _count(agent, when, step.mission.step, shared, out)
    return out


@reward("removed")
class Removed:
    """Items that each agent removed."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        mission = step.mission
        return _given(step, mission.state.collected_by, mission.ledger.t_collected, False)

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        items = step.state.collected_by, step.ledger.t_collected
        return (bind(COUNT, *items, step.after.step, False, out),)


@reward("team_removed")
class TeamRemoved:
    """Items removed by all, over the number of agents."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        mission = step.mission
        return _given(step, mission.state.collected_by, mission.ledger.t_collected, True)

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        items = step.state.collected_by, step.ledger.t_collected
        return (bind(COUNT, *items, step.after.step, True, out),)


@reward("discovered")
class Discovered:
    """Items first discovered by each agent."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        entries = step.mission.ledger
        return _given(step, entries.discovered_by, entries.t_discovered, False)

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        items = step.ledger.discovered_by, step.ledger.t_discovered
        return (bind(COUNT, *items, step.after.step, False, out),)
