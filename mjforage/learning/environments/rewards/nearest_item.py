"""Terms of the way to the nearest known item."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import FAR, Int32Array, Workspace, distances_to_nearest
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Before, DeviceStep, Step
from mjforage.mission.task import TaskArrays


class Moves(NamedTuple):
    """Ends of moves, of which the first is where an agent is; memory."""

    targets: Int32Array  # (agent, 9) nodes, -1 for none
    nearest: NDArray[np.float64]  # (agent, 9) distance to the nearest item [node]

    @classmethod
    def of(cls, agents: int) -> "Moves":
        """Memory for so many agents."""
        return cls(np.zeros((agents, 9), np.int32), np.zeros((agents, 9)))


@kernel
def _nearest_known(
    arrays: TaskArrays,
    known: Int32Array,
    n_known: Int32Array,
    agent_node: Int32Array,
    workspace: Workspace,
    moves: Moves,
    out: Amounts,
) -> None:
    """Distance of each agent to the nearest known item [node]; 0 if none is known."""
    neighbours, table = arrays.neighbours, arrays.distances
    agents, targets, nearest = agent_node.shape[1], moves.targets, moves.nearest
    targets[:] = -1
    for e in range(agent_node.shape[0]):
        out[e] = 0.0
        if n_known[e] == 0:
            continue
        for a in range(agents):
            targets[a, 0] = agent_node[e, a]
        items = known[e, : n_known[e]]
        distances_to_nearest(
            neighbours, table, items, agent_node[e], targets, 0.0, workspace, nearest
        )
        for a in range(agents):
            if nearest[a, 0] < FAR:
                out[e, a] = nearest[a, 0]


@kernel
def _come_nearer(
    before: Amounts, after: Amounts, collects: NDArray[np.bool_], out: Amounts
) -> None:
    """Write by how much collectors have come nearer [node]; 0 for others."""
    for e in range(out.shape[0]):
        for a in range(out.shape[1]):
            out[e, a] = (before[e, a] - after[e, a]) * (1.0 if collects[a] else 0.0)


NEAREST = Launch(_nearest_known, shared="arrays", memory="workspace moves")
NEARER = Launch(_come_nearer, shared="collects")


class _ToNearest:
    """Distance that both terms measure."""

    def __init__(self) -> None:
        self._nearest_known = BoundKernel(_nearest_known)

    def nearest(
        self, step: Step, known: Int32Array, n_known: Int32Array, agent_node: Int32Array
    ) -> Amounts:
        """(episode, agent) [node]."""
        out, about = np.empty(agent_node.shape), (step.task.arrays, known, n_known, agent_node)
        self._nearest_known(*about, step.workspace, Moves.of(agent_node.shape[1]), out)
        return out

    def measured(
        self, bind: Bind, step: DeviceStep, known: Before, agent_node: Int32Array, out: Amounts
    ) -> Call:
        """`nearest` by a kernel on a device, of the items known in a state."""
        about = step.task.arrays, known.known, known.n_known, agent_node, step.workspace
        return bind(NEAREST, *about, Moves.of(out.shape[1]), out)


@reward("distance")
class Distance(_ToNearest):
    """Distance to the nearest known item, 0 if none is known."""

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) [node]."""
        known = step.mission.knowledge
        return self.nearest(step, known.known, known.n_known, step.mission.state.agent_node)

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By a kernel on a device."""
        return (self.measured(bind, step, step.after, step.state.agent_node, out),)


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

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """By kernels on a device."""
        before, after = np.zeros((2, *out.shape))
        old, at, now = step.before, step.before.agent_node, step.state.agent_node
        return (
            self.measured(bind, step, old, at, before),
            self.measured(bind, step, old, now, after),
            bind(NEARER, before, after, step.task.fleet.collects, out),
        )
