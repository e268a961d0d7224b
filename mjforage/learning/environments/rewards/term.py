"""What a term of the reward is: a class that gives a number per agent after every step."""

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mjforage.base.cached import Cache
from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.views import CachedViews
from mjforage.graph_planner.graph.geodesics import Int32Array, Workspace
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.mission import Mission
from mjforage.mission.task import Task

Amounts = NDArray[np.float64]  # (episode, agent)


class Before(NamedTuple):
    """What a reward compares the new state with; read-only."""

    belief: NDArray[np.int16]  # (episode, node)
    last_seen: NDArray[np.int16]  # (episode, node)
    agent_node: Int32Array  # (episode, agent)
    known: Int32Array  # (episode, node) the first `n_known` entries
    n_known: Int32Array  # (episode,)
    step: Int32Array  # (episode,)

    @classmethod
    def of(cls, mission: Mission) -> "Before":
        """Live arrays of a mission."""
        known, at = mission.knowledge, mission.state.agent_node
        return cls(known.belief, known.last_seen, at, known.known, known.n_known, mission.step)


class Follower:
    """A copy of what is known in a mission before every step, of which little changes in one."""

    def __init__(self) -> None:
        self._copy: Before | None = None
        self._lent = CachedViews[Before]()
        self._follow = BoundKernel(_follow)

    def follow(self, mission: Mission) -> Before:
        """The copy, brought up to date; call once before every step of one mission."""
        live, copied, task, known = Before.of(mission), self._copy, mission.task, mission.knowledge
        if copied is None or copied.belief.shape != live.belief.shape:
            arrays: tuple[NDArray[Any], ...] = live
            self._copy = Before._make(array.copy() for array in arrays)
            return self._lent.of(self._copy)
        self._follow(live, known.agent_node, task.views, task.radius_number, copied)
        return self._lent.of(copied)


@kernel
def _follow(
    live: Before,
    looked_from: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    memory: Before,
) -> None:
    """Bring a copy up to date. One step changes what is known of the nodes in view, and no other.

    Parameters
    ----------
    looked_from : (episode, agent) nodes of the last looks
    """
    start, nodes = views.start, views.nodes
    belief, last_seen, agent_node, known, n_known, step = live
    own_belief, own_last_seen, own_agent_node, own_known, own_n_known, own_step = memory
    for e in range(step.size):
        for i in range(n_known[e]):
            own_known[e, i] = known[e, i]
        for a in range(agent_node.shape[1]):
            own_agent_node[e, a] = agent_node[e, a]
        since, own_step[e], own_n_known[e] = step[e] - own_step[e], step[e], n_known[e]
        if step[e] == 0 or not 0 <= since <= 1:
            for node in range(belief.shape[1]):
                own_belief[e, node] = belief[e, node]
                own_last_seen[e, node] = last_seen[e, node]
            continue
        for a in range(radius_number.size):
            radius, viewer = radius_number[a], looked_from[e, a]
            for i in range(start[radius, viewer], start[radius, viewer + 1]):
                own_belief[e, nodes[i]] = belief[e, nodes[i]]
                own_last_seen[e, nodes[i]] = last_seen[e, nodes[i]]


class Step(Cache):
    """A step that was just made, as a term sees it. `once` keeps what several terms compute.

    Attributes
    ----------
    mission : Mission after the step; its arrays are live and read-only
    before : what was known before it, and where the agents were; of this step only
    task : Task, the map and the fleet
    workspace : room for searches of the map
    """

    def __init__(self, mission: Mission, before: Before, task: Task, workspace: Workspace) -> None:
        super().__init__()
        self.mission, self.before, self.task, self.workspace = mission, before, task, workspace


class Term(Protocol):
    """A term. Its class is called with the options of a reference as keywords, once for each core.

    It keeps nothing from one step to the next: episodes of a batch start and end on their own.
    """

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) what the step was worth; rows of episodes that are over do not count."""
        ...
