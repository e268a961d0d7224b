"""Metrics over the axes of a study: a column of panels per axis, a row per metric."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from mjforage.mission.scoring import Description, describe
from mjforage.runs.studies.axes import Axis, Point
from mjforage.view.page import style
from mjforage.view.page.figure import (
    WIDE_IN,
    Panel,
    ReportFigure,
    canvas,
    house_style,
    joined,
    mathtext,
)
from mjforage.view.report.contrasts import Contrast
from mjforage.view.report.differences import FEWEST, Difference, family_note, set_apart
from mjforage.view.report.studies.study_logs import StudyLogs

KEYS = ("pta_c", "nt90")
LINES: dict[style.Line, str] = {"-": "solid", "--": "dashed", ":": "dotted"}
SPREAD = 0.55  # of what stands at one value, in distances of neighbouring values
MARGIN = 0.06  # of an axis of values, beyond intervals

Drawn = tuple[str, str, str, str]
"""Key of a metric, name of an axis, policy and variant."""


@dataclass(frozen=True)
class AxisFigure:
    """Axes of a study in one world, for some policies."""

    logs: StudyLogs
    world: str
    axes: tuple[Axis, ...]
    policies: tuple[str, ...]

    @cached_property
    def gaps(self) -> dict[Drawn, Difference]:
        """Differences of points to the variant that their axis is compared with."""
        return {
            (key, axis.name, policy, point.variant): Contrast(
                "",
                self.logs.case(point.variant, self.world, policy),
                self.logs.case(axis.against, self.world, policy),
            ).gap(describe(key))
            for key in KEYS
            for axis in self.axes
            for policy in self.policies
            for point in axis.points
            if point.variant != axis.against and self.logs.plays(policy, point.variant)
        }

    @cached_property
    def told(self) -> set[Drawn]:
        """Points that differ significantly from 0."""
        pairs = zip(self.gaps, set_apart(list(self.gaps.values())), strict=True)
        return {one for one, apart in pairs if apart}

    def draw(self, axes: Axes, axis: Axis, metric: Description) -> None:
        """Draw a panel: policies side by side, and within each its lines."""
        places = [axis.place(value) for value in axis.values]
        step = min(np.diff(places)) if len(places) > 1 else 1.0
        often = Counter(point.variant for line in axis.lines.values() for point in line)
        looks, lines = style.policy_styles(self.policies), len(axis.lines)
        for number, (policy, look) in enumerate(looks.items()):
            for rank, (line, points) in enumerate(zip(LINES, axis.lines.values(), strict=False)):
                played = [one for one in points if self.logs.plays(policy, one.variant)]
                side = (rank - (lines - 1) / 2) / lines
                middle = number - (len(looks) - 1) / 2
                aside = [side if often[one.variant] == 1 else 0.0 for one in played]
                x = [
                    axis.place(one.value) + step * SPREAD * (middle + by) / len(looks)
                    for one, by in zip(played, aside, strict=True)
                ]
                self._line(axes, axis, metric, policy, (x, played), (look, line))
        axes.set_xticks(places, [axis.tick(value) for value in axis.values])
        axes.set_xlim(places[0] - 0.5 * step, places[-1] + 0.5 * step)
        axes.grid(visible=False, axis="x")

    def _line(
        self,
        axes: Axes,
        axis: Axis,
        metric: Description,
        policy: str,
        places: tuple[Sequence[float], Sequence[Point]],
        looks: tuple[style.PolicyStyle, style.Line],
    ) -> None:
        """Means of points at their places, joined, each with its interval."""
        (x, points), (look, line) = places, looks
        cases = [self.logs.case(one.variant, self.world, policy) for one in points]
        found = [case.summary(metric.key) for case in cases]
        means = [entry.mean for entry in found]
        axes.plot(x, means, color=look.colour, linestyle=line, linewidth=1.5, zorder=3)
        for at, one, entry in zip(x, points, found, strict=True):
            ends = [entry.low, entry.high]
            axes.plot([at, at], ends, color=look.colour, linewidth=1.2, alpha=0.6)
            filled = (metric.key, axis.name, policy, one.variant) in self.told
            axes.plot(
                at,
                entry.mean,
                **look.dots,
                markerfacecolor=look.colour if filled else "white",
                markersize=5.5,
                markeredgewidth=1.3,
                zorder=4,
            )


def _below(axis: Axis) -> str:
    """Label of an axis: what it is, and which line is which where there are several."""
    kinds = [f"{LINES[line]}: {name}" for line, name in zip(LINES, axis.lines, strict=False)]
    return "\n".join([axis.label, *(kinds if len(kinds) > 1 else [])])


def _scale(row: Sequence[Axes], metric: Description) -> None:
    """End the common axis of values a little beyond what is drawn."""
    drawn = np.concatenate([np.ravel(line.get_ydata()) for axes in row for line in axes.lines])
    drawn = drawn.astype(np.float64)[np.isfinite(drawn.astype(np.float64))]
    low, high = (drawn.min(), drawn.max()) if drawn.size else (0.0, 1.0)
    margin = MARGIN * max(high - low, 0.1 * abs(high))
    row[0].set_ylim(low - margin, high + (margin or 1.0))
    row[0].ticklabel_format(axis="y", useOffset=False)
    unit = f"  [{metric.unit}]" if metric.unit else ""
    row[0].set_ylabel(mathtext(metric.label) + unit)


def axis_figure(
    name: str, title: str, caption: str, shown: AxisFigure, heads: Sequence[str] = ()
) -> ReportFigure:
    """Draw means with their intervals, filled where they differ from the reference.

    Parameters
    ----------
    heads : above the columns; empty: the names of the axes
    """
    extra = max(len(axis.lines) if len(axis.lines) > 1 else 0 for axis in shown.axes)
    widths = [len(axis.values) + 1.0 for axis in shown.axes]
    names = tuple(heads) or tuple(axis.name for axis in shown.axes)
    with house_style():
        figure = canvas(WIDE_IN, 1.35 + 2.5 * len(KEYS) + 0.17 * extra)
        shared: dict[str, Any] = {
            "sharex": "col",
            "sharey": "row",
            "squeeze": False,
            "width_ratios": widths,
        }
        panels = figure.subplots(len(KEYS), len(shown.axes), **shared)
        for row, metric in zip(panels, map(describe, KEYS), strict=True):
            for axes, axis in zip(row, shown.axes, strict=True):
                shown.draw(axes, axis, metric)
            _scale(row, metric)
        for above, below, head, axis in zip(panels[0], panels[-1], names, shown.axes, strict=True):
            above.set_title(head)
            below.set_xlabel(_below(axis))
        Panel(shown.policies, (shown.world,)).legend(figure)
    pairs = zip(shown.axes, names, strict=True)
    scales = [name for axis, name in pairs if axis.even and len(axis.values) > 1]
    note = family_note(list(shown.gaps.values()), "this figure", "filled")
    words = (
        f"{caption} Markers and bars: means and their bootstrap 95 % intervals; {note} and is of "
        f"{FEWEST} episodes or more."
    )
    if scales:
        words += f" Values of {joined(scales)} are set at equal distances."
    return ReportFigure(name, title, words, figure, wide=True)
