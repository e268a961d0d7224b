"""What a term of the reward is: a class that gives a number per agent after every step."""

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from graph_planner.geodesics import Int32Array, Workspace
from graph_planner.task import Task
from mjforage.core.mission import Mission
from mjforage.core.once import Once

Amounts = NDArray[np.float64]  # (episode, agent)


class Before(NamedTuple):
    """What a reward compares the new state with."""

    belief: NDArray[np.int16]  # (episode, node)
    last_seen: NDArray[np.int16]  # (episode, node)
    agent_node: Int32Array  # (episode, agent)
    known: Int32Array  # (episode, node) the first `n_known` entries
    n_known: Int32Array  # (episode,)

    @classmethod
    def of(cls, mission: Mission, memory: "Before | None" = None) -> "Before":
        """A copy of what the next state is compared with; in memory of its size if there is any."""
        known = mission.knowledge
        live: tuple[NDArray[Any], ...] = (
            known.belief,
            known.last_seen,
            mission.state.agent_node,
            known.known,
            known.n_known,
        )
        if memory is None or memory.belief.shape != known.belief.shape:
            return cls._make(array.copy() for array in live)
        kept: tuple[NDArray[Any], ...] = memory
        for own, array in zip(kept, live, strict=True):
            width = known.n_known.max() if own is memory.known else None
            np.copyto(own[..., :width], array[..., :width])
        return memory


class Step(Once):
    """A step that was just made, as a term sees it. `once` keeps what several terms compute.

    Attributes
    ----------
    mission : Mission after the step; its arrays are live, and nobody writes to them
    before : what was known before it, and where the agents were; of this step only
    task : Task, the map and the fleet
    workspace : room for searches of the map
    """

    def __init__(self, mission: Mission, before: Before, task: Task, workspace: Workspace) -> None:
        super().__init__()
        self.mission, self.before, self.task, self.workspace = mission, before, task, workspace


class Term(Protocol):
    """A term. Its class is called with the options of a reference as keywords, once for each game.

    It keeps nothing from one step to the next: episodes of a batch start and end on their own.
    """

    def __call__(self, step: Step) -> Amounts:
        """(episode, agent) what the step was worth; rows of episodes that are over do not count."""
        ...
