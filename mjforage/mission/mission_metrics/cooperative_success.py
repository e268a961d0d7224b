"""Cooperative Success Ratio."""

from mjforage import metrics
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class CooperativeSuccess(Metric):
    """Removed items that a scout had discovered first, of all removed.

    Paper, "Inter-team metrics", CSR; undefined before the first removal.
    """

    key, label, better, top = "csr", "CSR", 1, 1.0

    def course(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far."""
        return metrics.csr_series(batch.events, batch.fleet.discoverers, batch.horizon)
