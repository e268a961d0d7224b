"""Inter-Team Temporal Lag, by both of its definitions."""

from mjforage import metrics
from mjforage.mission.mission_metrics.items_achieved import ItemsDiscovered, ItemsRemoved
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class LagOfRises(Metric):
    """Steps between the largest single-step rises of PTA_D and of PTA_C, over T.

    Paper, "Inter-team metrics", ITL, as its printed numbers were made.
    """

    key, label, compared = "itl", "ITL", False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.itl(batch.course(ItemsDiscovered), batch.course(ItemsRemoved))


@metric
class LagOfLevels(Metric):
    """Steps between the first maxima of PTA_D and of PTA_C themselves, over T.

    Paper, "Inter-team metrics", ITL, as its text says.
    """

    key, label, compared, drawn = "itl_level", "ITL_level", False, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.itl_level(batch.course(ItemsDiscovered), batch.course(ItemsRemoved))
