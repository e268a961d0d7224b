"""Mean Idleness, and the rate at which it falls."""

import numpy as np

from mjforage import metrics
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric, StepView


@metric
class FinalIdleness(Metric):
    """Mean idleness of the navigable nodes at the end.

    Paper, "Primary metrics", MI. Idleness grows by 1/(0.9 T) per step and is 0 where any agent
    sees.
    """

    key, label, better = "mi_final", "MI_final", -1
    compared, least, most = False, 0.0, 1.0
    series_key, series_label, top = "mi", "MI", 1.0

    def at(self, view: StepView) -> FloatArray:
        """(open,) mean over the nodes, now."""
        return metrics.mean_idleness(view.mission.idleness(view.episodes))


@metric
class MeanIdleness(Metric):
    """Mean idleness of the navigable nodes, time mean."""

    key, label, better, drawn = "mi_mean", "MI_mean", -1, False
    least, most = 0.0, 1.0

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        return np.asarray(batch.series(FinalIdleness).mean(axis=1))


@metric
class IdlenessReductionRate(Metric):
    """Fall of the mean idleness per step, time mean.

    Paper, "Primary metrics", IRR.
    """

    key, label, better, digits = "irr_mean", "IRR_mean", 1, 5
    unit, compared, least = "1/step", False, 0.0
    series_key, series_label = "irr", "IRR"

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) fall to the next step; NaN at the last."""
        idleness = batch.series(FinalIdleness)
        fall = np.full(idleness.shape, np.nan)
        fall[:, :-1] = metrics.irr(idleness)
        return fall

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        fall = batch.series(IdlenessReductionRate)[:, :-1]
        return np.asarray(fall.mean(axis=1))
