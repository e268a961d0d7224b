"""Two holders of knowledge in an episode: the fewest that tell rows from episodes."""

from collections.abc import Set
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.base.views import CachedViews, read_only
from mjforage.mission.knowledge import Knowledge, Looks, hear
from mjforage.mission.task import Task, nothing_late

HOLDERS = 2


class TwoHolders:
    """Agents of even and of odd number hear only one another, and act by what they heard."""

    uses: Set[str] = frozenset()
    holders = HOLDERS
    link_log = None

    def __init__(self) -> None:
        self._lent = CachedViews[Knowledge]()

    @property
    def knowledge(self) -> Knowledge:
        """What both know."""
        return self._lent.of(self._knowledge)

    def reset(self, task: Task, looks: Looks, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes with the looks of step 0."""
        self._task = task
        self.late = read_only(nothing_late(looks.step.size * HOLDERS))
        self.holder_of = read_only(np.arange(len(task.fleet), dtype=np.int64) % HOLDERS)
        self._knowledge = Knowledge.of_starts(looks, len(task.graph), HOLDERS)
        self.tell(looks, pooled)

    def tell(self, looks: Looks, pooled: Knowledge) -> None:
        """Take in the looks of a step."""
        own = self.holder_of == np.arange(HOLDERS)[:, None]
        heard = np.tile(own, (looks.step.size, 1))
        hear(looks, heard, self._task.views, self._task.radius_number, self._knowledge)

    def adopt(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch by those of another."""
        own = (rows[:, None] * HOLDERS + np.arange(HOLDERS)).reshape(-1)
        self._knowledge = self._knowledge.with_rows(own, other._knowledge)
