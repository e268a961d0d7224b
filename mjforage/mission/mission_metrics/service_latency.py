"""Discovery-to-Service Latency."""

from mjforage import metrics
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class ServiceLatency(Metric):
    """Steps from a scout's discovery of an item to its removal, over T.

    Paper, "Inter-team metrics", DSL.
    """

    key, label, better, compared = "dsl", "DSL", -1, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) mean over the items [of T]."""
        return metrics.mean_dsl(batch.events, batch.fleet.discoverers, batch.horizon)
