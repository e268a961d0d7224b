"""Coverage Overlap within each team."""

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric, StepView


def _overlap(view: StepView, team: NDArray[np.int64]) -> FloatArray:
    """(open,) nodes that at least two of a team see, of those that one sees."""
    return metrics.coverage_overlap(view.mission.times_seen(team, view.episodes))


@metric
class OverlapOfScouts(Metric):
    """Nodes that at least two scouts see, of those that one sees; time mean.

    Paper, "Intra-team metrics", CO.
    """

    key, label, better = "co_scouts", "CO_scouts", -1
    compared, top = False, 0.0

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return _overlap(view, view.mission.setup.fleet.discoverers)

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        return np.asarray(batch.course(OverlapOfScouts).mean(axis=1))


@metric
class OverlapOfForagers(Metric):
    """Nodes that at least two foragers see, of those that one sees; time mean.

    Paper, "Intra-team metrics", CO.
    """

    key, label, better = "co_foragers", "CO_foragers", -1
    compared, top = False, 0.0

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return _overlap(view, view.mission.setup.fleet.collectors)

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        return np.asarray(batch.course(OverlapOfForagers).mean(axis=1))
