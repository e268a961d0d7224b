"""Gini index of what each member of a team contributes."""

from mjforage import metrics
from mjforage.mission.mission_metrics.known import metric
from mjforage.mission.mission_metrics.metric import Batch, FloatArray, Metric


@metric
class InequalityOfForagers(Metric):
    """Inequality of the items removed per forager; 0 is even.

    Paper, "Intra-team metrics", Gini; undefined before the first removal.
    """

    key, label, better = "gini_foragers", "Gini_foragers", -1
    compared, top = False, 0.0

    def course(self, batch: Batch) -> FloatArray:
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

    def course(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) so far."""
        events, team = batch.events, batch.fleet.discoverers
        return metrics.team_gini_series(
            events.discovered_at, events.discovered_by, team, batch.horizon
        )
