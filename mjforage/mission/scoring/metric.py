"""The base of a mission's metrics: its name, unit, direction and formula, in one class.

A metric gives a number per episode. It may also have a time series (a number per step), which is a
column of `steps.parquet` and a curve of the report.
"""

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.cached import Cache
from mjforage.base.errors import UserError
from mjforage.base.fields import Within
from mjforage.base.views import read_only
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.mission import Mission
from mjforage.scenario.roles import Fleet

FloatArray = NDArray[np.float64]
_T = TypeVar("_T", bound=np.generic)
End = float | Literal["horizon"] | None


class StepView(Cache):
    """A mission after its start or a step, as a time series that is taken live sees it.

    Attributes
    ----------
    mission : Mission, its arrays are live and read-only
    episodes : (open,) rows of the batch that were not over before this step
    """

    def __init__(self, mission: Mission, episodes: NDArray[np.int64]) -> None:
        super().__init__()
        self.mission, self.episodes = mission, episodes

    def of_open(self, values: NDArray[_T]) -> NDArray[_T]:
        """(open, ...) of values (episode, ...), without a copy as long as all are open."""
        whole = len(self.episodes) == len(values)
        return values if whole else values[self.episodes]


class Batch(Cache):
    """A batch that is over, as a metric's formula sees it.

    Attributes
    ----------
    log : EpisodeLog
    fleet : Fleet, whose indices the log's agents are
    horizon : T [step]
    """

    def __init__(
        self, log: EpisodeLog, fleet: Fleet, horizon: int, recorded: Mapping[str, FloatArray]
    ) -> None:
        """Prepare.

        Parameters
        ----------
        recorded : series_key -> (episode, T + 1) of what was taken live
        """
        super().__init__()
        self.log, self.fleet, self.horizon = log, fleet, horizon
        self._series = {key: read_only(series) for key, series in recorded.items()}

    @cached_property
    def events(self) -> metrics.EventTable:
        """The items' events: (episode, item)."""
        return self.log.event_table()

    def series(self, metric: "type[Metric]") -> FloatArray:
        """(episode, T + 1) the time series of a metric; one taken live goes on with its last value.

        Raises
        ------
        UserError
            If it is taken live and the metric is not one of the run's.
        """
        key = metric.series_name()
        if key not in self._series:
            if metric.is_live():
                raise UserError(
                    f"metric {metric.key}: its time series is missing; add it to the run's metrics"
                )
            self._series[key] = read_only(metric().series(self))
        return self._series[key]


class Metric:
    """Base of every metric of a mission. The first paragraph of its docstring is its definition.

    A class gives `value`, or a time series that ends in it: `series` of the finished batch, or live
    `at`. Undefined numbers are NaN; infinite ones are refused.

    Attributes
    ----------
    key : column of `episodes.parquet` and key of `summary.json`
    label : in tables and figures; an underscore begins a subscript, as in `PTA_D`
    unit : "" for none
    better : 1 more is better, -1 less is better, 0 neither
    digits : decimals shown
    on_request : True if a run takes it only where it is named, though it is ours
    compared : True if policies are compared in it, pair by pair
    drawn : True if its distribution is drawn, where it has no series
    least, most : ends of its values, of which intervals need the worse one; None: no end is known,
        "horizon": that of the mission. Where values may lie beyond, a convention
    series_key, series_label : of the column of `steps.parquet`; as `key` and `label` if empty
    top : end of the series's axis, which then starts at 0; 0 for the largest value; None: free
    """

    key: ClassVar[str]
    label: ClassVar[str]
    unit: ClassVar[str] = ""
    better: ClassVar[int] = 0
    digits: ClassVar[int] = 3
    on_request: ClassVar[bool] = False
    compared: ClassVar[bool] = True
    drawn: ClassVar[bool] = True
    least: ClassVar[float | None] = None
    most: ClassVar[End] = None
    series_key: ClassVar[str] = ""
    series_label: ClassVar[str] = ""
    top: ClassVar[float | None] = None

    def value(self, batch: Batch) -> FloatArray:
        """(episode,) the metric; unless overridden, the last value of its time series."""
        return batch.series(type(self))[:, -1]

    def series(self, batch: Batch) -> FloatArray:
        """(episode, T + 1) from a finished batch."""
        raise NotImplementedError

    def at(self, view: StepView) -> FloatArray:
        """(open,) the time series value now, for the view's episodes."""
        raise NotImplementedError

    @classmethod
    def is_defined(cls, mission: Mission) -> bool:
        """True if a live time series is defined in a mission; else it is NaN."""
        return True

    @classmethod
    def is_live(cls) -> bool:
        """True if its time series is taken while episodes run."""
        return cls.at is not Metric.at

    @classmethod
    def has_series(cls) -> bool:
        """True if it has a time series."""
        return cls.is_live() or cls.series is not Metric.series

    @classmethod
    def series_name(cls) -> str:
        """Column of its time series."""
        return cls.series_key or cls.key


class TimeMean(Metric):
    """Base of metrics whose value is the mean of their time series over the steps."""

    def value(self, batch: Batch) -> FloatArray:
        """(episode,)."""
        return np.asarray(batch.series(type(self)).mean(axis=1))


@dataclass(frozen=True)
class Description:
    """Display of a metric, without its formula; `run.json` has one of each of the run's.

    Attributes
    ----------
    series, series_label : key and label of its column of `steps.parquet`, "" if it has none
    others : as of `Metric`; `definition` is one sentence
    """

    key: str
    label: str
    definition: str = "no description"
    unit: str = ""
    better: int = 0
    digits: Annotated[int, Within(0, 12, "decimals")] = 4
    compared: bool = True
    drawn: bool = True
    series: str = ""
    series_label: str = ""
    top: float | None = None
    least: float | None = None
    most: End = None

    def ends(self, horizon: int) -> tuple[float, float]:
        """Least and most of its values in a mission of so many steps, infinite where unknown."""
        most = horizon if self.most == "horizon" else self.most
        return -np.inf if self.least is None else self.least, np.inf if most is None else most

    @property
    def bounded(self) -> bool:
        """True if its worst value is known, without which intervals do not keep what they say."""
        ends = (self.least, self.most)
        worst = {1: ends[:1], -1: ends[1:]}.get(self.better, ends)
        return any(end is not None for end in worst)

    @property
    def plain(self) -> str:
        """Label for a terminal."""
        return self.label.replace("_", " ")

    @property
    def head(self) -> str:
        """Label of a row: with its unit, if it has one."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label


def description(metric: type[Metric]) -> Description:
    """Description of a metric."""
    words = (inspect.getdoc(metric) or "").partition("\n\n")[0]
    has, own = metric.has_series(), [f.name for f in fields(Description) if hasattr(metric, f.name)]
    told: dict[str, Any] = {name: getattr(metric, name) for name in own}
    told["definition"] = " ".join(words.split()).rstrip(".")
    told["series"] = metric.series_name() if has else ""
    told["series_label"] = (metric.series_label or metric.label) if has else ""
    return Description(**told)
