"""Exchanges: the belief owners that receive each agent's scans; a communication model is one.

After every step an exchange gets all scans, and updates the knowledge of each owner by those that
it receives. `Ideal`: all receive all at once; `mjforage.mission.link`: over a link.
"""

from collections.abc import Set
from typing import NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.base.views import CachedViews, read_only
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.knowledge import Knowledge, Scans
from mjforage.mission.scan_log import ScanLog
from mjforage.mission.task import DelayedScans, Task, no_delayed_scans


class LinkLog(NamedTuple):
    """Traffic over the links of a batch so far, for metrics. Live views.

    Scans that are not received (yet) have a step below 0 or after the end.
    """

    contact: NDArray[np.bool_]  # (episode, sender, receiver) who is in reach of whom now
    delivered: NDArray[np.int64]  # (episode,) scans that have arrived
    lost: NDArray[np.int64]  # (episode,) scans sent in vain
    lost_now: NDArray[np.int64]  # (episode, sender, receiver) of those in this step
    dropped: NDArray[np.int64]  # (episode,) scans that a budget did not suffice for
    bytes: NDArray[np.int64]  # (episode,) sent
    received_at: NDArray[np.int16]  # (episode, listener, agent, step) when each scan is received
    scans: ScanLog
    views: NodeLists  # whose lists the scans' places follow
    radius_number: NDArray[np.int64]  # (agent,) which of those lists


class Exchange(Protocol):
    """Exchange of scans between belief owners. One exchange serves one mission.

    Attributes
    ----------
    owner_of : (agent,) number of the owner by whose knowledge each agent acts, 0 to `owners` - 1
    owners : number of owners in an episode
    """

    owner_of: NDArray[np.int64]
    owners: int

    @property
    def knowledge(self) -> Knowledge:
        """Knowledge of all owners, (episode x owner) rows; not to be written to by others."""
        ...

    @property
    def uses(self) -> Set[str]:
        """Capabilities of roles for which it has rules, of `relays` and `carries`."""
        ...

    @property
    def delayed(self) -> DelayedScans:
        """Scans received in this step that are older, (episode x owner) rows."""
        ...

    @property
    def link_log(self) -> LinkLog | None:
        """Traffic over its links; None if it has no links, or records no traffic."""
        ...

    def reset(self, task: Task, scans: Scans, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes with the scans of step 0.

        All that is written to is new: after it, a shallow copy has nothing of the original's.

        Parameters
        ----------
        pooled : knowledge of an owner that receives all scans at once, one row per episode; live
        keys : (episode,) of the episodes, for what is drawn
        """
        ...

    def update(self, scans: Scans, pooled: Knowledge) -> None:
        """Take in the scans of a step; knowledge of inactive episodes does not change."""
        ...

    def replace_episodes(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch by those of another exchange of the same kind."""
        ...


class Ideal:
    """Ideal link: one belief owner, which receives all scans at once."""

    uses: Set[str] = frozenset()
    owners = 1
    link_log = None

    def __init__(self) -> None:
        self._views = CachedViews[Knowledge]()

    @property
    def knowledge(self) -> Knowledge:
        """Common knowledge of the fleet."""
        return self._views.of(self._pooled)

    def reset(self, task: Task, scans: Scans, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes."""
        self.delayed = read_only(no_delayed_scans(scans.step.size))
        self.owner_of = read_only(np.zeros(len(task.fleet), np.int64))
        self._pooled = pooled

    def update(self, scans: Scans, pooled: Knowledge) -> None:
        """Take in the scans of a step: the pooled knowledge has them already."""

    def replace_episodes(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch."""
        self._pooled = pooled
