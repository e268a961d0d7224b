"""Figures of estimates with their intervals, one panel per metric and one row per subject."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from matplotlib.axes import Axes

from mjforage.mission.scoring import Description
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas, house_style, mathtext
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


def _draw(axes: Axes, row: int, subject: Subject, key: str, apart: bool) -> None:
    found, colour = subject.estimates[key], subject.look.colour
    if found.n:
        axes.plot([found.low, found.high], [row, row], color=colour, linewidth=2.2)
        face = colour if apart else "white"
        axes.plot(found.value, row, **subject.look.dots, markerfacecolor=face, markersize=6)
    if key in subject.paper:
        star: dict[str, Any] = {"color": style.INK, "markerfacecolor": "none"}
        axes.plot(subject.paper[key], row, PAPER, zorder=3, markersize=10, **star)


def forest(
    about: tuple[str, str, str],
    metrics: Sequence[Description],
    subjects: Sequence[Subject],
    *,
    gains: bool = False,
) -> ReportFigure:
    """Draw the estimates, filled where they differ from 0 after Holm's correction over the figure.

    With `gains` more is better whatever the metric; else they are in the metric's own unit.

    Parameters
    ----------
    about : name, title and caption
    """
    lines = -(-len(metrics) // COLUMNS)
    columns = -(-len(metrics) // lines)
    family = [subject.estimates[metric.key] for metric in metrics for subject in subjects]
    apart = iter(set_apart(family))
    with house_style():
        figure = canvas(WIDE_IN, lines * (1.0 + 0.24 * len(subjects)))
        grid = figure.subplots(lines, columns, sharey=True, squeeze=False)
        for axes, metric in zip(grid.flat, metrics, strict=False):
            axes.axvline(0.0, color=style.MUTED, linewidth=1.0)
            for row, subject in enumerate(subjects):
                _draw(axes, row, subject, metric.key, next(apart))
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
    name, title, caption = about
    words = (
        f"{caption} Marker and bar: estimate and bootstrap 95 % interval of itself alone; "
        f"{family_note(family, 'this figure', 'filled')} and is of {FEWEST} episodes or more."
    )
    if any(subject.paper for subject in subjects):
        words += " Hollow star: the paper's number, at graph level."
    return ReportFigure(name, title, words, figure, wide=True)
