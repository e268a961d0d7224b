"""Terms of the way to the nearest known item."""

import numpy as np

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.graph_planner.graph.geodesics import FAR, Int32Array, Workspace, distances_to_nearest
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Step
from mjforage.mission.task import TaskArrays


@kernel
def _nearest_known(
    arrays: TaskArrays,
    known: Int32Array,
    n_known: Int32Array,
    agent_node: Int32Array,
    workspace: Workspace,
    out: Amounts,
) -> None:
    """Distance of each agent to the nearest known item [node]; 0 if none is known."""
    neighbours, table = arrays.neighbours, arrays.distances
    agents = agent_node.shape[1]
    targets = np.full((agents, 9), np.int32(-1), np.int32)
    nearest = np.empty((agents, 9))
    for e in range(agent_node.shape[0]):
        out[e] = 0.0
        if n_known[e] == 0:
            continue
        targets[:, 0] = agent_node[e]
        items = known[e, : n_known[e]]
        distances_to_nearest(
            neighbours, table, items, agent_node[e], targets, 0.0, workspace, nearest
        )
        for a in range(agents):
            if nearest[a, 0] < FAR:
                out[e, a] = nearest[a, 0]


class _ToNearest:
    """Distance that both terms measure."""

    def __init__(self) -> None:
        self._nearest_known = BoundKernel(_nearest_known)

    def nearest(
        self, step: Step, known: Int32Array, n_known: Int32Array, agent_node: Int32Array
    ) -> Amounts:
        """(episode, agent) [node]."""
        out = np.empty(agent_node.shape)
        self._nearest_known(step.task.arrays, known, n_known, agent_node, step.workspace, out)
        return out


@reward("distance")
class Distance(_ToNearest):
    """Distance to the nearest known item, 0 if none is known."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [node]."""
        known = step.mission.knowledge
        return self.nearest(step, known.known, known.n_known, step.mission.state.agent_node)


@reward("approach")
class Approach(_ToNearest):
    """Approach of a collector to the nearest item known before the move.

    A scout would earn it by staying with known items, one after the other as they are collected,
    instead of searching for others.
    """

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [node]."""
        old = step.before
        before = self.nearest(step, old.known, old.n_known, old.agent_node)
        gain = before - self.nearest(step, old.known, old.n_known, step.mission.state.agent_node)
        return gain * step.task.fleet.collects
