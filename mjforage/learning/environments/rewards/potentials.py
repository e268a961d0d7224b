"""Terms that are differences of potentials: what knowledge and places are worth.

A potential Phi is a number of each agent and state, and its term is gamma Phi(after) - Phi(before).
Such terms do not change which policy is best for a learner whose discount per step is gamma (Ng,
Harada, Russell, *Policy invariance under reward transformations*, 1999), nor, one potential for
each agent, which joint policies are equilibria (Devlin, Kudenko, *Theoretical considerations of
potential-based reward shaping for multi-agent systems*, 2011). For that Phi is 0 in states in which
the agent's episode is over: no item is left, or it is exhausted (`Task.exhausted`). At a
truncation it stays, as the value from which learners go on there does.
"""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import (
    FAR,
    Float32Array,
    Int32Array,
    Workspace,
    canonical,
    spread,
)
from mjforage.learning.environments.rewards.known import reward
from mjforage.learning.environments.rewards.term import Amounts, Before, DeviceStep, Step
from mjforage.mission.ledger import Ledger
from mjforage.mission.task import TaskArrays

GAMMA = 0.99
"""Discount per step that Stable-Baselines3 and others have by default, and so has `ddqn`."""


def _ongoing(step: Step) -> list[NDArray[np.bool_]]:
    """(episode, agent) whose episode is not over, before a step and after it."""
    return [
        (at.item_node >= 0).any(axis=1, keepdims=True) & ~step.task.exhausted(at.energy_left)
        for at in (step.before, step.after)
    ]


class Gains(NamedTuple):
    """Potentials before and after a step, and whether it went on then, (episode, agent) each."""

    before: Amounts
    after: Amounts
    began: Amounts  # 1 or 0
    goes_on: Amounts


@kernel
def _find_ongoing(
    item_node: Int32Array,
    energy_left: NDArray[np.float64],
    least: NDArray[np.int64],
    out: Amounts,
) -> None:
    """Write 1 for agents whose episode is not over, else 0."""
    for e in range(item_node.shape[0]):
        left = False
        for k in range(item_node.shape[1]):
            left |= item_node[e, k] >= 0
        for a in range(least.size):
            out[e, a] = 1.0 if left and energy_left[e, a] >= least[a] else 0.0


@kernel
def _gain(gamma: float, gains: Gains, out: Amounts) -> None:
    """Write what potentials gained, discounted."""
    for e in range(out.shape[0]):
        for a in range(out.shape[1]):
            after = gamma * (gains.after[e, a] * gains.goes_on[e, a])
            out[e, a] = after - gains.before[e, a] * gains.began[e, a]


ONGOING, GAIN = Launch(_find_ongoing, shared="least"), Launch(_gain)


class Potential(ABC):
    """Base of the terms."""

    def __init__(self, gamma: float = GAMMA) -> None:
        if not 0.0 <= gamma <= 1.0:
            raise ValueError(f"gamma = {gamma}: give 0 to 1, the discount of the learner")
        self._gamma = gamma

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) what the potential gained, discounted."""
        gamma = self._gamma**step.turns
        before, after = (self.value(step, at) for at in (step.before, step.after))
        ongoing = step.cached(_ongoing)
        return gamma * (after * ongoing[1]) - before * ongoing[0]

    @abstractmethod
    def value(self, step: Step, at: Before) -> Amounts:
        """(episode, agent) the potential of a state."""

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """The same by kernels, which write to `out` (episode, agent)."""
        calls, gains = [], Gains(*np.zeros((4, *out.shape)))
        for at, value, ongoing in zip((step.before, step.after), gains[:2], gains[2:], strict=True):
            calls.append(self.valued(bind, step, at, value))
            calls.append(bind(ONGOING, at.item_node, at.energy_left, step.least, ongoing))
        return *calls, bind(GAIN, self._gamma**step.turns, gains, out)

    def valued(self, bind: Bind, step: DeviceStep, at: Before, out: Amounts) -> Call:
        """`value` by a kernel, which writes to `out` (episode, agent); ours have one."""
        raise NotImplementedError


@kernel
def _known(ledger: Ledger, item_node: Int32Array, step: Int32Array, out: Amounts) -> None:
    """Items that are discovered and afloat, by agent that discovered them, over all items."""
    found, taken, by = ledger.t_discovered, ledger.t_collected, ledger.discovered_by
    for e in range(step.size):
        out[e], items = 0.0, 0
        for k in range(item_node.shape[1]):
            items += item_node[e, k] >= 0 or taken[e, k] >= 0
            if item_node[e, k] >= 0 and 0 <= found[e, k] <= step[e] and by[e, k] >= 0:
                out[e, by[e, k]] += 1.0
        for a in range(out.shape[1]):
            out[e, a] /= max(items, 1)


KNOWN = Launch(_known)


@reward("known")
class Known(Potential):
    """Potential of the items that an agent discovered and that are still afloat."""

    def value(self, step: Step, at: Before) -> Amounts:
        """(episode, agent) share of all items."""
        out = np.empty(at.agent_node.shape)
        _known(step.mission.ledger, at.item_node, at.step, out)
        return out

    def valued(self, bind: Bind, step: DeviceStep, at: Before, out: Amounts) -> Call:
        """By a kernel on a device."""
        return bind(KNOWN, step.ledger, at.item_node, at.step, out)


class Found(NamedTuple):
    """Discovered items of an episode; memory."""

    nodes: Int32Array  # (item,)
    nearest: NDArray[np.float64]  # (item,) distance of a collector [node]
    whose: NDArray[np.int64]  # (item,) its number

    @classmethod
    def of(cls, items: int) -> "Found":
        """Memory for so many items."""
        return cls(np.zeros(items, np.int32), np.zeros(items), np.zeros(items, np.int64))


@kernel
def _within_reach(
    arrays: TaskArrays,
    ledger: Ledger,
    item_node: Int32Array,
    agent_node: Int32Array,
    energy_left: NDArray[np.float64],
    least: NDArray[np.int64],
    step: Int32Array,
    decay: float,
    workspace: Workspace,
    found: Found,
    out: Amounts,
) -> None:
    """Discovered items, by collector that is nearest, each decay^distance, over all items.

    `least`: (agent,) energy without which it does not count [node].
    """
    items, agents = item_node.shape[1], agent_node.shape[1]
    nodes, nearest, whose = found.nodes, found.nearest, found.whose
    for e in range(step.size):
        out[e], n, total = 0.0, 0, 0
        for k in range(items):
            total += item_node[e, k] >= 0 or ledger.t_collected[e, k] >= 0
            if item_node[e, k] >= 0 and 0 <= ledger.t_discovered[e, k] <= step[e]:
                nodes[n] = item_node[e, k]
                n += 1
        nearest[:n] = FAR
        for a in range(agents):
            if arrays.collects[a] and energy_left[e, a] >= least[a]:
                _nearer(arrays, nodes[:n], a, agent_node[e, a], workspace, nearest, whose)
        for i in range(n):
            if nearest[i] < FAR:
                out[e, whose[i]] += decay ** nearest[i] / total


@kernel
def _nearer(
    arrays: TaskArrays,
    nodes: Int32Array,
    agent: int,
    at: int,
    workspace: Workspace,
    nearest: NDArray[np.float64],
    whose: NDArray[np.int64],
) -> None:
    """Note an agent for those nodes to which it is nearer than the agents before it."""
    table: Float32Array = arrays.distances
    distance, touched, reached = workspace.distance, workspace.touched, 0
    if table.shape[0] == 0:
        workspace.source[0] = at
        wanted = nodes.size if nodes.size <= workspace.wanted.size else 0
        for i in range(wanted):
            workspace.wanted[i] = nodes[i]
        reached = spread(arrays.neighbours, workspace.source, wanted, workspace)
    for i in range(nodes.size):
        far = np.float64(table[at, nodes[i]]) if table.shape[0] else canonical(distance[nodes[i]])
        if far < nearest[i]:
            nearest[i], whose[i] = far, agent
    for j in range(reached):
        distance[touched[j]] = FAR


REACH = Launch(_within_reach, shared="arrays least", memory="workspace found")


@reward("reach")
class WithinReach(Potential):
    """Potential of discovered items near a collector, each for the one that is nearest to it.

    Parameters
    ----------
    decay : value of an item at a distance of one node, of one at the collector's own node
    """

    def __init__(self, gamma: float = GAMMA, decay: float = 0.85) -> None:
        super().__init__(gamma)
        if not 0.0 < decay < 1.0:
            raise ValueError(f"decay = {decay}: give more than 0 and less than 1")
        self._decay, self._within_reach = decay, BoundKernel(_within_reach)

    def value(self, step: Step, at: Before) -> Amounts:
        """(episode, agent) share of all items."""
        out, found = np.empty(at.agent_node.shape), Found.of(at.item_node.shape[1])
        about = step.task.arrays, step.mission.ledger, at.item_node, at.agent_node
        able = at.energy_left, step.least
        self._within_reach(*about, *able, at.step, self._decay, step.workspace, found, out)
        return out

    def valued(self, bind: Bind, step: DeviceStep, at: Before, out: Amounts) -> Call:
        """By a kernel on a device."""
        about = step.task.arrays, step.ledger, at.item_node, at.agent_node
        able, found = (at.energy_left, step.least), Found.of(at.item_node.shape[1])
        return bind(REACH, *about, *able, at.step, self._decay, step.workspace, found, out)


@kernel
def _freshness(
    last_seen: NDArray[np.int16], step: Int32Array, forgetting: float, out: Amounts
) -> None:
    """Write the mean over nodes of 1 - idleness, over the number of agents."""
    for e in range(step.size):
        total = 0.0
        for node in range(last_seen.shape[1]):
            total += min(1.0, (step[e] - np.int64(last_seen[e, node])) * forgetting)
        fresh = 1.0 - total / last_seen.shape[1]
        for a in range(out.shape[1]):
            out[e, a] = fresh / out.shape[1]


FRESH = Launch(_freshness)


@reward("fresh")
class Fresh(Potential):
    """Potential of a map that was seen a short time ago, shared by all agents alike."""

    def value(self, step: Step, at: Before) -> Amounts:
        """(episode, agent) 1 - mean idleness, over the number of agents."""
        out = np.empty(at.agent_node.shape)
        _freshness(at.last_seen, at.step, step.task.forgetting, out)
        return out

    def valued(self, bind: Bind, step: DeviceStep, at: Before, out: Amounts) -> Call:
        """By a kernel on a device."""
        return bind(FRESH, at.last_seen, at.step, step.task.forgetting, out)
