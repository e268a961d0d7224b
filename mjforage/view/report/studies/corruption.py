"""Performance as a team's actions become random: slopes, break points, figures."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from mjforage.metrics import (
    Line,
    SensitivityIntervals,
    TwoSegments,
    bootstrap_sensitivity,
    half_width_95,
    mean,
    sensitivity_slope,
    two_segment_fit,
)
from mjforage.mission.scoring import describe
from mjforage.runs.studies.variants import corrupted_name, levels
from mjforage.view.page import style
from mjforage.view.page.figure import WIDTH_IN, Panel, ReportFigure, canvas, house_style
from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.cells import UNDEFINED, Cell, interval_cell, number_cell, row
from mjforage.view.report.curves import axis_label
from mjforage.view.report.differences import SEED
from mjforage.view.report.published import elsewhere, published_for
from mjforage.view.report.run_logs import FloatArray, policy_name
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.study_logs import StudyLogs

KEYS = ("pta_c", "pta_d", "rmse_columns", "rmse")
COLUMNS = ("ε = 0", "ε = 1", "SS", "break", "before", "after", "gain %")
ROUNDING = 1e-20  # of squares of sums of floats, relative
SAME_LEVEL = 0.1  # of a step between levels: a break this near to a level lies on it


@dataclass(frozen=True)
class Fit:
    """One metric of one policy over the levels of corruption of one team."""

    levels: FloatArray  # (level,)
    means: FloatArray  # (level,)
    half: FloatArray  # (level,) 1.96 SEM
    line: Line
    bent: TwoSegments
    intervals: SensitivityIntervals

    @property
    def bends(self) -> bool:
        """True if the line leaves more than rounding errors to a break."""
        return float(self.line.sse) > ROUNDING * float(np.sum(self.means**2))

    @property
    def slope(self) -> Number:
        """Slope of the line with its interval."""
        return Number(float(self.line.slope), *self.intervals.slope)

    @property
    def slopes(self) -> tuple[float, float]:
        """Slopes before and after the break; NaN for a segment of one level beside the break."""
        at = float(self.bent.break_point)
        before, after = float(self.bent.slope_before), float(self.bent.slope_after)
        near = SAME_LEVEL * float(self.levels[1] - self.levels[0])
        left = np.count_nonzero(self.levels < at - near)
        right = np.count_nonzero(self.levels > at + near)
        return before if left > 1 else float("nan"), after if right > 1 else float("nan")

    def draw(self, axes: Axes, look: style.PolicyStyle, line: style.Line) -> None:
        """Draw means with bands, the line, and two segments with a stroke at the break."""
        x, colour = self.levels, look.colour
        ends = self.means - self.half, self.means + self.half
        axes.fill_between(x, *ends, color=colour, alpha=0.14, linewidth=0)
        axes.plot(x, self.means, **look.dots, markersize=4)
        axes.plot(x, self.line.intercept + self.line.slope * x, color=colour, linestyle=line)
        if self.bends:
            at, height = float(self.bent.break_point), float(self.bent.height)
            first = height + float(self.bent.slope_before) * (x[0] - at)
            last = height + float(self.bent.slope_after) * (x[-1] - at)
            segments = [x[0], at, x[-1]], [first, height, last]
            axes.plot(*segments, color=colour, linewidth=1.0, linestyle=":")
            axes.plot(at, height, "|", color=colour, markersize=14, markeredgewidth=1.6)


def fit_levels(levels: FloatArray, values: FloatArray) -> Fit | None:
    """Fit (level, episode) values; None where a mean is undefined."""
    means = mean(values)
    if not np.isfinite(means).all():
        return None
    return Fit(
        levels,
        means,
        half_width_95(values),
        sensitivity_slope(levels, means),
        two_segment_fit(levels, means),
        bootstrap_sensitivity(levels, values, SEED),
    )


def teams(logs: StudyLogs) -> list[str]:
    """Teams that were corrupted."""
    everyone = logs.base.scenario["team"]
    return [team for team in everyone if corrupted_name(team, 1.0) in logs.runs]


class Fits:
    """Fits of a study, each made once; None where a mean is undefined."""

    def __init__(self, logs: StudyLogs) -> None:
        self._logs, self._levels = logs, np.array(levels(float(logs.info.options["step"])))
        self.of = lru_cache(maxsize=None)(self._of)

    def _of(self, team: str, world: str, policy: str, key: str) -> Fit | None:
        names = [corrupted_name(team, level) for level in self._levels]
        values = [self._logs.case(name, world, policy).values(key) for name in names]
        return fit_levels(self._levels, np.stack(values))


def slope_cell(fit: Fit | None, digits: int) -> Cell:
    """SS with its bootstrap interval."""
    return interval_cell(fit.slope, digits) if fit else UNDEFINED


def fit_cells(fit: Fit | None, digits: int) -> Iterator[Cell]:
    """Cells of `COLUMNS`."""
    if fit is None:
        yield from (UNDEFINED,) * len(COLUMNS)
        return
    yield from (number_cell(float(one), digits) for one in (fit.means[0], fit.means[-1]))
    yield slope_cell(fit, digits)
    if not fit.bends:
        yield from (UNDEFINED,) * (len(COLUMNS) - 3)
        return
    yield interval_cell(Number(float(fit.bent.break_point), *fit.intervals.break_point), 2)
    yield from (number_cell(slope, digits) for slope in fit.slopes)
    yield number_cell(100 * (1 - float(fit.bent.sse) / float(fit.line.sse)), 0)


def unlike_draws(logs: StudyLogs) -> str:
    """Difference in draws that makes the paper's slopes incomparable; "" with the paper's rule."""
    if logs.info.options["whole_team"]:
        return ""
    return "paper: one draw for the team; ours: one per agent"


def _slope_notes(logs: StudyLogs, printed: bool) -> tuple[str, ...]:
    """Notes on the columns; `printed`: with the paper's rows among them."""
    draw = (
        "One draw for the whole team, and random foragers still take a known item beside them, as "
        "in the published code."
        if logs.info.options["whole_team"]
        else "Every agent has its own draw, as the paper defines it."
    )
    if printed and unlike_draws(logs):
        draw += " Its printed slopes were made with one draw for the whole team (whole_team)."
    return (
        "The arrow beside a metric holds for its means at ε = 0 and 1 and for SS. "
        "SS: slope of the least-squares line through the means, per unit of ε, with the bootstrap "
        "95 % interval over episodes (the same ones at every level). Break: where two joined "
        "segments meet, with their slopes before and after, and its interval; gain: share of the "
        "line's squared residuals that the break removes.",
        "A break on the first or last level inside means that one end point stands apart, not that "
        "there are two regimes; that side then has no slope (–). A smooth bend gains, too.",
        draw,
    )


def slopes_table(logs: StudyLogs, fits: Fits) -> Table:
    """Slopes and break points per corrupted team and metric."""
    rows: list[Row] = []
    for team in teams(logs):
        for metric in map(describe, KEYS):
            found = {policy: published_for(logs.base, policy) for policy in logs.policies}
            pair = team, metric.key
            printed = {one: known for one, known in found.items() if known and pair in known.slopes}
            about: dict[str, Any] = {
                "group": f"{team} corrupted, {metric.label}",
                "group_better": metric.better,
                "note": unlike_draws(logs) if printed else "",
            }
            for policy in logs.policies:
                head, colour = policy_name(policy, logs.bounds), style.policy_colour(policy)
                for world in logs.worlds:
                    cells = fit_cells(fits.of(team, world, policy, metric.key), metric.digits)
                    rows.append(row(head + logs.suffix(world), cells, colour, **about))
                if known := printed.get(policy):
                    theirs: list[Cell] = [Cell(NOTHING)] * len(COLUMNS)
                    theirs[COLUMNS.index("SS")] = number_cell(known.slopes[pair], metric.digits)
                    head = f"{known.algorithm}, paper{elsewhere(logs.base)}"
                    rows.append(row(head, theirs, paper=True, **about))
    notes = _slope_notes(logs, any(one.paper for one in rows))
    return Table("slopes", "Sensitivity slopes", COLUMNS, tuple(rows), notes)


def picture(logs: StudyLogs, fits: Fits, team: str) -> ReportFigure:
    """Every metric over the corruption of one team, as the paper's two CSSC figures."""
    panel = Panel(logs.policies, logs.worlds)
    with house_style():
        figure = canvas(WIDTH_IN, 1.1 + 2.6 * len(KEYS))
        grid = figure.subplots(len(KEYS), 1, sharex=True, squeeze=False)
        for axes, metric in zip(grid[:, 0], map(describe, KEYS), strict=True):
            for policy, look in panel.styles().items():
                for world, line in panel.lines().items():
                    if fit := fits.of(team, world, policy, metric.key):
                        fit.draw(axes, look, line)
            axes.set_ylabel(axis_label(metric))
            axes.set_xlim(-0.02, 1.02)
        grid[-1, 0].set_xlabel(f"corruption ε of {team}")
        panel.legend(figure)
    words = (
        "Markers: means of the episodes, bands ± 1.96 SEM; lines: least squares, whose slope is "
        "SS; dotted: two segments, with a stroke at the break point."
    )
    title = f"Corruption of {team}"
    return ReportFigure(f"corruption-{team}", title, words, figure)


def sections(logs: StudyLogs, fits: Fits | None = None) -> list[Section]:
    """The page's sections; `fits` where some were made already."""
    fits = fits or Fits(logs)
    replaced = (
        "With probability ε, drawn once per step for the whole team, each of its agents takes a "
        "uniform random legal action; foragers then still take a known item beside them."
        if logs.info.options["whole_team"]
        else "Each action of a team is replaced by a uniform random legal one with probability ε."
    )
    words = (
        f"{replaced} The steeper the other team's performance falls, the more it depends on this "
        "one."
    )
    drawn = [picture(logs, fits, team) for team in teams(logs)]
    title = "Sensitivity to corruption"
    return [Section("corruption", title, words, [slopes_table(logs, fits)], drawn)]
