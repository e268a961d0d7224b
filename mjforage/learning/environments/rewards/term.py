"""Terms of the reward: classes that give a number per agent after every step."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mjforage.base.cached import Cache
from mjforage.graph_planner.graph.geodesics import Int32Array, Workspace
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
    def of(cls, mission: Mission) -> "Before":
        """Live arrays of a mission."""
        known, at = mission.knowledge, mission.state.agent_node
        seen = known.belief, known.last_seen, at, known.known, known.n_known
        return cls(*seen, mission.step, mission.state.item_node, known.energy_left)


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
    """

    def __init__(
        self, mission: Mission, before: Before, task: Task, workspace: Workspace, turns: int = 1
    ) -> None:
        super().__init__()
        self.mission, self.before, self.task, self.workspace = mission, before, task, workspace
        self.after, self.turns = Before.of(mission), turns


class Term(Protocol):
    """A term. Its class is called with the options of a reference as keywords, once for each core.

    It keeps nothing from one step to the next: episodes of a batch start and end on their own.
    """

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) what the step was worth; rows of episodes that are over do not count."""
        ...
