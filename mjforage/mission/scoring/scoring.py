"""Scoring: metrics of a mission that is played, per episode and per step."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mjforage.base.errors import UserError
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.mission import Mission, Observer
from mjforage.mission.scoring.known import chosen_metrics, series_metrics
from mjforage.mission.scoring.metric import Batch, FloatArray, Metric, StepView


@dataclass(frozen=True)
class Scores:
    """Metrics of a batch; undefined values are NaN.

    Attributes
    ----------
    metrics : whose they are
    scalars : key -> (episode,)
    series : series_key -> (episode, T + 1), padded with the last value
    """

    metrics: tuple[type[Metric], ...]
    scalars: dict[str, FloatArray]
    series: dict[str, FloatArray]


class Scorer(Observer):
    """Logs a batch while it runs, and gives its metrics at the end.

    Attributes
    ----------
    log : EpisodeLog of the batch
    metrics : that it takes
    """

    def __init__(self, mission: Mission, metrics: Sequence[type[Metric]] | None = None) -> None:
        """Prepare.

        Raises `UserError` as `chosen_metrics`.

        `metrics`: as of `chosen_metrics`; absent: ours.
        """
        self.log = EpisodeLog(mission)
        self.metrics = chosen_metrics() if metrics is None else tuple(metrics)
        self._setup = mission.setup
        self._series = series_metrics(self.metrics)
        self._live: dict[str, Metric] = {}
        self._taken: dict[str, FloatArray] = {}

    def see(self, mission: Mission) -> None:
        """Log the state and take the series that are live."""
        if not self._taken:
            self._start(mission)
        self.log.see(mission)
        view = StepView(mission, self.log.seen)
        at = (view.episodes, mission.step[view.episodes])
        for key, one in self._live.items():
            self._taken[key][at] = one.at(view)

    def _start(self, mission: Mission) -> None:
        shape = (mission.step.size, self._setup.scenario.horizon + 1)
        live = {key: one for key, one in self._series.items() if one.is_live()}
        self._taken = {key: np.full(shape, np.nan) for key in live}
        self._live = {key: one() for key, one in live.items() if one.is_defined(mission)}

    def scores(self) -> Scores:
        """The metrics of the finished batch; raises `UserError` as `score`."""
        horizon = self._setup.scenario.horizon
        ends = np.arange(self.log.length.size), self.log.length
        over = np.arange(horizon + 1) > self.log.length[:, None]
        taken = {key: np.where(over, v[ends][:, None], v) for key, v in self._taken.items()}
        return score(Batch(self.log, self._setup.fleet, horizon, taken), self.metrics)


def score(batch: Batch, metrics: Sequence[type[Metric]]) -> Scores:
    """Metrics of a batch that is over.

    Raises `UserError` if a metric gives an array of another shape, or an infinite number.
    """
    episodes = batch.log.length.size
    return Scores(
        tuple(metrics),
        {one.key: _sound(one, one().value(batch), (episodes,)) for one in metrics},
        {
            key: _sound(one, batch.series(one), (episodes, batch.horizon + 1))
            for key, one in series_metrics(metrics).items()
        },
    )


def _sound(metric: type[Metric], values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """The numbers of a metric, of the shape that they must have, and none infinite."""
    found = np.asarray(values, np.float64)
    if found.shape != shape:
        raise UserError(f"metric {metric.key}: gives shape {found.shape}, expected {shape}")
    if np.isinf(found).any():
        raise UserError(f"metric {metric.key}: gives an infinite number; use NaN for undefined")
    return found
