"""Primary metrics: items achieved, time to a share, throughput, and how an episode ends."""

import numpy as np

from mjforage import metrics
from mjforage.metrics.statistics import count
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric

MOST = 90.0
"""Share of the items that counts as most of them [%]."""


@metric
class ItemsDiscovered(Metric):
    """Items discovered by anyone, of all K items.

    Paper, "Primary metrics", PTA_D.
    """

    key, label, unit, better, digits = "pta_d", "PTA_D", "%", 1, 2
    least, most, top = 0.0, 100.0, 100.0

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far [%]."""
        events = batch.events
        return metrics.pta_series(events.discovered_at, events.exists, batch.horizon)


@metric
class ItemsRemoved(Metric):
    """Items removed, of all K items.

    Paper, "Primary metrics", PTA_C.
    """

    key, label, unit, better, digits = "pta_c", "PTA_C", "%", 1, 2
    least, most, top = 0.0, 100.0, 100.0

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far [%]."""
        events = batch.events
        return metrics.pta_series(events.collected_at, events.exists, batch.horizon)


@metric
class TimeToHalf(Metric):
    """First step with half of the items removed, over T; never = 1.

    Paper, "Primary metrics", NT_X.
    """

    key, label, better, drawn = "nt50", "NT_50", -1, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.nt(batch.series(ItemsRemoved), 50.0)


@metric
class TimeToMost(Metric):
    """First step with 90 % of the items removed, over T; never = 1.

    Paper, "Primary metrics", NT_X.
    """

    key, label, better, drawn = "nt90", "NT_90", -1, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [of T]."""
        return metrics.nt(batch.series(ItemsRemoved), MOST)


@metric
class RemovedPerForager(Metric):
    """Items removed per forager and step of the horizon.

    Paper, "Primary metrics", Throughput.
    """

    key, label, unit, better, drawn = "throughput", "Throughput", "items/step", 1, False
    least = 0.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [item/step]."""
        foragers = batch.fleet.collectors.size
        return metrics.throughput(batch.events.collected_at, foragers, batch.horizon)


@metric
class DiscoveredPerScout(Metric):
    """Items discovered per scout and step of the horizon."""

    key, label, unit = "throughput_scouts", "Throughput_scouts", "items/step"
    better, drawn, least = 1, False, 0.0
    compared = False

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [item/step]."""
        scouts = batch.fleet.discoverers.size
        return metrics.throughput(batch.events.discovered_at, scouts, batch.horizon)


@metric
class Length(Metric):
    """Steps until the last item was removed, at most T."""

    key, label, unit, better, digits = "length", "Length", "steps", -1, 1
    drawn, least, most = False, 0.0, "horizon"

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [step]."""
        return batch.log.length.astype(np.float64)


@metric
class Cleared(Metric):
    """Fraction of the episodes that ended with no item left."""

    key, label, better, digits = "cleared", "Cleared", 1, 2
    compared, drawn = False, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) 1 or 0."""
        return (batch.series(ItemsRemoved)[:, -1] >= 100.0).astype(np.float64)


@metric
class BelowMost(Metric):
    """Fraction of the episodes that ended with less than 90 % of the items removed."""

    key, label, better, digits = "below_90", "Below_90", -1, 2
    compared, drawn = False, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) 1 or 0."""
        return (batch.series(ItemsRemoved)[:, -1] < MOST).astype(np.float64)


@metric
class EnergyPerItem(Metric):
    """Way of all agents over the items removed, in node lengths, as a role's `energy` is counted.

    Our own: the paper has no metric of effort. A diagonal move is the square root of 2 long, and a
    hull's way is the one that it makes. Undefined where nothing was removed.
    """

    key, label, unit, better, digits = "energy_per_item", "Energy", "node/item", -1, 2
    compared, drawn, least = False, False, 0.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [node/item]."""
        log = batch.log
        way = log.energy[np.arange(log.length.size), log.length].sum(axis=1, dtype=np.float64)
        removed = count(batch.events.collected_at)
        return np.where(removed > 0, way / np.maximum(removed, 1), np.nan)
