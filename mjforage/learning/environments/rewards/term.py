"""Terms of the reward: classes that give a number per agent after every step."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mjforage.base.cached import Cache
from mjforage.base.compiled import kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.graph.geodesics import Int32Array, Workspace
from mjforage.mission.dynamics import Transition
from mjforage.mission.knowledge import Knowledge
from mjforage.mission.ledger import Ledger
from mjforage.mission.mission import Mission
from mjforage.mission.task import Task

Amounts = NDArray[np.float64]  # (episode, agent)


class Before(NamedTuple):
    """State before a step, with which a reward compares the new one; read-only."""

    belief: NDArray[np.int16]  # (episode, node)
    last_seen: NDArray[np.int16]  # (episode, node)
    agent_node: Int32Array  # (episode, agent)
    known: Int32Array  # (episode, node) the first `n_known` entries
    n_known: Int32Array  # (episode,)
    step: Int32Array  # (episode,)
    item_node: Int32Array  # (episode, item), -1 for those that are removed
    energy_left: NDArray[np.float64]  # (episode, agent) [node]

    @classmethod
    def of_state(cls, state: Transition, known: Knowledge, step: Int32Array) -> "Before":
        """The arrays of a state and of what is known of it."""
        seen = known.belief, known.last_seen, state.agent_node, known.known, known.n_known
        return cls(*seen, step, state.item_node, known.energy_left)

    @classmethod
    def of(cls, mission: Mission) -> "Before":
        """Live arrays of a mission."""
        return cls.of_state(mission.state, mission.knowledge, mission.step)


@kernel
def _copy(live: Before, copied: Before) -> None:
    """Copy a state, but for what is not known."""
    for e in range(live.step.size):
        copied.step[e], copied.n_known[e] = live.step[e], live.n_known[e]
        for node in range(live.belief.shape[1]):
            copied.belief[e, node] = live.belief[e, node]
            copied.last_seen[e, node] = live.last_seen[e, node]
        for i in range(live.n_known[e]):
            copied.known[e, i] = live.known[e, i]
        for a in range(live.agent_node.shape[1]):
            copied.agent_node[e, a] = live.agent_node[e, a]
            copied.energy_left[e, a] = live.energy_left[e, a]
        for k in range(live.item_node.shape[1]):
            copied.item_node[e, k] = live.item_node[e, k]


COPY = Launch(_copy)


class Step(Cache):
    """A step that was just made, as a term sees it. `once` caches results that several terms need.

    Attributes
    ----------
    mission : Mission after the step; its arrays are live and read-only
    before : what was known before it, and where the agents were; of this step only
    task : Task, the map and the fleet
    after : the same as `before`, of now; live
    workspace : room for searches of the map
    turns : steps of the environment that this one is: 1, or one for each agent's decision
    least : (agent,) see `least_energy`
    """

    def __init__(
        self, mission: Mission, before: Before, task: Task, workspace: Workspace, turns: int = 1
    ) -> None:
        super().__init__()
        self.mission, self.before, self.task, self.workspace = mission, before, task, workspace
        self.after, self.turns = Before.of(mission), turns
        self.least = least_energy(task)


class DeviceStep(NamedTuple):
    """A step as kernels on a device see it, of which `before` and `after` are live."""

    before: Before
    after: Before
    state: Transition
    ledger: Ledger
    task: Task
    workspace: Workspace
    turns: int

    @property
    def least(self) -> NDArray[np.int64]:
        """(agent,) see `least_energy`."""
        return least_energy(self.task)


def least_energy(task: Task) -> NDArray[np.int64]:
    """(agent,) energy without which each can never move again, see `Task.exhausted` [node]."""
    moves = task.fleet.moves
    return np.ones_like(moves) if task.rules.shorten else moves


class Term(Protocol):
    """A term. Its class is called with the options of a reference as keywords, once for each core.

    It keeps nothing from one step to the next: episodes of a batch start and end on their own.
    """

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) what the step was worth; rows of episodes that are over do not count."""
        ...


class DeviceTerm(Term, Protocol):
    """A term that a device can compute as well."""

    def on_device(self, bind: Bind, step: DeviceStep, out: Amounts) -> tuple[Call, ...]:
        """Kernels that write the same to `out` (episode, agent)."""
        ...
