"""Throughput of each kind of agent."""

from mjforage import metrics
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class RemovedPerForager(Metric):
    """Items removed per forager and step of the horizon.

    Paper, "Primary metrics", Throughput.
    """

    key, label, unit, better, drawn = "throughput", "Throughput", "items/step", 1, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [item/step]."""
        foragers = batch.fleet.collectors.size
        return metrics.throughput(batch.events.collected_at, foragers, batch.horizon)


@metric
class DiscoveredPerScout(Metric):
    """Items discovered per scout and step of the horizon."""

    key, label, unit = "throughput_scouts", "Throughput_scouts", "items/step"
    better, drawn = 1, False
    compared = False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [item/step]."""
        scouts = batch.fleet.discoverers.size
        return metrics.throughput(batch.events.discovered_at, scouts, batch.horizon)
