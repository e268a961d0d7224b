"""Courses over time of several variants: a row of panels per metric, a column per policy."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from mjforage.mission.mission_metrics import describe
from mjforage.runs.study import variant_folder
from mjforage.view.page import style
from mjforage.view.page.figure import (
    WIDE_IN,
    ReportFigure,
    canvas,
    house_style,
    mathtext,
    undefined,
)
from mjforage.view.report.curves import course
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.text_tables import policy_name

SHADES = "plasma"
DARKEST, LIGHTEST = 0.1, 0.85  # of those shades: the yellow end is too pale on white
MARKS = 6  # on a line
TIMES = (0.0, 0.25, 0.5, 0.75, 1.0)  # named on the axis


def _colours(count: int) -> list[Any]:
    """A colour per variant in their order, from light to dark; ink for the last."""
    places = np.linspace(LIGHTEST, DARKEST, count - 1)
    return [*(colormaps[SHADES](float(place)) for place in places), style.INK]


def _marker(number: int) -> str:
    """Marker of a variant by its place."""
    return style.MARKERS[number % len(style.MARKERS)]


def courses_picture(
    logs: StudyLogs,
    name: str,
    title: str,
    caption: str,
    variants: Sequence[tuple[str, str]],
    keys: Sequence[str],
    world: str,
) -> ReportFigure:
    """Draw means with their bands.

    Parameters
    ----------
    variants : (name of the variant, what the legend calls it), the best last
    keys : of metrics with a course
    """
    played = [(run, words) for run, words in variants if run in logs.runs]
    runs = {run: load_logs(variant_folder(logs.folder, run)) for run, _ in played}
    policies = style.ordered(logs.base.policies)
    colours = _colours(len(played))
    with house_style():
        figure = canvas(WIDE_IN, 1.1 + 2.4 * len(keys))
        grid = figure.subplots(len(keys), len(policies), sharex=True, sharey="row", squeeze=False)
        for row, metric in zip(grid, map(describe, keys), strict=True):
            for axes, policy in zip(row, policies, strict=True):
                drawn = False
                for number, ((run, _), colour) in enumerate(zip(played, colours, strict=True)):
                    line = course(runs[run], (world, policy), metric.course or metric.key)
                    drawn |= bool(line.n.any())
                    band = line.mean - line.half, line.mean + line.half
                    axes.fill_between(line.time, *band, color=colour, alpha=0.13, linewidth=0)
                    stride = max(1, len(line.time) // MARKS)
                    axes.plot(
                        line.time,
                        line.mean,
                        color=colour,
                        marker=_marker(number),
                        markersize=4.5,
                        markevery=(number * stride // len(played), stride),
                    )
                axes.set_xlim(0.0, 1.0)
                axes.set_xticks(TIMES, [f"{time:g}" for time in TIMES])
                axes.yaxis.set_major_locator(MaxNLocator(5))
                if not drawn:
                    label = mathtext(metric.course_label or metric.label)
                    undefined(axes, label, "is not in this study")
            unit = f"  [{metric.unit}]" if metric.unit else ""
            row[0].set_ylabel(mathtext(metric.course_label or metric.label) + unit)
        for axes, policy in zip(grid[0], policies, strict=True):
            axes.set_title(policy_name(policy, logs.bounds))
        for axes in grid[-1]:
            axes.set_xlabel("normalised time  $t/T$")
        handles = [
            Line2D([], [], color=colour, marker=_marker(number), markersize=4.5, label=words)
            for number, ((_, words), colour) in enumerate(zip(played, colours, strict=True))
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))
    words = " ".join(f"{describe(key).label}: {describe(key).definition}." for key in keys)
    bands = "Lines: means of the episodes, bands ± 1.96 SEM."
    return ReportFigure(name, title, f"{caption} {bands} {words}", figure, wide=True)
