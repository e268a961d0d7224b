"""Intra-team metrics: inequality of contributions and coverage overlap."""

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric, StepView, TimeMean


@metric
class InequalityOfForagers(Metric):
    """Inequality of the items removed per forager; 0 is even.

    Paper, "Intra-team metrics", Gini; undefined before the first removal.
    """

    key, label, better = "gini_foragers", "Gini_foragers", -1
    compared, top = False, 0.0
    least, most = 0.0, 1.0

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far."""
        events, team = batch.events, batch.fleet.collectors
        return metrics.team_gini_series(
            events.collected_at, events.collected_by, team, batch.horizon
        )


@metric
class InequalityOfScouts(Metric):
    """Inequality of the items discovered per scout; 0 is even.

    Paper, "Intra-team metrics", Gini; undefined before the first discovery.
    """

    key, label, better = "gini_scouts", "Gini_scouts", -1
    compared, top = False, 0.0
    least, most = 0.0, 1.0

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far."""
        events, team = batch.events, batch.fleet.discoverers
        return metrics.team_gini_series(
            events.discovered_at, events.discovered_by, team, batch.horizon
        )


def _overlap(view: StepView, team: NDArray[np.int64]) -> FloatArray:
    """(open,) nodes that at least two of a team see, of those that one sees."""
    return metrics.coverage_overlap(view.mission.times_seen(team, view.episodes))


@metric
class OverlapOfScouts(TimeMean):
    """Nodes that at least two scouts see, of those that one sees; time mean.

    Paper, "Intra-team metrics", CO.
    """

    key, label, better = "co_scouts", "CO_scouts", -1
    compared, top = False, 0.0
    least, most = 0.0, 1.0

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return _overlap(view, view.mission.setup.fleet.discoverers)


@metric
class OverlapOfForagers(TimeMean):
    """Nodes that at least two foragers see, of those that one sees; time mean.

    Paper, "Intra-team metrics", CO.
    """

    key, label, better = "co_foragers", "CO_foragers", -1
    compared, top = False, 0.0
    least, most = 0.0, 1.0

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return _overlap(view, view.mission.setup.fleet.collectors)
