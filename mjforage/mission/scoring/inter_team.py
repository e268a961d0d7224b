"""Inter-team metrics: cooperative success, service latency and temporal lag."""

from mjforage import metrics
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric
from mjforage.mission.scoring.primary import ItemsDiscovered, ItemsRemoved


@metric
class CooperativeSuccess(Metric):
    """Removed items that a scout had discovered first, of all removed.

    Paper, "Inter-team metrics", CSR; undefined before the first removal.
    """

    key, label, better, top = "csr", "CSR", 1, 1.0
    least, most = 0.0, 1.0

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far."""
        return metrics.csr_series(batch.events, batch.fleet.discoverers, batch.horizon)


@metric
class ServiceLatency(Metric):
    """Steps from a scout's discovery of an item to its removal, over T.

    Paper, "Inter-team metrics", DSL.
    """

    key, label, better, compared = "dsl", "DSL", -1, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) mean over the items [of T]."""
        return metrics.mean_dsl(batch.events, batch.fleet.discoverers, batch.horizon)


@metric
class LagOfRises(Metric):
    """Steps between the largest single-step rises of PTA_D and of PTA_C, over T.

    Paper, "Inter-team metrics", ITL, as its printed numbers were made.
    """

    key, label, compared = "itl", "ITL", False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.itl(batch.series(ItemsDiscovered), batch.series(ItemsRemoved))


@metric
class LagOfLevels(Metric):
    """Steps between the first maxima of PTA_D and of PTA_C themselves, over T.

    Paper, "Inter-team metrics", ITL, as its text says.
    """

    key, label, compared, drawn = "itl_level", "ITL_level", False, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.itl_level(batch.series(ItemsDiscovered), batch.series(ItemsRemoved))
