"""Tables and figures of a study whose variants lie along axes."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from mjforage.mission.scoring import describe
from mjforage.runs.studies.axes import OWN, Axis
from mjforage.runs.studies.variants import COMPLETE
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas, house_style
from mjforage.view.page.table import Table
from mjforage.view.report.contrasts import Contrast, differences_table, means_table
from mjforage.view.report.curves import finish, series_label, time_series
from mjforage.view.report.run_logs import Case, policy_name
from mjforage.view.report.studies.study_logs import StudyLogs

SHADES = "plasma"
DARKEST, LIGHTEST = 0.1, 0.85  # of those shades: the yellow end is too pale on white
TIMES = (0.0, 0.25, 0.5, 0.75, 1.0)  # named on the axis


def _groups(
    logs: StudyLogs, axes: Sequence[Axis], world: str, policy: str
) -> dict[str, dict[str, Case]]:
    """Heading -> cases of a policy along an axis; a variant of several axes once."""
    wanted = {axis.heading: [point.variant for point in axis.points] for axis in axes}
    wanted["As the scenario has it"] = [OWN]
    left = [name for name in logs.runs if logs.plays(policy, name)]
    found = {}
    for heading, names in wanted.items():
        here = [name for name in names if name in left]
        left = [name for name in left if name not in here]
        if here:
            found[heading] = {logs.title(n): logs.case(n, world, policy) for n in here}
    return found


def tables_along(
    logs: StudyLogs, axes: Sequence[Axis], compared: tuple[str, ...], shown: tuple[str, ...]
) -> list[Table]:
    """Differences to the scenario as it is, then means: a pair of tables per policy and world.

    Parameters
    ----------
    compared, shown : keys of metrics; those that no variant was played with are left out
    """
    tables, head = [], logs.title(COMPLETE)
    for policy in logs.policies:
        for world in logs.worlds:
            base, groups = logs.case(COMPLETE, world, policy), _groups(logs, axes, world, policy)
            contrasts = [
                Contrast(name, case, base, group)
                for group, cases in groups.items()
                for name, case in cases.items()
            ]
            title, end = (
                f"{policy_name(policy, logs.bounds)}{logs.suffix(world)}",
                f"{world}-{policy}",
            )
            minus = f"{title}: difference to {head}"
            groups = {"": {head: base}, **groups}
            tables += [
                differences_table(f"minus-{end}", minus, logs.measured(compared), contrasts),
                means_table(f"means-{end}", f"{title}: means", logs.measured(shown), groups),
            ]
    return tables


def reference_table(
    logs: StudyLogs, axis: Axis, name: str, title: str, keys: tuple[str, ...]
) -> Table:
    """Points of an axis minus the variant that it is compared with, policy by policy."""
    contrasts = [
        Contrast(
            logs.title(point.variant),
            logs.case(point.variant, world, policy),
            logs.case(axis.against, world, policy),
            policy_name(policy, logs.bounds) + logs.suffix(world),
        )
        for policy in logs.policies
        for world in logs.worlds
        for point in axis.points
        if point.variant != axis.against
        and logs.plays(policy, point.variant)
        and logs.plays(policy, axis.against)
    ]
    return differences_table(name, title, logs.measured(keys), contrasts)


def series_picture(
    logs: StudyLogs,
    about: tuple[str, str, str],
    variants: Sequence[tuple[str, str]],
    keys: Sequence[str],
    world: str,
) -> ReportFigure:
    """Draw time series of several variants: a row of panels per metric, a column per policy.

    Parameters
    ----------
    about : name, title and caption
    variants : (name of the variant, what the legend calls it), the best last
    keys : of metrics with a time series
    """
    name, title, caption = about
    played = [(variant, words) for variant, words in variants if variant in logs.runs]
    places = np.linspace(LIGHTEST, DARKEST, len(played) - 1)
    shades = [to_hex(colormaps[SHADES](float(place))) for place in places]
    markers = [style.MARKERS[place % len(style.MARKERS)] for place in range(len(played))]
    looks = [style.PolicyStyle(*one) for one in zip([*shades, style.INK], markers, strict=True)]
    metrics = [describe(key) for key in keys]
    with house_style():
        figure = canvas(WIDE_IN, 1.1 + 2.4 * len(keys))
        shape = len(keys), len(logs.policies)
        grid = figure.subplots(*shape, sharex=True, sharey="row", squeeze=False)
        for row, metric in zip(grid, metrics, strict=True):
            for axes, policy in zip(row, logs.policies, strict=True):
                drawn = False
                for place, ((variant, _), look) in enumerate(zip(played, looks, strict=True)):
                    case = logs.case(variant, world, policy)
                    one = time_series(case, metric.series or metric.key)
                    one.draw(axes, look, "-", place, len(played))
                    drawn |= bool(one.n.any())
                finish(axes, metric, "" if drawn else "is not in this study")
                axes.set_xticks(TIMES, [f"{time:g}" for time in TIMES])
            row[0].set_ylabel(series_label(metric))
        for above, below, policy in zip(grid[0], grid[-1], logs.policies, strict=True):
            above.set_title(policy_name(policy, logs.bounds))
            below.set_xlabel("normalised time  $t/T$")
        handles = [
            Line2D([], [], color=look.colour, marker=look.marker, markersize=5, label=words)
            for look, (_, words) in zip(looks, played, strict=True)
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))
    words = " ".join(f"{metric.label}: {metric.definition}." for metric in metrics)
    bands = "Lines: means of the episodes, bands ± 1.96 SEM."
    return ReportFigure(name, title, f"{caption} {bands} {words}", figure, wide=True)
