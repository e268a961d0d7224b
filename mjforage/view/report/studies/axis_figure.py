"""Metrics over the axes of a study: a column of panels per axis, a row per metric."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from mjforage.metrics import FEWEST
from mjforage.mission.scoring import Description, describe
from mjforage.runs.studies.axes import Axis
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, Panel, ReportFigure, canvas, house_style, joined
from mjforage.view.report.contrasts import Contrast
from mjforage.view.report.curves import axis_label
from mjforage.view.report.differences import Estimate, estimates, family_note
from mjforage.view.report.studies.study_logs import StudyLogs

KEYS = ("pta_c", "nt90")
LINES: dict[style.Line, str] = {"-": "solid", "--": "dashed", ":": "dotted"}
SPREAD = 0.55  # width of the points at one value, in distances of neighbouring values
MARGIN = 0.06  # of an axis of values, beyond the intervals

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
    def gaps(self) -> dict[Drawn, Estimate]:
        """Differences of points to the variant that their axis is compared with."""
        gaps = {
            (metric.key, axis.name, policy, point.variant): (
                Contrast(
                    "",
                    self.logs.case(point.variant, self.world, policy),
                    self.logs.case(axis.against, self.world, policy),
                ).gaps(metric),
                metric.digits,
            )
            for metric in map(describe, KEYS)
            for axis in self.axes
            for policy in self.policies
            for point in axis.points
            if point.variant != axis.against and self.logs.plays(policy, point.variant)
        }
        return dict(zip(gaps, estimates(list(gaps.values())), strict=True))

    def draw(self, axes: Axes, axis: Axis, metric: Description) -> None:
        """Draw a panel: means with intervals, joined; policies and lines side by side."""
        places = [axis.place(value) for value in axis.values]
        step = min(np.diff(places)) if len(places) > 1 else 1.0
        looks, lines = style.policy_styles(self.policies), axis.lines.values()
        pairs = list(product(looks.items(), zip(LINES, lines, strict=False)))
        for rank, ((policy, look), (line, points)) in enumerate(pairs):
            played = [one for one in points if self.logs.plays(policy, one.variant)]
            aside = step * SPREAD * ((rank + 0.5) / len(pairs) - 0.5)
            x = [axis.place(one.value) + aside for one in played]
            cases = [self.logs.case(one.variant, self.world, policy) for one in played]
            found = [case.summary(metric.key) for case in cases]
            means = [one.mean for one in found]
            axes.plot(x, means, color=look.colour, linestyle=line, linewidth=1.5, zorder=3)
            ends = [one.low for one in found], [one.high for one in found]
            axes.vlines(x, *ends, color=look.colour, linewidth=1.2, alpha=0.6)
            for at, one, mean in zip(x, played, means, strict=True):
                gap = self.gaps.get((metric.key, axis.name, policy, one.variant))
                filled = gap is not None and gap.apart
                face = look.colour if filled else "white"
                dot: dict[str, Any] = {"markersize": 5.5, "markeredgewidth": 1.3, "zorder": 4}
                axes.plot(at, mean, **look.dots, markerfacecolor=face, **dot)
        axes.set_xticks(places, [axis.tick(value) for value in axis.values])
        axes.set_xlim(places[0] - 0.5 * step, places[-1] + 0.5 * step)
        axes.margins(y=MARGIN)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.grid(visible=False, axis="x")


def axis_figures(
    logs: StudyLogs,
    about: tuple[str, str, str],
    axes: tuple[Axis, ...],
    policies: tuple[str, ...],
    heads: Sequence[str] = (),
) -> list[ReportFigure]:
    """Draw means with their intervals, filled where they differ from the reference, world by world.

    Parameters
    ----------
    about : name, title and caption
    heads : above the columns; empty: the names of the axes
    """
    name, title, caption = about
    return [
        _figure(
            (f"{name}-{world}", title + logs.suffix(world), caption),
            AxisFigure(logs, world, axes, policies),
            tuple(heads) or tuple(axis.name for axis in axes),
        )
        for world in logs.worlds
    ]


def _figure(about: tuple[str, str, str], shown: AxisFigure, names: Sequence[str]) -> ReportFigure:
    extra = max(len(axis.lines) if len(axis.lines) > 1 else 0 for axis in shown.axes)
    shared: dict[str, Any] = {
        "sharex": "col",
        "sharey": "row",
        "squeeze": False,
        "width_ratios": [len(axis.values) + 1.0 for axis in shown.axes],
    }
    with house_style():
        figure = canvas(WIDE_IN, 1.35 + 2.5 * len(KEYS) + 0.17 * extra)
        panels = figure.subplots(len(KEYS), len(shown.axes), **shared)
        for row, metric in zip(panels, map(describe, KEYS), strict=True):
            for axes, axis in zip(row, shown.axes, strict=True):
                shown.draw(axes, axis, metric)
            row[0].set_ylabel(axis_label(metric))
        for above, below, head, axis in zip(panels[0], panels[-1], names, shown.axes, strict=True):
            above.set_title(head)
            kinds = [
                f"{line}: {kind}" for line, kind in zip(LINES.values(), axis.lines, strict=False)
            ]
            below.set_xlabel("\n".join([axis.label, *(kinds if len(kinds) > 1 else [])]))
        Panel(shown.policies, (shown.world,)).legend(figure)
    pairs = zip(shown.axes, names, strict=True)
    scales = [name for axis, name in pairs if axis.even and len(axis.values) > 1]
    note = family_note(list(shown.gaps.values()), "this figure", "filled")
    name, title, caption = about
    words = (
        f"{caption} Markers and bars: means and their 95 % intervals; {note} and is of "
        f"{FEWEST} episodes or more."
    )
    if scales:
        words += f" Values of {joined(scales)} are set at equal distances."
    return ReportFigure(name, title, words, figure, wide=True)
