"""Figures of estimates with their intervals, one panel per metric and one row per subject."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from matplotlib.axes import Axes

from mjforage.mission.mission_metrics import Description
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas, mathtext
from mjforage.view.report.differences import FEWEST, Estimate, family_note, set_apart

COLUMNS = 4  # panels beside one another, at most
PAPER = "*"  # marker of its numbers, which no policy has


@dataclass(frozen=True)
class Subject:
    """One row of a forest figure."""

    head: str
    look: style.PolicyStyle
    estimates: Mapping[str, Estimate]  # by metric key
    paper: Mapping[str, float] = field(default_factory=dict)  # the paper's, where it has one


def _draw(axes: Axes, row: int, subject: Subject, metric: Description, apart: bool) -> None:
    found = subject.estimates[metric.key]
    colour = subject.look.colour
    if found.n:
        axes.plot([found.low, found.high], [row, row], color=colour, linewidth=2.2)
        dot: dict[str, Any] = {"markerfacecolor": colour if apart else "white", "markersize": 6}
        axes.plot(found.value, row, **subject.look.dots, **dot)
    if metric.key in subject.paper:
        star: dict[str, Any] = {"color": style.INK, "markerfacecolor": "none", "markersize": 10}
        axes.plot(subject.paper[metric.key], row, PAPER, zorder=3, **star)


def forest(
    name: str,
    title: str,
    caption: str,
    metrics: Sequence[Description],
    subjects: Sequence[Subject],
    *,
    gains: bool = False,
) -> ReportFigure:
    """Draw the estimates, filled where they differ from 0 after Holm's correction over the figure.

    With `gains` more is better whatever the metric; else they are in the metric's own unit.
    """
    lines = -(-len(metrics) // COLUMNS)
    columns = -(-len(metrics) // lines)
    figure = canvas(WIDE_IN, lines * (1.0 + 0.24 * len(subjects)))
    grid = figure.subplots(lines, columns, sharey=True, squeeze=False)
    family = [subject.estimates[metric.key] for metric in metrics for subject in subjects]
    apart = iter(set_apart(family))
    for axes, metric in zip(grid.flat, metrics, strict=False):
        axes.axvline(0.0, color=style.MUTED, linewidth=1.0)
        for row, subject in enumerate(subjects):
            _draw(axes, row, subject, metric, next(apart))
        worse = {1: "left is worse", -1: "right is worse", 0: ""}[metric.better]
        unit = f" [{metric.unit}]" if metric.unit and not gains else ""
        axes.set_title(f"{mathtext(metric.label)}{unit}")
        axes.set_xlabel("" if gains else worse)
        axes.locator_params(axis="x", nbins=5)
    for axes in grid.flat[len(metrics) :]:
        axes.set_axis_off()
    for axes in grid[:, 0]:
        axes.set_yticks(range(len(subjects)), [subject.head for subject in subjects])
    grid[0, 0].set_ylim(len(subjects) - 0.5, -0.5)
    words = (
        "Marker and bar: estimate and bootstrap 95 % interval of itself alone; "
        f"{family_note(family, 'this figure', 'filled')} and is of {FEWEST} episodes or more."
    )
    if any(subject.paper for subject in subjects):
        words += " Hollow star: the paper's number, at graph level."
    return ReportFigure(name, title, f"{caption} {words}", figure, wide=True)
