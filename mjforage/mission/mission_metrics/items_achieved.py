"""Percentage of Target Achieved: items discovered and items removed."""

from mjforage import metrics
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class ItemsDiscovered(Metric):
    """Items discovered by anyone, of all K items.

    Paper, "Primary metrics", PTA_D.
    """

    key, label, unit, better, digits = "pta_d", "PTA_D", "%", 1, 2
    top = 100.0

    def course(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far [%]."""
        events = batch.events
        return metrics.pta_series(events.discovered_at, events.exists, batch.horizon)


@metric
class ItemsRemoved(Metric):
    """Items removed, of all K items.

    Paper, "Primary metrics", PTA_C.
    """

    key, label, unit, better, digits = "pta_c", "PTA_C", "%", 1, 2
    top = 100.0

    def course(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far [%]."""
        events = batch.events
        return metrics.pta_series(events.collected_at, events.exists, batch.horizon)
