"""Metrics over the axes of a study: a column of panels per axis, a row per metric."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mjforage.mission.mission_metrics import Description, describe
from mjforage.runs.axes import Axis, Point
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
from mjforage.view.report.differences import FEWEST, Difference, family_note, set_apart
from mjforage.view.report.studies.compared_players import Line, difference
from mjforage.view.report.studies.study_logs import Player, StudyLogs

KEYS = ("pta_c", "nt90")
LINES: tuple[style.Line, ...] = ("-", "--", ":")
NAMES: dict[style.Line, str] = {"-": "solid", "--": "dashed", ":": "dotted"}
SPREAD = 0.55  # of what stands at one value, in distances of neighbouring values
MARGIN = 0.06  # of an axis of values, beyond intervals

Drawn = tuple[str, str, str, str]
"""Key of a metric, name of an axis, policy and variant."""


@dataclass(frozen=True)
class AxisFigure:
    """What one figure shows."""

    logs: StudyLogs
    world: str
    axes: tuple[Axis, ...]
    policies: tuple[str, ...]

    def player(self, policy: str, variant: str) -> Player:
        """Who plays a variant here."""
        return Player(variant, self.world, policy)

    def played(self, policy: str, line: Sequence[Point]) -> list[Point]:
        """Points of a line that a policy has played."""
        runs = self.logs.runs
        return [one for one in line if one.variant in runs and policy in runs[one.variant].policies]

    def _step(self, axis: Axis, policy: str, variant: str, key: str) -> Difference:
        """A metric of a variant minus that of what its axis is compared with."""
        there, here = (Line("", self.player(policy, one)) for one in (variant, axis.against))
        return difference(self.logs, there, here, key)

    def apart(self) -> tuple[dict[Drawn, bool], list[Difference]]:
        """Which differ from what they are compared with, and all differences."""
        found = {
            (key, axis.name, policy, point.variant): self._step(axis, policy, point.variant, key)
            for key in KEYS
            for axis in self.axes
            for policy in self.policies
            for point in self.played(policy, axis.points)
            if point.variant != axis.against
        }
        family = list(found.values())
        return dict(zip(found, set_apart(family), strict=True)), family


def _shifts(axis: Axis, policies: int) -> Callable[[Point, int, int], float]:
    """Function of a point and the numbers of policy and line: by how much it stands aside.

    Beside each other are policies, and within each its lines, but where these share a variant.
    """
    often = Counter(point.variant for line in axis.lines.values() for point in line)
    lines = len(axis.lines)

    def shift(point: Point, policy: int, line: int) -> float:
        aside = (line - (lines - 1) / 2) / lines if often[point.variant] == 1 else 0.0
        return SPREAD * (policy - (policies - 1) / 2 + aside) / policies

    return shift


def _draw(
    axes: Axes,
    shown: AxisFigure,
    axis: Axis,
    metric: Description,
    apart: dict[Drawn, bool],
) -> None:
    shift = _shifts(axis, len(shown.policies))
    places = [axis.place(value) for value in axis.values]
    step = min(np.diff(places)) if len(places) > 1 else 1.0
    for number, (policy, look) in enumerate(style.policy_styles(shown.policies).items()):
        for rank, (line, points) in enumerate(zip(LINES, axis.lines.values(), strict=False)):
            played = shown.played(policy, points)
            found = [
                shown.logs.entry(shown.player(policy, one.variant), metric.key) for one in played
            ]
            x = [axis.place(one.value) + step * shift(one, number, rank) for one in played]
            axes.plot(
                x,
                [entry.mean for entry in found],
                color=look.colour,
                linestyle=line,
                linewidth=1.5,
                zorder=3,
            )
            for at, one, entry in zip(x, played, found, strict=True):
                axes.plot(
                    [at, at], [entry.low, entry.high], color=look.colour, linewidth=1.2, alpha=0.6
                )
                filled = apart.get((metric.key, axis.name, policy, one.variant), False)
                axes.plot(
                    at,
                    entry.mean,
                    **look.dots,
                    markerfacecolor=look.colour if filled else "white",
                    markersize=5.5,
                    markeredgewidth=1.3,
                    zorder=4,
                )
    axes.set_xticks(places, [axis.tick(value) for value in axis.values])
    axes.set_xlim(places[0] - 0.5 * step, places[-1] + 0.5 * step)
    axes.grid(visible=False, axis="x")


def _below(axis: Axis) -> str:
    """Label of an axis: what it is, and which line is which where there are several."""
    if len(axis.lines) == 1:
        return axis.label
    kinds = "\n".join(
        f"{NAMES[line]}: {name}" for line, name in zip(LINES, axis.lines, strict=False)
    )
    return f"{axis.label}\n{kinds}"


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


def _panels(figure: Figure, shown: AxisFigure) -> list[list[Axes]]:
    """Rows of panels: by metric, then by axis, as wide as there are values."""
    widths = [len(axis.values) + 1.0 for axis in shown.axes]
    grid = figure.subplots(
        len(KEYS), len(shown.axes), sharex="col", sharey="row", squeeze=False, width_ratios=widths
    )
    return [list(row) for row in grid]


def axis_figure(
    name: str, title: str, caption: str, shown: AxisFigure, heads: Sequence[str] = ()
) -> ReportFigure:
    """Draw means with their intervals, filled where they differ from what they are compared with.

    Parameters
    ----------
    heads : above the columns; empty: the names of the axes
    """
    apart, family = shown.apart()
    extra = max(len(axis.lines) if len(axis.lines) > 1 else 0 for axis in shown.axes)
    with house_style():
        figure = canvas(WIDE_IN, 1.35 + 2.5 * len(KEYS) + 0.17 * extra)
        panels = _panels(figure, shown)
        for row, metric in zip(panels, map(describe, KEYS), strict=True):
            for axes, axis in zip(row, shown.axes, strict=True):
                _draw(axes, shown, axis, metric, apart)
            _scale(row, metric)
        names = tuple(heads) or tuple(axis.name for axis in shown.axes)
        for axes, head in zip(panels[0], names, strict=True):
            axes.set_title(head)
        for axes, axis in zip(panels[-1], shown.axes, strict=True):
            axes.set_xlabel(_below(axis))
        Panel(shown.policies, (shown.world,)).legend(figure)
    pairs = zip(shown.axes, names, strict=True)
    scales = [name for axis, name in pairs if axis.even and len(axis.values) > 1]
    words = (
        f"{caption} Markers and bars: means and their bootstrap 95 % intervals; "
        f"{family_note(family, 'this figure', 'filled')} and is of {FEWEST} episodes or more."
    )
    if scales:
        words += f" Values of {joined(scales)} are set at equal distances."
    return ReportFigure(name, title, words, figure, wide=True)
