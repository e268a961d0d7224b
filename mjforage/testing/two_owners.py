"""Exchange with two belief owners in an episode: the fewest that distinguish rows from episodes."""

from collections.abc import Set
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.base.rows import scatter_all
from mjforage.base.views import CachedViews, read_only
from mjforage.mission.knowledge import Knowledge, Scans, receive
from mjforage.mission.task import Task, no_delayed_scans

OWNERS = 2


class TwoOwners:
    """Agents of even and of odd number receive only one another, and act by what they received."""

    uses: Set[str] = frozenset()
    owners = OWNERS
    link_log = None

    def __init__(self) -> None:
        self._lent = CachedViews[Knowledge]()

    @property
    def knowledge(self) -> Knowledge:
        """Knowledge of both owners."""
        return self._lent.of(self._knowledge)

    def reset(self, task: Task, scans: Scans, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes with the scans of step 0."""
        self._task = task
        self.delayed = read_only(no_delayed_scans(scans.step.size * OWNERS))
        self.owner_of = read_only(np.arange(len(task.fleet), dtype=np.int64) % OWNERS)
        self._knowledge = Knowledge.of_starts(scans, len(task.graph), OWNERS)
        self.update(scans, pooled)

    def update(self, scans: Scans, pooled: Knowledge) -> None:
        """Take in the scans of a step."""
        own = self.owner_of == np.arange(OWNERS)[:, None]
        received = np.tile(own, (scans.step.size, 1))
        receive(scans, received, self._task.views, self._task.radius_number, self._knowledge)

    def replace_episodes(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch by those of another."""
        own = (rows[:, None] * OWNERS + np.arange(OWNERS)).reshape(-1)
        self._knowledge = scatter_all(self._knowledge, own, other._knowledge)
