"""Figures over normalised time: mean of the episodes with its 95 % band, per policy and world."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from mjforage.mission.mission_metrics import Description
from mjforage.view.page.figure import (
    WIDTH_IN,
    Panel,
    ReportFigure,
    canvas,
    joined,
    mathtext,
    undefined,
)
from mjforage.view.report.published import elsewhere, published_for
from mjforage.view.report.run_logs import RunLogs, Series
from mjforage.view.report.step_means import COUNT, STD, drawn_steps
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
class Arrangement:
    """A figure that shows courses of our metrics together."""

    name: str
    title: str
    courses: tuple[str, ...]  # columns of steps.parquet
    words: str  # definitions
    optional: bool = False  # whether courses without a number are left out, and with all the figure


ARRANGED = (
    Arrangement(
        "pta",
        "Items discovered and removed",
        ("pta_d", "pta_c"),
        "PTA_D: items discovered, PTA_C: items removed, both of all K items of the episode.",
    ),
    Arrangement(
        "idleness",
        "Idleness and how fast it falls",
        ("mi", "irr"),
        "MI: mean over the navigable nodes of the idleness, which grows by 1/(0.9 T) per step "
        "and is 0 where any agent sees; IRR: the fall of MI from one step to the next.",
    ),
    Arrangement(
        "rmse",
        "Error of the believed distribution",
        ("rmse", "rmse_columns"),
        "RMSE over the navigable nodes between true and believed counts, both smoothed by a "
        "Gaussian of one node; RMSE_columns is what the paper printed.",
    ),
    Arrangement(
        "csr",
        "Cooperative success ratio",
        ("csr",),
        "CSR: removed items that a scout had discovered first, of all removed; undefined "
        "before the first removal.",
    ),
    Arrangement(
        "gini",
        "Inequality within the teams",
        ("gini_foragers", "gini_scouts"),
        "Gini of the items removed per forager and discovered per scout: 0 when all did the same; "
        "undefined before the first.",
    ),
    Arrangement(
        "overlap",
        "Coverage overlap within the teams",
        ("co_scouts", "co_foragers"),
        "CO: nodes that at least two of the team see, of those that at least one sees.",
    ),
    Arrangement(
        "ages",
        "How old what agents know is",
        ("aoi", "position_age"),
        "AoI: mean over the navigable nodes of the steps since a look that the holder has heard "
        "saw them, T if none; PA: steps since the newest position that an agent has heard of a "
        "team-mate.",
        optional=True,
    ),
    Arrangement(
        "holders",
        "How unlike the agents' maps are",
        ("disagreement", "rmse_holders", "contact"),
        "Disagreement: RMSE between the maps of two holders, mean over the pairs; RMSE_holders: "
        "RMSE of a holder's own map; Contact: pairs of agents in reach of each other.",
        optional=True,
    ),
)
"""What the report shows together; a metric that is in none of them has a figure of its own."""


def course(logs: RunLogs, series: Series, key: str) -> Course:
    """Mean and 1.96 SEM of a per-step metric over the episodes in which it is defined."""
    if key not in logs.columns_of_steps:
        time = drawn_steps(logs.run.horizon) / logs.run.horizon
        nothing = np.full(time.size, np.nan)
        return Course(time, nothing, nothing, np.zeros(time.size, np.int64))
    table = logs.select(logs.means, series)
    n = table[key + COUNT].to_numpy()
    mean = table[key].fill_null(math.nan).to_numpy()
    std = table[key + STD].fill_null(0.0).to_numpy()
    time = table["step"].to_numpy() / logs.run.horizon
    return Course(time, mean, 1.96 * std / np.sqrt(np.maximum(n, 1)), n)


def _plot(axes: Axes, logs: RunLogs, panel: Panel, curve: Description) -> dict[Series, Course]:
    looks, lines = panel.styles(), panel.lines()
    courses = {series: course(logs, series, curve.course) for series in logs.series}
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
            marker=look.marker,
            markersize=5,
            markevery=(place * stride // max(1, len(courses)), stride),
        )
    axes.set_xlim(0.0, 1.0)
    unit = f"  [{curve.unit}]" if curve.unit else ""
    axes.set_ylabel(mathtext(curve.course_label) + unit)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    if any(line.n.any() for line in courses.values()):
        _limit(axes, curve.top)
    else:
        undefined(axes, mathtext(curve.course_label), _why_empty(logs, curve))
    return courses


def _why_empty(logs: RunLogs, curve: Description) -> str:
    """Why nothing of a course is drawn."""
    if curve.course not in logs.columns_of_steps:
        return "is not in this run, which was made without it"
    return "is undefined in every episode"


def _limit(axes: Axes, top: float | None) -> None:
    """Start the axis at 0, with room for a curve that lies on either end."""
    if top is not None:
        top = top or max(float(axes.get_ylim()[1]), 1e-9)
        axes.set_ylim(-0.02 * top, 1.03 * top)


def _name(logs: RunLogs, series: Series) -> str:
    return series[1] if len(logs.run.worlds) == 1 else f"{series[1]} ({series[0]})"


def _endings(logs: RunLogs, courses: dict[Series, Course], curve: Description) -> str:
    """Say in words where the curves end."""

    def show(value: float) -> str:
        return f"{value:.{curve.digits}f}{_unit(curve)}"

    ends = {s: float(line.mean[-1]) for s, line in courses.items() if line.n[-1]}
    if not ends:
        drawn = any(line.n.any() for line in courses.values())
        return "" if drawn else f"{curve.course_label} {_why_empty(logs, curve)}."
    ranked = sorted(ends, key=lambda s: -ends[s])
    if len(ranked) > LISTED:
        high, low = ranked[0], ranked[-1]
        listed = [
            f"{show(ends[high])} ({_name(logs, high)}, highest)",
            f"{show(ends[low])} ({_name(logs, low)}, lowest)",
        ]
    else:
        listed = [f"{show(ends[s])} ({_name(logs, s)})" for s in ranked]
    return f"{curve.course_label} ends at {joined(listed)}."


def _unit(curve: Description) -> str:
    return f" {curve.unit}" if curve.unit else ""


def _paper(logs: RunLogs, curve: Description) -> str:
    """Say where the paper's curves end; nothing where the run is not one to compare with."""
    ends: dict[str, list[str]] = {}
    for policy in logs.policies:
        known = published_for(logs.run, policy)
        pooled = known.pooled.mean if known and known.pooled else {}
        for source, values in (
            (("Paper", known.printed), ("Paper's public code", pooled)) if known else ()
        ):
            if curve.key in values:
                value = number(values[curve.key], curve.digits)
                ends.setdefault(source, []).append(f"{value}{_unit(curve)} ({policy})")
    return "".join(
        f" {source}{elsewhere(logs.run)}: {joined(listed)}." for source, listed in ends.items()
    )


def _defined(logs: RunLogs, courses: dict[Series, Course], curve: Description) -> str:
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
    logs: RunLogs, name: str, title: str, curves: Sequence[Description], definition: str
) -> ReportFigure:
    """Draw one panel per curve, stacked above a common axis of normalised time."""
    panel = Panel(logs.policies, logs.run.worlds)
    height = 1.1 + 2.45 * len(curves)
    figure = canvas(WIDTH_IN, height)
    grid = figure.subplots(len(curves), 1, sharex=True, squeeze=False)
    words = []
    for axes, curve in zip(grid[:, 0], curves, strict=True):
        courses = _plot(axes, logs, panel, curve)
        end = _endings(logs, courses, curve)
        words += [end + _defined(logs, courses, curve) + _paper(logs, curve)] if end else []
    grid[-1, 0].set_xlabel("normalised time  $t/T$")
    panel.legend(figure)
    return ReportFigure(name, title, " ".join((*words, definition)), figure)


def _has_numbers(logs: RunLogs, key: str) -> bool:
    """Whether a course is defined anywhere."""
    return key in logs.columns_of_steps and bool(logs.means[key + COUNT].sum())


def time_figures(logs: RunLogs) -> list[ReportFigure]:
    """Every figure over time, in the order of the report: ours, then one per other course."""
    courses, figures = logs.courses, []
    for one in ARRANGED:
        shown = [key for key in one.courses if not one.optional or _has_numbers(logs, key)]
        if shown:
            about = one.name, one.title, [courses[key] for key in shown], one.words
            figures.append(time_figure(logs, *about))
    arranged = {key for one in ARRANGED for key in one.courses}
    for key, curve in courses.items():
        if key not in arranged and key in logs.columns_of_steps:
            name, title = f"course-{key.replace('_', '-')}", f"{curve.course_label} over time"
            words = f"{curve.course_label}: {curve.definition}."
            figures.append(time_figure(logs, name, title, [curve], words))
    return figures
