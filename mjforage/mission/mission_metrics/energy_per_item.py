"""What an item costs the fleet."""

import numpy as np

from mjforage.metrics.statistics import count
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class EnergyPerItem(Metric):
    """Way of all agents over the items removed, in node lengths, as a role's `energy` is counted.

    Our own: the paper has no metric of effort. A diagonal move is the square root of 2 long, and a
    hull's way is the one that it makes. Undefined where nothing was removed.
    """

    key, label, unit, better, digits = "energy_per_item", "Energy", "node/item", -1, 2
    compared, drawn = False, False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [node/item]."""
        log = batch.log
        way = log.energy[np.arange(log.length.size), log.length].sum(axis=1, dtype=np.float64)
        removed = count(batch.events.collected_at)
        return np.where(removed > 0, way / np.maximum(removed, 1), np.nan)
