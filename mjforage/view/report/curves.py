"""Figures over normalised time: mean of the episodes with its 95 % band, per policy and world."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from mjforage.core.vocabulary import describe
from mjforage.view.report.picture import WIDTH_IN, Panel, Picture, canvas, joined, undefined
from mjforage.view.report.published import published_for
from mjforage.view.report.run_logs import RunLogs, Series
from mjforage.view.report.text_tables import number

FloatArray = NDArray[np.float64]
LISTED = 4  # name every policy in a caption up to this many


@dataclass(frozen=True)
class Course:
    """A metric over time, for one world and policy. Steps where it is never defined are NaN."""

    time: FloatArray  # (step,) t / T
    mean: FloatArray  # (step,)
    half: FloatArray  # (step,) 1.96 SEM, 0 where it needs more episodes
    n: NDArray[np.int64]  # (step,) episodes where it is defined


@dataclass(frozen=True)
class Curve:
    """One panel: a column of `steps.parquet` with its axis label."""

    key: str
    axis: str  # axis label, mathtext allowed
    words: str  # the same in plain words, for captions
    digits: int = 3
    top: float | None = (
        None  # end of the axis that starts at 0; 0 for the largest value, None: free
    )
    unit: str = ""
    ending: bool = True  # whether the caption tells where it ends


def course(logs: RunLogs, series: Series, key: str) -> Course:
    """Mean and 1.96 SEM of a per-step metric over the episodes in which it is defined."""
    table = (
        logs.select(logs.steps, series)
        .group_by("step")
        .agg(
            pl.col(key).mean().alias("mean"),
            pl.col(key).std(ddof=1).alias("std"),
            pl.col(key).count().alias("n"),
        )
        .sort("step")
    )
    n = table["n"].cast(pl.Int64).to_numpy()
    mean = table["mean"].fill_null(math.nan).to_numpy()
    std = table["std"].fill_null(0.0).to_numpy()
    time = table["step"].cast(pl.Float64).to_numpy() / logs.run.horizon
    return Course(time, mean, 1.96 * std / np.sqrt(np.maximum(n, 1)), n)


def _plot(axes: Axes, logs: RunLogs, panel: Panel, curve: Curve) -> dict[Series, Course]:
    looks, lines = panel.looks(), panel.lines()
    courses = {series: course(logs, series, curve.key) for series in logs.series}
    for place, ((world, policy), line) in enumerate(courses.items()):
        look = looks[policy]
        axes.fill_between(
            line.time,
            line.mean - line.half,
            line.mean + line.half,
            color=look.colour,
            alpha=0.16,
            linewidth=0,
        )
        stride = max(1, len(line.time) // 8)
        axes.plot(
            line.time,
            line.mean,
            color=look.colour,
            linestyle=lines[world],
            marker=look.marker if panel.marked else "",
            markersize=5,
            markevery=(place * stride // max(1, len(courses)), stride),
        )
    axes.set_xlim(0.0, 1.0)
    axes.set_ylabel(curve.axis)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    if any(line.n.any() for line in courses.values()):
        _limit(axes, curve.top)
    else:
        undefined(axes, curve.words)
    return courses


def _limit(axes: Axes, top: float | None) -> None:
    """Start the axis at 0, with room for a curve that lies on either end."""
    if top is not None:
        top = top or max(float(axes.get_ylim()[1]), 1e-9)
        axes.set_ylim(-0.02 * top, 1.03 * top)


def _name(logs: RunLogs, series: Series) -> str:
    return series[1] if len(logs.run.worlds) == 1 else f"{series[1]} ({series[0]})"


def _endings(logs: RunLogs, courses: dict[Series, Course], curve: Curve) -> str:
    """Say in words where the curves end."""

    def show(value: float) -> str:
        return f"{value:.{curve.digits}f}{curve.unit}"

    ends = {s: float(line.mean[-1]) for s, line in courses.items() if line.n[-1]}
    if not ends:
        return f"{curve.words} is undefined in every episode."
    ranked = sorted(ends, key=lambda s: -ends[s])
    if len(ranked) > LISTED:
        high, low = ranked[0], ranked[-1]
        listed = [
            f"{show(ends[high])} ({_name(logs, high)}, highest)",
            f"{show(ends[low])} ({_name(logs, low)}, lowest)",
        ]
    else:
        listed = [f"{show(ends[s])} ({_name(logs, s)})" for s in ranked]
    return f"{curve.words} ends at {joined(listed)}."


def _paper(logs: RunLogs, curve: Curve) -> str:
    """Say where the paper's curves end; nothing where the run is not one to compare with."""
    ends: dict[str, list[str]] = {}
    for policy in logs.policies:
        known = published_for(logs.run, policy)
        for source, values in (
            (("Paper", known.printed), ("Paper's public code", known.measured)) if known else ()
        ):
            if curve.key in values:
                value = number(values[curve.key], describe(curve.key).digits)
                ends.setdefault(source, []).append(f"{value}{curve.unit} ({policy})")
    return "".join(f" {source} (its own map): {joined(listed)}." for source, listed in ends.items())


def _defined(logs: RunLogs, courses: dict[Series, Course], curve: Curve) -> str:
    """Count the episodes in which the metric is defined at the end, where not all of them."""
    total = logs.run.episodes
    few = [(s, int(line.n[-1])) for s, line in courses.items() if line.n[-1] < total]
    if not few or not any(line.n[-1] for line in courses.values()):
        return ""
    listed = [f"{n} for {_name(logs, s)}" for s, n in few[:LISTED]]
    if len(few) > LISTED:
        listed = [f"{min(n for _, n in few)} or more, by policy"]
    return f" Defined at the end in {joined(listed)} of {total} episodes; the rest is left out."


def time_figure(
    logs: RunLogs, name: str, title: str, curves: Sequence[Curve], definition: str
) -> Picture:
    """Draw one panel per curve, stacked above a common axis of normalised time."""
    panel = Panel(logs.policies, logs.run.worlds)
    height = 1.1 + 2.45 * len(curves)
    figure = canvas(WIDTH_IN, height)
    grid = figure.subplots(len(curves), 1, sharex=True, squeeze=False)
    words = []
    for axes, curve in zip(grid[:, 0], curves, strict=True):
        courses = _plot(axes, logs, panel, curve)
        if curve.ending:
            words.append(
                _endings(logs, courses, curve)
                + _defined(logs, courses, curve)
                + _paper(logs, curve)
            )
    grid[-1, 0].set_xlabel("normalised time  $t/T$")
    panel.legend(figure)
    return Picture(name, title, f"{' '.join(words)} {definition}", figure)


def time_figures(logs: RunLogs) -> list[Picture]:
    """Every figure over time, in the order of the report."""
    return [
        time_figure(
            logs,
            "pta",
            "Items discovered and removed",
            [
                Curve("pta_d", "PTA$_D$  [%]", "PTA_D", 1, 100.0, " %"),
                Curve("pta_c", "PTA$_C$  [%]", "PTA_C", 1, 100.0, " %"),
            ],
            "PTA_D: items discovered, PTA_C: items removed, both of all K items of the episode.",
        ),
        time_figure(
            logs,
            "idleness",
            "Idleness and how fast it falls",
            [
                Curve("mi", "MI", "MI", 3, 1.0),
                Curve("irr", "IRR  [per step]", "IRR", 4, ending=False),
            ],
            "MI: mean over the navigable nodes of the idleness, which grows by 1/(0.9 T) per step "
            "and is 0 where any agent sees; IRR: the fall of MI from one step to the next.",
        ),
        time_figure(
            logs,
            "rmse",
            "Error of the believed distribution",
            [
                Curve("rmse", "RMSE  [items per node]", "RMSE", 4, 0.0),
                Curve(
                    "rmse_columns",
                    "RMSE$_{\\mathrm{columns}}$  [items per node]",
                    "RMSE_columns",
                    4,
                    0.0,
                ),
            ],
            "RMSE over the navigable nodes between true and believed counts, both smoothed by a "
            "Gaussian of one node; RMSE_columns is what the paper printed.",
        ),
        time_figure(
            logs,
            "csr",
            "Cooperative success ratio",
            [Curve("csr", "CSR", "CSR", 3, 1.0)],
            "CSR: removed items that a scout had discovered first, of all removed; undefined "
            "before the first removal.",
        ),
        time_figure(
            logs,
            "gini-foragers",
            "Inequality among foragers",
            [Curve("gini_foragers", "Gini, foragers", "Gini", 3, 0.0)],
            "Gini of the items removed per forager: 0 when all removed the same; undefined before "
            "the first removal.",
        ),
        time_figure(
            logs,
            "overlap-scouts",
            "Coverage overlap of scouts",
            [Curve("co_scouts", "CO, scouts", "CO", 3, 0.0)],
            "CO: nodes that at least two scouts see, of those that at least one sees.",
        ),
    ]
