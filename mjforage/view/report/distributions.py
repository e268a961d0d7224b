"""Distributions: discovery-to-service latency per item and inter-team lag per episode."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from mjforage.mission.scoring import Description, describe
from mjforage.view.page import style
from mjforage.view.page.figure import (
    WIDTH_IN,
    Panel,
    ReportFigure,
    canvas,
    mathtext,
    undefined,
)
from mjforage.view.report.run_logs import Case, FloatArray, RunLogs

GOLDEN = 0.6180339887498949  # fractional golden ratio: its multiples fill an interval evenly
VALUES = 20_000  # whose density is drawn as it is
DOTS, FIGURE_DOTS = 400, 6000  # points of a violin, and of all in a figure
MARKS = "Bar: quartiles, white dot: median"
TITLES = {"dsl": "Discovery-to-service latency", "itl": "Inter-team temporal lag"}


@dataclass(frozen=True)
class Violin:
    """One violin: the values whose density is drawn, and the points beside it."""

    values: FloatArray  # (value,)
    points: FloatArray  # (episode,)

    def draw(
        self, axes: Axes, place: float, width: float, look: tuple[str, str], dots: int
    ) -> None:
        """Draw it, of a colour and a line style, with at most so many points."""
        colour, line = look
        values = thinned(self.values, VALUES)
        if len(values) > 2 and np.ptp(values) > 0:
            parts = axes.violinplot([values], [place], widths=width, showextrema=False, points=200)
            for body in cast("list[PolyCollection]", parts["bodies"]):
                body.set(alpha=None, linewidth=1.3, linestyle=line)
                body.set(facecolor=(*to_rgb(colour), 0.2), edgecolor=colour)
        points = thinned(self.points, dots)
        spread = (np.arange(len(points)) * GOLDEN % 1.0 - 0.5) * 0.34 * width
        axes.scatter(place + spread, points, s=9, color=colour, alpha=0.55, linewidths=0, zorder=3)
        low, middle, high = np.quantile(self.values, [0.25, 0.5, 0.75])
        axes.vlines(place, low, high, color=style.INK, linewidth=4.5, zorder=4, alpha=0.85)
        axes.plot(
            place, middle, "o", color="white", markeredgecolor=style.INK, markersize=5.5, zorder=5
        )


def thinned(values: FloatArray, most: int) -> FloatArray:
    """All values, or of too many so many that are distributed alike: quantiles, evenly apart."""
    if len(values) <= most:
        return values
    return np.quantile(values, (np.arange(most) + 0.5) / most)


def item_latencies(case: Case) -> FloatArray:
    """Return (t_c - t_d) / T of every removed item that a scout had discovered: (item,)."""
    scouts = [i for i, collects in enumerate(case.logs.collects()) if not collects]
    rows = case.items().filter(
        pl.col("t_collected").is_not_null() & pl.col("discovered_by").is_in(scouts)
    )
    gaps = rows.select(pl.col("t_collected") - pl.col("t_discovered")).to_series()
    return gaps.cast(pl.Float64).to_numpy() / case.logs.run.horizon


def _draw(axes: Axes, logs: RunLogs, violins: Mapping[Case, Violin]) -> None:
    policies, worlds = logs.policies, logs.run.worlds
    looks, lines = style.policy_styles(policies), style.world_lines(worlds)
    width = 0.8 / len(worlds)
    for case, violin in violins.items():
        offset = (worlds.index(case.world) - (len(worlds) - 1) / 2) * width
        if len(violin.values):
            look = looks[case.policy].colour, lines[case.world]
            place = policies.index(case.policy) + offset
            violin.draw(axes, place, 0.92 * width, look, dots_of(logs))
    crowded = len(policies) * max(len(name) for name in policies) > 44
    turned: dict[str, Any] = (
        {"rotation": 35, "ha": "right", "rotation_mode": "anchor"} if crowded else {}
    )
    axes.set_xticks(range(len(policies)), policies, **turned)
    axes.tick_params(axis="x", length=0)
    axes.set_xlim(-0.6, len(policies) - 0.4)
    axes.grid(axis="x", visible=False)


def dots_of(logs: RunLogs) -> int:
    """Number of episodes that a violin shows as points."""
    return max(10, min(DOTS, FIGURE_DOTS // len(logs.cases)))


def _defined(values: FloatArray) -> FloatArray:
    return values[np.isfinite(values)]


def distribution_figures(logs: RunLogs) -> list[ReportFigure]:
    """Draw the latency of the items, and each metric that has no time series and is to be drawn."""
    drawn = [
        one
        for one in logs.metrics.values()
        if one.drawn and not one.series and one.key != "dsl" and logs.defined(one.key)
    ]
    return [_latency(logs), *(_of_episodes(logs, one) for one in drawn)]


def _figure(
    logs: RunLogs, metric: Description, violins: Mapping[Case, Violin], shown: str
) -> ReportFigure:
    """Violins of a metric, with words on what they show."""
    figure = canvas(WIDTH_IN, 3.55)
    axes = figure.subplots()
    _draw(axes, logs, violins)
    if not any(len(violin.values) for violin in violins.values()):
        undefined(axes, mathtext(metric.label), "is undefined in every episode")
    axes.set_ylabel(mathtext(metric.label) + (f"  [{metric.unit}]" if metric.unit else ""))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    if len(logs.run.worlds) > 1:
        Panel((), logs.run.worlds).legend(figure)
    caption = f"{shown} {metric.label}: {metric.definition}."
    dots = dots_of(logs)
    if logs.run.episodes > dots:
        many = f"Of {logs.run.episodes} episodes {dots} points, evenly spaced quantiles, are drawn."
        caption = f"{caption} {many}"
    title = TITLES.get(metric.key, f"{metric.plain} of the episodes")
    name = metric.key if metric.key in TITLES else f"metric-{metric.key.replace('_', '-')}"
    return ReportFigure(name, title, caption, figure)


def _latency(logs: RunLogs) -> ReportFigure:
    violins = {
        case: Violin(item_latencies(case), _defined(case.values("dsl"))) for case in logs.cases
    }
    shown = (
        "Violin: every item that a scout discovered and a forager removed; points: means of the "
        f"episodes. {MARKS}, of the items."
    )
    return _figure(logs, describe("dsl"), violins, shown)


def _of_episodes(logs: RunLogs, metric: Description) -> ReportFigure:
    values = {case: _defined(case.values(metric.key)) for case in logs.cases}
    violins = {case: Violin(found, found) for case, found in values.items()}
    return _figure(logs, metric, violins, f"Violin and points: episodes. {MARKS}.")
