"""Agents that one search moves, with the ways of each kind of mover among them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.belief_planner.ways import Ways, ways_of
from mjforage.mission.task import Task


@dataclass(frozen=True)
class Group:
    """Agents that one search moves.

    Attributes
    ----------
    agents : (member,) indices in the fleet
    kind : (member,) which of `ways` it moves by
    ways : one per number of nodes per decision
    """

    agents: NDArray[np.int64]
    kind: NDArray[np.int64]
    ways: tuple[Ways, ...]

    @classmethod
    def of(cls, task: Task, agents: NDArray[np.int64]) -> "Group":
        """The group of some agents of a task."""
        lengths = sorted({int(m) for m in task.fleet.moves[agents]}) or [1]
        kind = np.searchsorted(lengths, task.fleet.moves[agents]).astype(np.int64)
        stay, shorten = task.rules.stay, task.rules.shorten
        return cls(agents, kind, tuple(ways_of(task.graph, m, stay, shorten) for m in lengths))

    def ways_of(self, agent: int) -> Ways:
        """The ways of one of the agents."""
        return self.ways[int(self.kind[np.flatnonzero(self.agents == agent)[0]])]
