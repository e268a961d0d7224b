"""Distributions: discovery-to-service latency per item and inter-team lag per episode."""

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from mjforage.mission.mission_metrics import Description
from mjforage.view.page import style
from mjforage.view.page.figure import (
    WIDTH_IN,
    Panel,
    ReportFigure,
    canvas,
    joined,
    mathtext,
    undefined,
)
from mjforage.view.report.run_logs import RunLogs, Series

FloatArray = NDArray[np.float64]
GOLDEN = 0.6180339887498949  # fractional golden ratio: its multiples fill an interval evenly
LISTED = 4
VALUES = 20_000  # whose density is drawn as it is
DOTS, FIGURE_DOTS = 400, 6000  # points of a violin, and of all in a figure
MARKS = "Bar: quartiles, white dot: median"
TITLES = {"dsl": "Discovery-to-service latency", "itl": "Inter-team temporal lag"}


@dataclass(frozen=True)
class Violin:
    """One violin: the values whose density is drawn, and the points beside it."""

    values: FloatArray  # (value,)
    points: FloatArray  # (episode,)


def thinned(values: FloatArray, most: int) -> FloatArray:
    """All values, or of too many so many that are distributed alike: quantiles, evenly apart."""
    if len(values) <= most:
        return values
    return np.quantile(values, (np.arange(most) + 0.5) / most)


class Words(NamedTuple):
    """What stands around a figure."""

    name: str
    title: str
    caption: str


def item_latencies(logs: RunLogs, series: Series) -> FloatArray:
    """Return (t_c - t_d) / T of every removed item that a scout had discovered: (item,)."""
    scouts = [i for i, collects in enumerate(logs.collects()) if not collects]
    rows = logs.items_of(series).filter(
        pl.col("t_collected").is_not_null() & pl.col("discovered_by").is_in(scouts)
    )
    gaps = rows.select(pl.col("t_collected") - pl.col("t_discovered")).to_series()
    return gaps.cast(pl.Float64).to_numpy() / logs.run.horizon


def _draw(
    axes: Axes, place: float, width: float, violin: Violin, colour: str, line: style.Line, dots: int
) -> None:
    values = thinned(violin.values, VALUES)
    if len(values) > 2 and np.ptp(values) > 0:
        parts = axes.violinplot([values], [place], widths=width, showextrema=False, points=200)
        for body in cast("list[PolyCollection]", parts["bodies"]):
            body.set(alpha=None, linewidth=1.3, linestyle=line)
            body.set(facecolor=(*to_rgb(colour), 0.2), edgecolor=colour)
    points = thinned(violin.points, dots)
    spread = (np.arange(len(points)) * GOLDEN % 1.0 - 0.5) * 0.34 * width
    axes.scatter(place + spread, points, s=9, color=colour, alpha=0.55, linewidths=0, zorder=3)
    low, middle, high = np.quantile(violin.values, [0.25, 0.5, 0.75])
    axes.plot(
        [place, place],
        [low, high],
        color=style.INK,
        linewidth=4.5,
        zorder=4,
        alpha=0.85,
        solid_capstyle="butt",
    )
    axes.plot(
        place, middle, "o", color="white", markeredgecolor=style.INK, markersize=5.5, zorder=5
    )


def _violins(axes: Axes, logs: RunLogs, violins: dict[Series, Violin], words: str) -> None:
    policies, worlds = logs.policies, logs.run.worlds
    looks, lines = style.policy_styles(policies), style.world_lines(worlds)
    width = 0.8 / len(worlds)
    for (world, policy), violin in violins.items():
        offset = (worlds.index(world) - (len(worlds) - 1) / 2) * width
        if len(violin.values):
            place = policies.index(policy) + offset
            _draw(
                axes, place, 0.92 * width, violin, looks[policy].colour, lines[world], dots_of(logs)
            )
    if not any(len(violin.values) for violin in violins.values()):
        undefined(axes, mathtext(words), "is undefined in every episode")
    crowded = len(policies) * max(len(name) for name in policies) > 44
    axes.set_xticks(range(len(policies)), policies)
    axes.tick_params(axis="x", rotation=35 if crowded else 0, length=0)
    if crowded:
        for label in axes.get_xticklabels():
            label.set(horizontalalignment="right", rotation_mode="anchor")
    axes.set_xlim(-0.6, len(policies) - 0.4)
    axes.grid(axis="x", visible=False)


def dots_of(logs: RunLogs) -> int:
    """How many episodes a violin shows as points."""
    return max(10, min(DOTS, FIGURE_DOTS // len(logs.series)))


def _thinned_words(logs: RunLogs) -> str:
    """What is said of points that are left out."""
    dots = dots_of(logs)
    if logs.run.episodes <= dots:
        return ""
    return f" Of {logs.run.episodes} episodes {dots} points, evenly spaced quantiles, are drawn."


def _counts(logs: RunLogs, violins: dict[Series, Violin], what: str) -> str:
    several = len(logs.run.worlds) > 1
    listed = [
        f"{len(v.values)} ({s[1]}{', ' + s[0] if several else ''})" for s, v in violins.items()
    ]
    if len(listed) > LISTED:
        sizes = [len(v.values) for v in violins.values()]
        span = f"{min(sizes)} to {max(sizes)}" if min(sizes) < max(sizes) else f"{max(sizes)}"
        return f"Defined for {span} {what} per policy."
    return f"Defined for {joined(listed)} {what}."


def _figure(
    logs: RunLogs, violins: dict[Series, Violin], axis: str, unit: str, words: Words
) -> ReportFigure:
    figure = canvas(WIDTH_IN, 3.55)
    axes = figure.subplots()
    _violins(axes, logs, violins, axis)
    axes.set_ylabel(mathtext(axis) + (f"  [{unit}]" if unit else ""))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    if len(logs.run.worlds) > 1:
        Panel((), logs.run.worlds).legend(figure)
    return ReportFigure(words.name, words.title, words.caption, figure)


def _defined(values: FloatArray) -> FloatArray:
    return values[np.isfinite(values)]


def distribution_figures(logs: RunLogs) -> list[ReportFigure]:
    """Draw the latency of the items, and each metric that has no course and is to be drawn."""
    drawn = [
        one
        for one in logs.metrics.values()
        if one.drawn and not one.course and one.key != "dsl" and logs.defined(one.key)
    ]
    return [_latency(logs), *(_of_episodes(logs, one) for one in drawn)]


def _latency(logs: RunLogs) -> ReportFigure:
    violins = {
        s: Violin(item_latencies(logs, s), _defined(logs.scalar(s, "dsl"))) for s in logs.series
    }
    caption = (
        f"{_counts(logs, violins, 'items')} Violin: every item that a scout discovered and a "
        f"forager removed; points: means of the episodes. {MARKS}, of the items. DSL: steps "
        f"from discovery to removal, over T.{_thinned_words(logs)}"
    )
    words = Words("dsl", TITLES["dsl"], caption)
    return _figure(logs, violins, "DSL", "of horizon $T$", words)


def _of_episodes(logs: RunLogs, metric: Description) -> ReportFigure:
    values = {s: _defined(logs.scalar(s, metric.key)) for s in logs.series}
    violins = {s: Violin(found, found) for s, found in values.items()}
    caption = (
        f"{_counts(logs, violins, 'episodes')} Violin and points: episodes. {MARKS}. "
        f"{metric.label}: {metric.definition}.{_thinned_words(logs)}"
    )
    title = TITLES.get(metric.key, f"{metric.plain} of the episodes")
    name = metric.key if metric.key in TITLES else f"metric-{metric.key.replace('_', '-')}"
    words = Words(name, title, caption)
    return _figure(logs, violins, metric.label, metric.unit, words)
