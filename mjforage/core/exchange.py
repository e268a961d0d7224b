"""Exchanges: which holders of knowledge hear of which agents' looks; a communication model is one.

After every step an exchange is told all looks, and brings what each holder knows up to date by
those that it hears. `Ideal`: everybody hears everything at once; `mjforage.core.link`: over a link.
"""

from collections.abc import Set
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from graph_planner.knowledge import Knowledge, Looks
from graph_planner.randomness import UInt64Array
from graph_planner.task import Late, Task, nothing_late


class Exchange(Protocol):
    """What holders hear, and for whom each of them holds it. One exchange serves one mission.

    Attributes
    ----------
    holder_of : (agent,) number of the holder by whose knowledge each agent acts, 0 to `holders` - 1
    holders : how many there are in an episode
    knowledge : what they know, (episode x holder) rows
    """

    holder_of: NDArray[np.int64]
    holders: int
    knowledge: Knowledge

    @property
    def uses(self) -> Set[str]:
        """Capabilities of roles for which it has rules, of `relays` and `carries`."""
        ...

    @property
    def late(self) -> Late:
        """Looks heard in this step that are older, (episode x holder) rows."""
        ...

    @property
    def linked(self) -> NDArray[np.bool_]:
        """(episode, agent, agent) whether two were in contact in this step; nobody with itself."""
        ...

    @property
    def lost(self) -> NDArray[np.int64]:
        """(episode, sender, receiver) looks lost on the way in this step."""
        ...

    def reset(self, task: Task, looks: Looks, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes with the looks of step 0.

        Parameters
        ----------
        pooled : what one who hears all looks at once knows, one row per episode; live
        keys : (episode,) of the episodes, for what is drawn
        """
        ...

    def tell(self, looks: Looks, pooled: Knowledge) -> None:
        """Take in the looks of a step; knowledge of inactive episodes does not change."""
        ...

    def adopt(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch by those of another exchange of the same kind."""
        ...


class Ideal:
    """Everybody hears everything at once: one holder, who knows what the fleet knows together."""

    uses: Set[str] = frozenset()
    holders = 1

    def reset(self, task: Task, looks: Looks, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes."""
        self._episodes = looks.step.size
        self.late = nothing_late(self._episodes)
        self.holder_of = np.zeros(len(task.fleet), np.int64)
        self.knowledge = pooled

    @property
    def linked(self) -> NDArray[np.bool_]:
        """(episode, agent, agent) everybody with everybody else."""
        return np.tile(~np.eye(self.holder_of.size, dtype=np.bool_), (self._episodes, 1, 1))

    @property
    def lost(self) -> NDArray[np.int64]:
        """(episode, sender, receiver) nothing."""
        return np.zeros((self._episodes, self.holder_of.size, self.holder_of.size), np.int64)

    def tell(self, looks: Looks, pooled: Knowledge) -> None:
        """Take in the looks of a step: the pooled knowledge has them already."""

    def adopt(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch."""
        self.knowledge = pooled
