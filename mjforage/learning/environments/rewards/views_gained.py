"""Terms of nodes that came into view: changes of the belief map, and idleness that ended."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, DeviceStep, Step


@kernel
def _belief_changed(
    agent_node: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    before: NDArray[np.int16],
    after: NDArray[np.int16],
    viewers: NDArray[np.int64],
    out: Amounts,
) -> None:
    """Sum of the changes (episode, node) in view, by agent, each shared by all that see it.

    `viewers`: (node,) memory, all 0 before and after.
    """
    start, nodes = views.start, views.nodes
    for e in range(agent_node.shape[0]):
        for add in (1, 0):
            for a in range(radius_number.size):
                radius, node, total = radius_number[a], agent_node[e, a], 0.0
                for i in range(start[radius, node], start[radius, node + 1]):
                    seen = np.uint64(nodes[i])
                    if add:
                        viewers[seen] += 1
                    elif after[e, seen] != before[e, seen]:
                        total += abs(after[e, seen] - before[e, seen]) / viewers[seen]
                out[e, a] = total
        for a in range(radius_number.size):
            radius, node = radius_number[a], agent_node[e, a]
            for i in range(start[radius, node], start[radius, node + 1]):
                viewers[np.uint64(nodes[i])] = 0


@kernel
def _idleness_ended(
    agent_node: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    collects: NDArray[np.bool_],
    step: Int32Array,
    last_seen: NDArray[np.int16],
    forgetting: float,
    out: Amounts,
) -> None:
    """Sum of idleness before the scan (episode, node) in view, by agent; 0 for collectors."""
    start, nodes = views.start, views.nodes
    for e in range(agent_node.shape[0]):
        for a in range(radius_number.size):
            radius, node, total = radius_number[a], agent_node[e, a], 0.0
            if not collects[a]:
                for i in range(start[radius, node], start[radius, node + 1]):
                    unseen_for = step[e] - np.int64(last_seen[e, np.uint64(nodes[i])])
                    total += min(1.0, unseen_for * forgetting)
            out[e, a] = total


CHANGED = Launch(_belief_changed, shared="views radius_number", memory="viewers")
ENDED = Launch(_idleness_ended, shared="views radius_number collects")


@reward("belief")
class BeliefChanged:
    """Change of the belief map in view, shared where views overlap."""

    def __init__(self) -> None:
        self._changed = BoundKernel(_belief_changed)

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [item]."""
        task, at = step.task, step.mission.state.agent_node
        beliefs = step.before.belief, step.mission.knowledge.belief
        out, viewers = np.empty(at.shape), np.zeros(len(task.graph), np.int64)
        self._changed(at, task.views, task.radius_number, *beliefs, viewers, out)
        return out

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        task, viewers = step.task, np.zeros(len(step.task.graph), np.int64)
        about = step.state.agent_node, task.views, task.radius_number
        return (bind(CHANGED, *about, step.before.belief, step.after.belief, viewers, out),)


@reward("idleness")
class IdlenessEnded:
    """Idleness, before the scan, of the nodes in view of agents that do not collect."""

    def __init__(self) -> None:
        self._ended = BoundKernel(_idleness_ended)

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [node of idleness 1]."""
        task, at = step.task, step.mission.state.agent_node
        about = task.views, task.radius_number, task.fleet.collects
        out = np.empty(at.shape)
        last_seen = step.before.last_seen
        self._ended(at, *about, step.mission.step, last_seen, task.forgetting, out)
        return out

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        task, seen = step.task, (step.after.step, step.before.last_seen)
        about = step.state.agent_node, task.views, task.radius_number, task.fleet.collects
        return (bind(ENDED, *about, *seen, task.forgetting, out),)
