"""Exchanges: which holders of knowledge hear of which agents' looks; a communication model is one.

After every step an exchange is told all looks, and brings what each holder knows up to date by
those that it hears. `Ideal`: all hear all at once; `mjforage.mission.link`: over a link.
"""

from collections.abc import Set
from typing import NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.base.views import CachedViews, read_only
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.knowledge import Knowledge, Looks
from mjforage.mission.look_log import LookLog
from mjforage.mission.task import Late, Task, nothing_late


class LinkLog(NamedTuple):
    """What went over the links of a batch so far, for metrics. Live views.

    Looks that are not heard (yet) have a step below 0 or after the end.
    """

    contact: NDArray[np.bool_]  # (episode, sender, receiver) who is in reach of whom now
    delivered: NDArray[np.int64]  # (episode,) looks that have arrived
    lost: NDArray[np.int64]  # (episode,) looks sent in vain
    lost_now: NDArray[np.int64]  # (episode, sender, receiver) of those in this step
    dropped: NDArray[np.int64]  # (episode,) looks that a budget did not suffice for
    bytes: NDArray[np.int64]  # (episode,) sent
    heard_at: NDArray[np.int16]  # (episode, listener, agent, step) when each agent hears each look
    looks: LookLog
    views: NodeLists  # whose lists the looks' places follow
    radius_number: NDArray[np.int64]  # (agent,) which of those lists


class Exchange(Protocol):
    """What holders hear, and for whom each of them holds it. One exchange serves one mission.

    Attributes
    ----------
    holder_of : (agent,) number of the holder by whose knowledge each agent acts, 0 to `holders` - 1
    holders : how many there are in an episode
    """

    holder_of: NDArray[np.int64]
    holders: int

    @property
    def knowledge(self) -> Knowledge:
        """What they know, (episode x holder) rows; not to be written to by others."""
        ...

    @property
    def uses(self) -> Set[str]:
        """Capabilities of roles for which it has rules, of `relays` and `carries`."""
        ...

    @property
    def late(self) -> Late:
        """Looks heard in this step that are older, (episode x holder) rows."""
        ...

    @property
    def link_log(self) -> LinkLog | None:
        """What went over its links; None if it has none, or keeps no account."""
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
    link_log = None

    def __init__(self) -> None:
        self._lent = CachedViews[Knowledge]()

    @property
    def knowledge(self) -> Knowledge:
        """What the fleet knows together."""
        return self._lent.of(self._pooled)

    def reset(self, task: Task, looks: Looks, pooled: Knowledge, keys: UInt64Array) -> None:
        """Start a batch of episodes."""
        self.late = read_only(nothing_late(looks.step.size))
        self.holder_of = read_only(np.zeros(len(task.fleet), np.int64))
        self._pooled = pooled

    def tell(self, looks: Looks, pooled: Knowledge) -> None:
        """Take in the looks of a step: the pooled knowledge has them already."""

    def adopt(self, rows: NDArray[np.int64], other: Self, pooled: Knowledge) -> None:
        """Replace episodes (row,) of the batch."""
        self._pooled = pooled
