"""How an episode ends."""

import numpy as np

from mjforage.mission.mission_metrics.items_achieved import ItemsRemoved
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class Length(Metric):
    """Steps until the last item was removed, at most T."""

    key, label, unit, better, digits = "length", "Length", "steps", -1, 1
    drawn = False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [step]."""
        return batch.log.length.astype(np.float64)


@metric
class Cleared(Metric):
    """Fraction of the episodes that ended with no item left."""

    key, label, better, digits = "cleared", "Cleared", 1, 2
    compared, drawn = False, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) 1 or 0."""
        return (batch.course(ItemsRemoved)[:, -1] >= 100.0).astype(np.float64)
