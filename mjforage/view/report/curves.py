"""Figures over normalised time: mean of the episodes with its 95 % band, per policy and world."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from mjforage.mission.scoring import Description
from mjforage.view.page import style
from mjforage.view.page.figure import WIDTH_IN, Panel, ReportFigure, canvas, mathtext
from mjforage.view.report.cells import NORMAL_95
from mjforage.view.report.run_logs import SPEEDS, Case, FloatArray, RunLogs
from mjforage.view.report.step_means import COUNT, STD
from mjforage.view.report.words import WORDS

MARKS = 8  # on a line


@dataclass(frozen=True)
class TimeSeries:
    """A metric over time, for one world and policy. Steps where it is never defined are NaN."""

    time: FloatArray  # (step,) t / T
    mean: FloatArray  # (step,)
    half: FloatArray  # (step,) 1.96 SEM, 0 where it needs more episodes
    n: NDArray[np.int64]  # (step,) episodes where it is defined

    def draw(self, axes: Axes, look: style.PolicyStyle, line: str, place: int, among: int) -> None:
        """Draw the mean with its band, and markers apart from those of the others."""
        band = self.mean - self.half, self.mean + self.half
        axes.fill_between(self.time, *band, color=look.colour, alpha=0.16, linewidth=0)
        stride = max(1, len(self.time) // MARKS)
        axes.plot(
            self.time,
            self.mean,
            color=look.colour,
            linestyle=line,
            marker=look.marker,
            markersize=5,
            markevery=(place * stride // max(1, among), stride),
        )


class Arrangement(NamedTuple):
    """A figure that shows time series of our metrics together."""

    name: str
    title: str
    columns: tuple[str, ...]  # of steps.parquet
    words: str  # definitions


ARRANGED = tuple(
    Arrangement(**{**one, "columns": tuple(one["columns"])}) for one in WORDS["figures"]
)
"""Metrics that the report shows together; one that is in none of them has a figure of its own."""


def time_series(case: Case, key: str) -> TimeSeries:
    """Mean and 1.96 SEM of a per-step metric over the episodes in which it is defined."""
    table, horizon = case.select(case.logs.means), case.logs.run.horizon
    n = table[key + COUNT].to_numpy()
    mean = table[key].fill_null(math.nan).to_numpy()
    std = table[key + STD].fill_null(0.0).to_numpy()
    half = NORMAL_95 * std / np.sqrt(np.maximum(n, 1))
    return TimeSeries(table["step"].to_numpy() / horizon, mean, half, n)


def axis_label(metric: Description, name: str = "") -> str:
    """Label of an axis of values: name, by default the metric's, with the unit."""
    return mathtext(name or metric.label) + (f"  [{metric.unit}]" if metric.unit else "")


def _plot(axes: Axes, logs: RunLogs, panel: Panel, metric: Description) -> None:
    """Draw all cases of a run."""
    looks, lines = panel.styles(), panel.lines()
    for place, case in enumerate(logs.cases):
        look, line = looks[case.policy], lines[case.world]
        time_series(case, metric.series).draw(axes, look, line, place, len(logs.cases))
    axes.set_ylabel(axis_label(metric, metric.series_label))
    axes.set_xlim(0.0, 1.0)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    if metric.top is not None:  # from 0, with room for a curve on either end
        top = metric.top or max(float(axes.get_ylim()[1]), 1e-9)
        axes.set_ylim(-0.02 * top, 1.03 * top)


def _figure(
    logs: RunLogs, name: str, title: str, metrics: Sequence[Description], definition: str
) -> ReportFigure:
    """Draw one panel per metric, stacked above a common axis of normalised time."""
    panel = Panel(logs.policies, logs.run.worlds)
    figure = canvas(WIDTH_IN, 1.1 + 2.45 * len(metrics))
    grid = figure.subplots(len(metrics), 1, sharex=True, squeeze=False)
    for axes, metric in zip(grid[:, 0], metrics, strict=True):
        _plot(axes, logs, panel, metric)
    grid[-1, 0].set_xlabel("normalised time  $t/T$")
    panel.legend(figure)
    return ReportFigure(name, title, definition, figure)


def time_figures(logs: RunLogs) -> list[ReportFigure]:
    """Every figure over time: ours, then one per other metric; none of what is never defined, or
    of a wind or current that does not change.
    """
    defined = {
        key: metric
        for key, metric in logs.series.items()
        if key in logs.columns_of_steps
        and logs.means[key + COUNT].sum()
        and (metric not in SPEEDS or any(np.ptp(time_series(one, key).mean) for one in logs.cases))
    }
    figures = []
    for name, title, columns, words in ARRANGED:
        if shown := [defined.pop(key) for key in columns if key in defined]:
            figures.append(_figure(logs, name, title, shown, words))
    for key, metric in defined.items():
        name, title = f"series-{key.replace('_', '-')}", f"{metric.series_label} over time"
        words = f"{metric.series_label}: {metric.definition}."
        figures.append(_figure(logs, name, title, [metric], words))
    return figures
