"""Normalised Time to X: how soon a share of the items is removed."""

from mjforage import metrics
from mjforage.mission.mission_metrics.items_achieved import ItemsRemoved
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class TimeToHalf(Metric):
    """First step with half of the items removed, over T; never = 1.

    Paper, "Primary metrics", NT_X.
    """

    key, label, better, drawn = "nt50", "NT_50", -1, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.nt(batch.course(ItemsRemoved), 50.0)


@metric
class TimeToMost(Metric):
    """First step with 90 % of the items removed, over T; never = 1.

    Paper, "Primary metrics", NT_X.
    """

    key, label, better, drawn = "nt90", "NT_90", -1, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.nt(batch.course(ItemsRemoved), 90.0)
