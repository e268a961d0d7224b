"""Age of information: age of the agents' knowledge of the map."""

import numpy as np

from mjforage import metrics
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric, StepView, TimeMean


@metric
class AgeOfInformation(TimeMean):
    """Mean over the navigable nodes of the steps since a scan that the owner has received saw them,
    T if none; mean over the owners, time mean.

    `docs/concepts/metrics.md`. Without a link one owner receives all scans.
    """

    key, label, unit, better, digits = "aoi", "AoI", "steps", -1, 2
    compared, top = False, 0.0
    least, most = 0.0, "horizon"

    def at(self, view: StepView) -> FloatArray:
        """(open,) mean over the owners, now [step]."""
        mission, owners = view.mission, view.mission.exchange.owners
        now = mission.step if owners == 1 else np.repeat(mission.step, owners)
        last_seen = mission.exchange.knowledge.last_seen  # of all: copies of some take longer
        ages = metrics.age_of_information(last_seen, now, mission.task.horizon)
        if owners > 1:
            ages = ages.reshape(-1, owners).mean(axis=1)
        return ages[view.episodes]


@metric
class PeakAge(Metric):
    """Largest AoI from its lowest value on, that is, after the maps were newest.

    The first value would always be the largest, since nothing has been seen before.
    """

    key, label, unit, better, digits = "aoi_peak", "AoI_peak", "steps", -1, 2
    compared, drawn = False, False
    least, most = 0.0, "horizon"

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) [step]."""
        series = batch.series(AgeOfInformation)
        since = np.arange(series.shape[1]) >= series.argmin(axis=1)[:, None]
        return np.asarray(np.where(since, series, 0.0).max(axis=1))
