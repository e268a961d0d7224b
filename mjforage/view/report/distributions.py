"""Distributions: discovery-to-service latency per item and inter-team lag per episode."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from mjforage.mission.scoring import Description, describe
from mjforage.view.page import style
from mjforage.view.page.figure import WIDTH_IN, Panel, ReportFigure, canvas
from mjforage.view.report.curves import axis_label
from mjforage.view.report.run_logs import Case, FloatArray, RunLogs

CROWDED = 44  # characters of policies below an axis, from which they are turned
BOX = "Box: quartiles with the median; whiskers: 5 to 95 %"
TITLES = {"dsl": "Discovery-to-service latency", "itl": "Inter-team temporal lag"}


def item_latencies(case: Case) -> FloatArray:
    """Return (t_c - t_d) / T of every removed item that a scout had discovered: (item,)."""
    scouts = [i for i, collects in enumerate(case.logs.collects()) if not collects]
    rows = case.items().filter(
        pl.col("t_collected").is_not_null() & pl.col("discovered_by").is_in(scouts)
    )
    gaps = rows.select(pl.col("t_collected") - pl.col("t_discovered")).to_series()
    return gaps.cast(pl.Float64).to_numpy() / case.logs.run.horizon


def _draw(axes: Axes, logs: RunLogs, values: Mapping[Case, FloatArray]) -> None:
    policies, worlds = logs.policies, logs.run.worlds
    lines, width = style.world_lines(worlds), 0.8 / len(worlds)
    for case, found in values.items():
        colour, line = case.look.colour, lines[case.world]
        offset = (worlds.index(case.world) - (len(worlds) - 1) / 2) * width
        edge: dict[str, Any] = {"color": colour, "linewidth": 1.3, "linestyle": line}
        axes.boxplot(
            [found],
            positions=[policies.index(case.policy) + offset],
            widths=0.8 * width,
            whis=(5, 95),
            showfliers=False,
            patch_artist=True,
            manage_ticks=False,
            boxprops=edge | {"facecolor": (*to_rgb(colour), 0.2)},
            whiskerprops=edge,
            capprops=edge,
            medianprops={"color": style.INK, "linewidth": 2.0},
        )
    crowded = len(policies) * max(len(name) for name in policies) > CROWDED
    turned: dict[str, Any] = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"}
    axes.set_xticks(range(len(policies)), policies, **(turned if crowded else {}))
    axes.tick_params(axis="x", length=0)
    axes.set_xlim(-0.6, len(policies) - 0.4)
    axes.grid(axis="x", visible=False)


def distribution_figures(logs: RunLogs) -> list[ReportFigure]:
    """Draw the latency of the items, and each metric that has no time series and is to be drawn.

    Those that no episode defines are left out.
    """
    figures = []
    if logs.defined("dsl"):
        latencies = {case: item_latencies(case) for case in logs.cases}
        shown = f"{BOX} of all items that a scout discovered and a forager removed."
        figures.append(_figure(logs, describe("dsl"), latencies, shown))
    for metric in logs.metrics.values():
        if metric.drawn and not metric.series and metric.key != "dsl" and logs.defined(metric.key):
            values = {case: case.values(metric.key) for case in logs.cases}
            defined = {case: one[np.isfinite(one)] for case, one in values.items()}
            figures.append(_figure(logs, metric, defined, f"{BOX} of the episodes."))
    return figures


def _figure(
    logs: RunLogs, metric: Description, values: Mapping[Case, FloatArray], shown: str
) -> ReportFigure:
    """Boxes of a metric, with words on what they show."""
    figure = canvas(WIDTH_IN, 3.55)
    axes = figure.subplots()
    _draw(axes, logs, values)
    axes.set_ylabel(axis_label(metric))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    if len(logs.run.worlds) > 1:
        Panel((), logs.run.worlds).legend(figure)
    title = TITLES.get(metric.key, f"{metric.plain} of the episodes")
    name = metric.key if metric.key in TITLES else f"metric-{metric.key.replace('_', '-')}"
    caption = f"{shown} {metric.label}: {metric.definition}."
    return ReportFigure(name, title, caption, figure)
