"""How performance falls as a team's actions become random: slopes, break points, figures."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from mjforage.metrics import (
    BreakTest,
    Line,
    SensitivityIntervals,
    TwoSegments,
    bootstrap_sensitivity,
    break_test,
    half_width_95,
    mean,
    sensitivity_slope,
    two_segment_fit,
)
from mjforage.mission.mission_metrics import describe
from mjforage.runs.variants import corrupted_name, levels
from mjforage.view.page import style
from mjforage.view.page.figure import (
    WIDTH_IN,
    Panel,
    ReportFigure,
    canvas,
    house_style,
    joined,
    mathtext,
)
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.differences import SEED
from mjforage.view.report.published import elsewhere, published_for
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.studies.study_page import Section
from mjforage.view.report.text_tables import NOTHING, number, policy_name

KEYS = ("pta_c", "pta_d", "rmse_columns", "rmse")
COLUMNS = ("ε = 0", "ε = 1", "SS", "break", "before", "after", "gain %", "p of one line")
SIGNIFICANT = 0.05
ROUNDING = 1e-20  # of squares of sums of floats, relative
SAME_LEVEL = 0.1  # of a step between levels: a break this near to a level lies on it


@dataclass(frozen=True)
class Fit:
    """One metric of one policy over the levels of corruption of one team."""

    levels: NDArray[np.float64]  # (level,)
    means: NDArray[np.float64]  # (level,)
    half: NDArray[np.float64]  # (level,) 1.96 SEM
    line: Line
    bent: TwoSegments
    intervals: SensitivityIntervals
    test: BreakTest

    @property
    def bends(self) -> bool:
        """Whether the line leaves more than rounding errors to a break."""
        return float(self.line.sse) > ROUNDING * float(np.sum(self.means**2))

    @property
    def slopes(self) -> tuple[float, float]:
        """Slopes before and after the break; NaN for a segment of one level beside the break."""
        at = float(self.bent.break_point)
        before, after = float(self.bent.slope_before), float(self.bent.slope_after)
        near = SAME_LEVEL * float(self.levels[1] - self.levels[0])
        left = np.count_nonzero(self.levels < at - near)
        right = np.count_nonzero(self.levels > at + near)
        return before if left > 1 else float("nan"), after if right > 1 else float("nan")


def teams(logs: StudyLogs) -> list[str]:
    """Teams that were corrupted."""
    everyone = logs.base.scenario["team"]
    return [team for team in everyone if corrupted_name(team, 1.0) in logs.runs]


class Fits:
    """Fits of a study, each made once; None where a mean is undefined."""

    def __init__(self, logs: StudyLogs) -> None:
        self._logs, self._levels = logs, np.array(levels(float(logs.options["step"])))
        self.of = lru_cache(maxsize=None)(self._of)

    def _of(self, team: str, world: str, policy: str, key: str) -> Fit | None:
        values = np.stack(
            [
                self._logs.values(Player(corrupted_name(team, level), world, policy), key)
                for level in self._levels
            ]
        )
        means = mean(values)
        if not np.isfinite(means).all():
            return None
        return Fit(
            self._levels,
            means,
            half_width_95(values),
            sensitivity_slope(self._levels, means),
            two_segment_fit(self._levels, means),
            bootstrap_sensitivity(self._levels, values, SEED),
            break_test(self._levels, values, SEED),
        )


def _span(ends: tuple[float, float], digits: int) -> str:
    return f"{number(ends[0], digits)} to {number(ends[1], digits)}"


def _cells(fit: Fit | None, digits: int) -> tuple[str, ...]:
    if fit is None:
        return (NOTHING,) * len(COLUMNS)
    within = fit.intervals
    straight = (
        number(float(fit.means[0]), digits),
        number(float(fit.means[-1]), digits),
        f"{number(float(fit.line.slope), digits)} ({_span(within.slope, digits)})",
    )
    if not fit.bends:
        return (*straight, *(NOTHING,) * (len(COLUMNS) - 3))
    return (
        *straight,
        f"{number(float(fit.bent.break_point), 2)} ({_span(within.break_point, 2)})",
        *(number(slope, digits) for slope in fit.slopes),
        number(100 * (1 - float(fit.bent.sse) / float(fit.line.sse)), 0),
        "< 0.001" if fit.test.p < 0.001 else number(fit.test.p, 3),
    )


def _values(fit: Fit | None) -> tuple[Number, ...]:
    """The numbers of `_cells`."""
    if fit is None:
        return (Number(float("nan")),) * len(COLUMNS)
    within = fit.intervals
    ends = Number(float(fit.means[0])), Number(float(fit.means[-1]))
    slope = Number(float(fit.line.slope), *within.slope)
    if not fit.bends:
        return (*ends, slope, *(Number(float("nan")),) * (len(COLUMNS) - 3))
    return (
        *ends,
        slope,
        Number(float(fit.bent.break_point), *within.break_point),
        *map(Number, fit.slopes),
        Number(100 * (1 - float(fit.bent.sse) / float(fit.line.sse))),
        Number(fit.test.p),
    )


def unlike_draws(logs: StudyLogs) -> str:
    """What keeps the paper's slopes from being compared with ours; nothing with its own rule."""
    if logs.options["whole_team"]:
        return ""
    return "paper: one draw for the team; ours: one per agent"


def _slope_notes(logs: StudyLogs, printed: bool) -> tuple[str, ...]:
    """What the columns mean; `printed`: with the paper's rows among them."""
    draw = (
        "One draw for the whole team, and random foragers still take a known item beside them, as "
        "in the published code."
        if logs.options["whole_team"]
        else "Every agent has its own draw, as the paper defines it."
    )
    if printed and unlike_draws(logs):
        draw += " Its printed slopes were made with one draw for the whole team (`--whole-team`)."
    return (
        "The arrow beside a metric holds for its means at ε = 0 and 1 and for SS. "
        "SS: slope of the least-squares line through the means, per unit of ε, with the bootstrap "
        "95 % interval over episodes (the same ones at every level). Break: where two joined "
        "segments meet, with their slopes before and after, and its interval; gain: share of the "
        "line's squared residuals that the break removes.",
        "p of one line: how often sweeps whose means lie on one line gain as much (F ratio of two "
        "segments against one line, over resampled episodes moved onto the line, each searched for "
        f"its own break), bold below {SIGNIFICANT:g}, not corrected for the number of tests. Then "
        "the fall is not straight, but a smooth bend shows so too; with fewer than 20 episodes p "
        "is too small too often. A break on the first or last level inside means that one end "
        "point stands apart, not that there are two regimes; that side then has no slope (–).",
        draw,
    )


def slopes_table(logs: StudyLogs, fits: Fits) -> Table:
    """Slopes and break points per corrupted team and metric."""
    rows, found = [], (published_for(logs.base, policy) for policy in logs.base.policies)
    printed = {pair for known in found if known for pair in known.slopes}
    for team in teams(logs):
        for metric in map(describe, KEYS):
            group = f"{team} corrupted, {metric.label}"
            note = unlike_draws(logs) if (team, metric.key) in printed else ""
            for policy in style.ordered(logs.base.policies):
                for world in logs.worlds:
                    fit = fits.of(team, world, policy, metric.key)
                    head = policy_name(policy, logs.bounds) + logs.suffix(world)
                    cells, colour = _cells(fit, metric.digits), style.policy_colour(policy)
                    bent = fit is not None and fit.test.p < SIGNIFICANT
                    best = frozenset({len(COLUMNS) - 1} if bent else ())
                    row = Row(head, cells, colour, best=best, group=group, note=note)
                    row = replace(row, group_better=metric.better)
                    rows.append(replace(row, values=_values(fit)))
                known = published_for(logs.base, policy)
                if known and (team, metric.key) in known.slopes:
                    slope = known.slopes[team, metric.key]
                    text, rest = number(slope, metric.digits), len(COLUMNS) - 3
                    cells = (NOTHING, NOTHING, text, *(NOTHING,) * rest)
                    values = (None, None, Number(slope), *(None,) * rest)
                    head = f"{known.algorithm}, paper{elsewhere(logs.base)}"
                    row = Row(head, cells, group=group, paper=True, values=values)
                    rows.append(replace(row, group_better=metric.better))
    notes = _slope_notes(logs, any(row.paper for row in rows))
    return Table("slopes", "Sensitivity slopes", COLUMNS, tuple(rows), notes)


def _draw(axes: Axes, fit: Fit, look: style.PolicyStyle, line: style.Line) -> None:
    x = fit.levels
    axes.fill_between(
        x, fit.means - fit.half, fit.means + fit.half, color=look.colour, alpha=0.14, linewidth=0
    )
    axes.plot(x, fit.means, **look.dots, markersize=4)
    axes.plot(x, fit.line.intercept + fit.line.slope * x, color=look.colour, linestyle=line)
    if not fit.bends:
        return
    at, height = float(fit.bent.break_point), float(fit.bent.height)
    ends = [
        height + float(fit.bent.slope_before) * (x[0] - at),
        height,
        height + float(fit.bent.slope_after) * (x[-1] - at),
    ]
    axes.plot([x[0], at, x[-1]], ends, color=look.colour, linewidth=1.0, linestyle=":")
    axes.plot(at, height, "|", color=look.colour, markersize=14, markeredgewidth=1.6)


def picture(logs: StudyLogs, fits: Fits, team: str) -> ReportFigure:
    """Every metric over the corruption of one team, as the paper's two CSSC figures."""
    panel = Panel(style.ordered(logs.base.policies), logs.worlds)
    with house_style():
        figure = canvas(WIDTH_IN, 1.1 + 2.6 * len(KEYS))
        grid = figure.subplots(len(KEYS), 1, sharex=True, squeeze=False)
        for axes, metric in zip(grid[:, 0], map(describe, KEYS), strict=True):
            for policy, look in panel.styles().items():
                for world, line in panel.lines().items():
                    fit = fits.of(team, world, policy, metric.key)
                    if fit is not None:
                        _draw(axes, fit, look, line)
            axes.set_ylabel(f"{mathtext(metric.label)}  [{metric.unit}]")
            axes.set_xlim(-0.02, 1.02)
        grid[-1, 0].set_xlabel(f"corruption ε of {team}")
        panel.legend(figure)
    words = (
        "Markers: means of the episodes, bands ± 1.96 SEM; lines: least squares, whose slope is "
        "SS; dotted: two segments, with a stroke at the break point."
    )
    words += _published(logs, team)
    return ReportFigure(f"corruption-{team}", f"Corruption of {team}", words, figure)


def _published(logs: StudyLogs, team: str) -> str:
    """The paper's slopes of a team, as a sentence; nothing where there are none to compare with."""
    found: dict[str, list[str]] = {}
    for policy in style.ordered(logs.base.policies):
        known = published_for(logs.base, policy)
        for (whose, key), slope in known.slopes.items() if known else ():
            if known and whose == team:
                words = f"{number(slope, describe(key).digits)} ({known.algorithm})"
                found.setdefault(describe(key).label, []).append(words)
    rule = f" ({unlike_draws(logs)})" if unlike_draws(logs) else ""
    return "".join(
        f" The paper's SS of {label}{elsewhere(logs.base)}: {joined(words)}{rule}."
        for label, words in found.items()
    )


def sections(logs: StudyLogs, fits: Fits | None = None) -> list[Section]:
    """The page's sections; `fits` where some were made already."""
    fits = fits or Fits(logs)
    drawn = [picture(logs, fits, team) for team in teams(logs)]
    replaced = (
        "With probability ε, drawn once per step for the whole team, each of its agents takes a "
        "uniform random legal action; foragers then still take a known item beside them."
        if logs.options["whole_team"]
        else "Each action of a team is replaced by a uniform random legal one with probability ε."
    )
    words = (
        f"{replaced} The steeper the other team's performance falls, the more it depends on this "
        "one."
    )
    title = "Sensitivity to corruption"
    return [Section("corruption", title, words, [slopes_table(logs, fits)], drawn)]
