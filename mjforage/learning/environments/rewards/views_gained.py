"""Terms of what came into view: changes of the belief map, and idleness that ended."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.visibility import NodeLists
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Step


@kernel
def _in_view(
    agent_node: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    worth: Amounts,
    shared: bool,
    out: Amounts,
) -> None:
    """Sum of what each node in view is worth (episode, node), by agent; maybe shared."""
    start, nodes = views.start, views.nodes
    viewers = np.zeros(worth.shape[1], np.int64)
    for e in range(agent_node.shape[0]):
        if shared:
            viewers[:] = 0
            for a in range(radius_number.size):
                radius, node = radius_number[a], agent_node[e, a]
                for i in range(start[radius, node], start[radius, node + 1]):
                    viewers[nodes[i]] += 1
        for a in range(radius_number.size):
            radius, node, total = radius_number[a], agent_node[e, a], 0.0
            for i in range(start[radius, node], start[radius, node + 1]):
                value = worth[e, nodes[i]]
                total += value / viewers[nodes[i]] if shared else value
            out[e, a] = total


def _seen(step: Step, worth: Amounts, shared: bool) -> Amounts:
    task, agent_node = step.task, step.mission.state.agent_node
    out = np.empty(agent_node.shape)
    _in_view(agent_node, task.views, task.radius_number, worth, shared, out)
    return out


@reward("belief")
class BeliefChanged:
    """Change of the belief map in view, shared where views overlap."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        change = np.abs(step.mission.knowledge.belief - step.before.belief).astype(np.float64)
        return _seen(step, change, shared=True)


@reward("idleness")
class IdlenessEnded:
    """Idleness, before the look, of the nodes in view of agents that do not collect."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [node of idleness 1]."""
        unseen_for = step.mission.step[:, None] - step.before.last_seen.astype(np.int64)
        idle = np.minimum(1.0, unseen_for * step.task.forgetting)
        looks = (~step.task.fleet.collects).astype(np.float64)
        return _seen(step, idle, shared=False) * looks
