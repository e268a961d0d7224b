"""Differences between the agents' knowledge; undefined where all share one map."""

from typing import ClassVar

from mjforage import metrics
from mjforage.mission.mission import Mission
from mjforage.mission.scoring.belief_error import WORST, errors
from mjforage.mission.scoring.known import metric
from mjforage.mission.scoring.metric import Batch, End, FloatArray, Metric, StepView, TimeMean


def _unlikeness(view: StepView) -> tuple[FloatArray, FloatArray]:
    """Disagreement and error of the owners' maps, (open,) each."""
    mission, owners = view.mission, view.mission.exchange.owners
    belief = mission.exchange.knowledge.belief
    return metrics.unlikeness(
        view.of_open(mission.knowledge.belief),
        view.of_open(belief.reshape(-1, owners, belief.shape[1])),
        view.of_open(mission.ledger.truth),
        view.cached(errors)[0],
        mission.setup.grid.navigable,
    )


class OfOwners(TimeMean):
    """Metric of several belief owners: time mean of a time series."""

    better, compared, top, least = -1, False, 0.0, 0.0
    most: ClassVar[End] = WORST

    @classmethod
    def is_defined(cls, mission: Mission) -> bool:
        """True if there are several."""
        return mission.exchange.owners > 1


@metric
class PositionAge(OfOwners):
    """Steps since the newest position that an agent has received a team-mate, mean over both, time
    mean.

    `docs/concepts/metrics.md`. What it knows of itself does not count.
    """

    key, label, unit, digits = "position_age", "PA", "steps", 2
    most = "horizon"

    def at(self, view: StepView) -> FloatArray:
        """(open,) now [step]."""
        exchange, step = view.mission.exchange, view.mission.step[view.episodes]
        seen = exchange.knowledge.agent_seen
        each = view.of_open(seen.reshape(-1, exchange.owners, seen.shape[1]))
        return metrics.position_age(each[:, exchange.owner_of], step)


@metric
class Disagreement(OfOwners):
    """RMSE between the maps of two owners, both smoothed as for RMSE; mean over the pairs, time
    mean.

    `docs/concepts/metrics.md`.
    """

    key, label, unit, digits = "disagreement", "Disagreement", "items/node", 4

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return view.cached(_unlikeness)[0]


@metric
class ErrorOfOwners(OfOwners):
    """RMSE of the map by which an agent acts, mean over the owners; RMSE itself is that of the map
    from all scans together.

    At the end, as RMSE is.
    """

    key, label, unit, digits = "rmse_holders", "RMSE_holders", "items/node", 4

    def at(self, view: StepView) -> FloatArray:
        """(open,) now."""
        return view.cached(_unlikeness)[1]

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        return Metric.value(self, batch)
