"""Traffic over the links; undefined without a link."""

from typing import ClassVar

import numpy as np

from mjforage import metrics
from mjforage.mission.mission import Mission
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric, StepView, TimeMean


@metric
class Contact(TimeMean):
    """Pairs of agents in reach of each other, of all; time mean.

    `docs/concepts/metrics.md`. In reach is also a pair whose link is bad now, and loses all.
    """

    key, label, better, compared, top = "contact", "Contact", 1, False, 1.0
    least, most = 0.0, 1.0

    @classmethod
    def is_defined(cls, mission: Mission) -> bool:
        """True if there is a link."""
        return mission.exchange.link_log is not None

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        link = view.mission.exchange.link_log
        assert link is not None  # where it is, nothing is taken
        return metrics.contact_share(link.contact[view.episodes])


class Total(Metric):
    """Sum over an episode of a count in the links' log.

    Attributes
    ----------
    counted : field of `LinkLog`
    """

    counted: ClassVar[str]
    digits, compared, drawn = 0, False, False
    least = 0.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        link = batch.log.link
        if link is None:
            return np.full(batch.log.length.size, np.nan)
        return np.asarray(getattr(link, self.counted), np.float64)


@metric
class Delivered(Total):
    """Scans of others that agents have received, once for each sender and receiver."""

    key, label, unit, counted = "delivered", "Delivered", "scans", "delivered"


@metric
class Lost(Total):
    """Scans that were sent and not received, once for each sender, receiver and decision."""

    key, label, unit, better, counted = "lost", "Lost", "scans", -1, "lost"


@metric
class Dropped(Total):
    """Scans that an agent in reach lacked and that exceeded a sender's budget, in every
    decision anew.
    """

    key, label, unit, better, counted = "dropped", "Dropped", "scans", -1, "dropped"


@metric
class BytesSent(Total):
    """Bytes that all agents sent; a scan for several receivers is sent once."""

    key, label, unit, better, counted = "bytes_sent", "Bytes_sent", "B", -1, "bytes"
