"""The reality gap: the same episodes in several worlds, paired, and the share of each effect."""

from itertools import pairwise

from matplotlib.axes import Axes

from mjforage.mission.scoring import Description, describe
from mjforage.physics.worlds import added
from mjforage.scenario.scenario_file import scenario_from_tree
from mjforage.view.page import style
from mjforage.view.page.figure import WIDE_IN, ReportFigure, canvas
from mjforage.view.page.table import Table
from mjforage.view.report.contrasts import Contrast, differences_table, every_metric_table
from mjforage.view.report.curves import axis_label
from mjforage.view.report.differences import Estimate, judged
from mjforage.view.report.run_logs import Case, RunLogs
from mjforage.view.report.text_tables import HEADLINE, undefined_note

COLUMNS = 4  # panels beside one another
ROW_IN, MARGIN_IN = 0.26, 0.7  # height of a policy, and of an axis with its label


def gap_tables(logs: RunLogs) -> list[Table]:
    """Tables of the steps between worlds, with three or more, and of the first and the last one."""
    levels = [levels_table(logs)] if len(logs.run.worlds) > 2 else []
    return [*levels, gap_table(logs)]


def _between(logs: RunLogs, policy: str, world: str, before: str, head: str = "") -> Contrast:
    return Contrast(head, Case(logs, world, policy), Case(logs, before, policy), policy)


def gap_table(logs: RunLogs) -> Table:
    """Every metric in the first and the last world, with the paired difference.

    No rows with one world. Metrics that no episode of a policy defines are left out, and named if
    none of any does.
    """
    first, last = logs.run.worlds[0], logs.run.worlds[-1]
    return every_metric_table(
        "gap",
        f"Every metric, {last} minus {first}",
        list(logs.metrics.values()),
        [_between(logs, policy, last, first) for policy in logs.policies if first != last],
        "The same episodes in both worlds: equal items, drift and starts. Difference: "
        f"{last} minus {first}, mean over the episodes where both are defined",
        (last, first),
        undefined_note(one for one in logs.metrics.values() if not logs.defined(one.key)),
    )


def levels_table(logs: RunLogs) -> Table:
    """Table of the change from each world to the next one, in the headline metrics."""
    steps = list(pairwise(logs.run.worlds))
    scenario = scenario_from_tree(dict(logs.run.scenario), str(logs.folder / "run.json"))
    adds = "; ".join(
        f"+ {world}: {', '.join(added(scenario, before, world)) or 'nothing'}"
        for before, world in steps
    )
    return differences_table(
        "ladder",
        "Fidelity levels",
        [describe(key) for key in HEADLINE],
        [
            _between(logs, policy, world, before, f"+ {world}")
            for policy in logs.policies
            for before, world in steps
        ],
        f"Each row adds a piece of reality to the row above ({adds}), on the same episodes: paired "
        "mean difference and 95 % interval",
        "world",
    )


def gap_figures(logs: RunLogs) -> list[ReportFigure]:
    """Figure of the last world minus the first in the headline metrics; none of one world."""
    first, last = logs.run.worlds[0], logs.run.worlds[-1]
    metrics = [describe(key) for key in HEADLINE if logs.defined(key)]
    if first == last or not metrics:
        return []
    contrasts = [_between(logs, policy, last, first) for policy in logs.policies]
    rows = -(-len(metrics) // COLUMNS)
    figure = canvas(WIDE_IN, rows * (MARGIN_IN + ROW_IN * (len(contrasts) + 1)))
    grid = figure.subplots(rows, COLUMNS, sharey=True, squeeze=False)
    found = judged([[(one.gaps(metric), metric.digits) for one in contrasts] for metric in metrics])
    for axes, metric, gaps in zip(grid.flat, metrics, found, strict=False):
        _draw(axes, [one.case.look for one in contrasts], metric, gaps)
    for axes in grid.flat[len(metrics) :]:
        axes.set_visible(False)
    grid[0, 0].set_yticks(range(len(contrasts)), logs.policies)
    grid[0, 0].set_ylim(len(contrasts) - 0.5, -0.5)
    caption = (
        f"Points: {last} minus {first}, mean over the same episodes; lines: 95 % intervals that "
        "hold together. At 0 a metric is the same in both worlds."
    )
    title = f"{last.capitalize()} minus {first}"
    return [ReportFigure("gap", title, caption, figure, wide=True)]


def _draw(
    axes: Axes, looks: list[style.PolicyStyle], metric: Description, gaps: list[Estimate]
) -> None:
    """Difference and interval of each policy, from top to bottom."""
    axes.axvline(0.0, color=style.MUTED, linewidth=0.8)
    for place, (look, gap) in enumerate(zip(looks, gaps, strict=True)):
        axes.plot([gap.low, gap.high], [place, place], color=look.colour, linewidth=2.0)
        axes.plot([gap.value], [place], color=look.colour, marker=look.marker, markersize=6)
    axes.set_xlabel(axis_label(metric))
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", visible=False)
