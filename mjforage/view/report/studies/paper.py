"""Everything in the paper: its numbers beside ours, its tables and its figures."""

from dataclasses import dataclass, replace

import numpy as np

from mjforage.mission.mission_metrics import describe
from mjforage.runs.variants import COMPLETE, lesser_name
from mjforage.view.page import style
from mjforage.view.page.figure import house_style
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.curves import time_figures
from mjforage.view.report.distributions import distribution_figures
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.published import (
    PLACES,
    STRAIGHT,
    STRAIGHT_NOTE,
    Published,
    elsewhere,
    published_for,
)
from mjforage.view.report.reality_gap import gap_table, ladder_table
from mjforage.view.report.report_page import horizon_words
from mjforage.view.report.studies import ablation, corruption
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.studies.study_page import Section
from mjforage.view.report.text_tables import (
    NOTHING,
    headline_table,
    in_full,
    number,
    paper_tables,
    plus_minus,
    policy_name,
)

UNLIKE = (
    "The paper's numbers are not shown: the scenario, its fleet or another setting is not the "
    "paper's, or no policy is one of its algorithms."
)


@dataclass(frozen=True)
class Beside:
    """A number of the paper and ours, of the same meaning unless `like` is false."""

    name: str
    paper: float
    ours: float
    low: float  # our bootstrap 95 % interval
    high: float
    half: float  # 1.96 SEM of the paper's, 0 where it prints none
    digits: int
    like: bool  # the same quantity, so that it may be asked whether the numbers agree
    place: str = NOTHING  # where the paper shows it

    @property
    def row(self) -> Row:
        """The pair as a row."""
        if not np.isfinite([self.low, self.high]).all():
            cells = (self.place, number(self.paper, self.digits), *(NOTHING,) * 4)
            return Row(self.name, cells, values=(None, self.theirs, *(None,) * 4))
        meets = self.low - self.half <= self.paper <= self.high + self.half
        theirs = number(self.paper, self.digits)
        if self.half:
            theirs += f" ± {number(self.half, self.digits)}"
        cells = (
            self.place,
            theirs,
            number(self.ours, self.digits),
            f"{number(self.low, self.digits)} to {number(self.high, self.digits)}",
            number(self.ours - self.paper, self.digits),
            ("yes" if meets else "no") if self.like else NOTHING,
        )
        ours = Number(self.ours), Number(float("nan"), self.low, self.high)
        values = (None, self.theirs, *ours, Number(self.ours - self.paper), None)
        return Row(self.name, cells, values=values)

    @property
    def theirs(self) -> Number:
        """The paper's number with its interval, unrounded."""
        half = self.half or float("nan")
        return Number(self.paper, self.paper - half, self.paper + half)


def _means(logs: StudyLogs, known: Published, policy: str, world: str) -> list[Beside]:
    found = []
    mean, interval = known.whole_fleet
    fleets = {COMPLETE: mean} | {
        lesser_name(team): values
        for team, values in known.ablated.items()
        if lesser_name(team) in logs.runs
    }
    for variant, values in fleets.items():
        end = "" if variant == COMPLETE else f", {logs.title(variant)}"
        for key, value in values.items():
            metric, entry = describe(key), logs.entry(Player(variant, world, policy), key)
            half = interval.get(key, 0.0) if variant == COMPLETE else 0.0
            ours = (entry.mean, entry.low, entry.high)
            about = half, metric.digits, _same(world)
            where = PLACES.get(key, NOTHING) if variant == COMPLETE else "Table 5"
            found.append(Beside(f"{metric.label}{end}", value, *ours, *about, where))
    return found


def _slopes(
    logs: StudyLogs, known: Published, policy: str, world: str, fits: corruption.Fits
) -> list[Beside]:
    found = []
    for (team, key), value in known.slopes.items():
        fit = fits.of(team, world, policy, key)
        if fit is not None:
            metric, (low, high) = describe(key), fit.intervals.slope
            name = f"SS of {metric.label}, {team} corrupted"
            like = _same(world) and not corruption.unlike_draws(logs)
            slope = float(fit.line.slope)
            about = 0.0, metric.digits, like, "Table 4"
            found.append(Beside(name, value, slope, low, high, *about))
    return found


def _contributions(logs: StudyLogs, known: Published, policy: str, world: str) -> list[Beside]:
    found = []
    for team in ablation.teams(logs):
        for key, value in known.contribution[team].items():
            ours = ablation.contribution(logs, team, world, policy, key)
            name = f"MC of {describe(key).label}, one of {team}"
            about = 0.0, 4, _same(world), "Table 6"
            found.append(Beside(name, value, ours.value, ours.low, ours.high, *about))
    return found


def _same(world: str) -> bool:
    """Whether the paper's numbers are of this world."""
    return world == "graph"


def beside_table(logs: StudyLogs, fits: corruption.Fits) -> Table | None:
    """Every number of the paper beside ours; None where the run is not one to compare with."""
    rows, beside = [], []
    for policy in style.ordered(logs.base.policies):
        known = published_for(logs.base, policy)
        if known is None:
            continue
        beside.append(known)
        for world in logs.worlds:
            group = f"{policy} · {world}, beside the paper's {known.algorithm} (graph)"
            unlike, colour = corruption.unlike_draws(logs), style.policy_colour(policy)
            slopes = f"{group}: slopes" if unlike else group
            for place, note, pairs in (
                (group, "", _means(logs, known, policy, world)),
                (group, "", _contributions(logs, known, policy, world)),
                (slopes, unlike, _slopes(logs, known, policy, world, fits)),
            ):
                for pair in pairs:
                    rows.append(replace(pair.row, colour=colour, group=place, note=note))
    if not rows:
        return None
    notes = (
        f"{_maps(logs)} Interval: bootstrap 95 % over our episodes. Within: whether the paper's "
        "number lies in it, widened by the paper's own ± where it prints one; not asked where the "
        "two are unlike, with hulls or with "
        "another rule of corruption. Of the whole fleet of a baseline the numbers are those that "
        "its public code gives over many seeds (Tables 2 to 4 have what it printed of one).",
        *([STRAIGHT_NOTE] if STRAIGHT in {known.algorithm for known in beside} else []),
    )
    columns = ("in the paper", "paper", "ours", "95 % interval", "difference", "within")
    return Table(
        "beside", "The paper's numbers beside ours", columns, tuple(rows), notes, head="number"
    )


def _slope_cell(fit: corruption.Fit | None, digits: int) -> str:
    """SS with its bootstrap interval."""
    if fit is None:
        return NOTHING
    low, high = (number(end, digits) for end in fit.intervals.slope)
    return f"{number(float(fit.line.slope), digits)} ({low} to {high})"


def _maps(logs: StudyLogs) -> str:
    """Whether paper and study are of one map."""
    if elsewhere(logs.base):
        return "The paper's numbers are of its own map, ours of the map named above."
    return (
        "The paper's numbers are of its own map, and whether that is the one named above is not "
        "known here."
    )


def table_4(logs: StudyLogs, fits: corruption.Fits) -> Table:
    """Return the paper's Table 4: CSR and the two Sensitivity Slopes."""
    rows, found = [], (("scouts", "pta_c"), ("foragers", "rmse_columns"))
    asked = tuple(pair for pair in found if pair[0] in corruption.teams(logs))
    for policy in style.ordered(logs.base.policies):
        for world in logs.worlds:
            csr = logs.entry(Player(COMPLETE, world, policy), "csr")
            cells, values = [plus_minus(csr, 3)], [in_full(csr)]
            for team, key in asked:
                fit = fits.of(team, world, policy, key)
                cells.append(_slope_cell(fit, describe(key).digits))
                values.append(
                    Number(float(fit.line.slope), *fit.intervals.slope)
                    if fit
                    else Number(float("nan"))
                )
            head, colour = (
                policy_name(policy, logs.bounds) + logs.suffix(world),
                style.policy_colour(policy),
            )
            rows.append(Row(head, tuple(cells), colour, values=tuple(values)))
        known = published_for(logs.base, policy)
        if known:
            theirs = [known.printed["csr"], *(known.slopes[pair] for pair in asked)]
            digits = (3, *(describe(key).digits for _, key in asked))
            printed, head = (
                tuple(map(number, theirs, digits)),
                f"{known.algorithm}, paper{elsewhere(logs.base)}",
            )
            rows.append(Row(head, printed, paper=True, values=tuple(map(Number, theirs))))
    columns = ("CSR", *(f"SS of {describe(key).label}, {team}" for team, key in asked))
    title = "Cooperative success ratio and sensitivity slopes (paper's Table 4)"
    unlike = corruption.unlike_draws(logs) if any(row.paper for row in rows) else ""
    units = ("", *(unlike for _ in asked))
    note = (
        "SS: change of the metric per unit of ε, the corruption of that team; the arrow is that of "
        "the metric. The nearer to 0, the less the metric depends on that team."
    )
    better = tuple(describe(key).better for key in ("csr", *(key for _, key in asked)))
    return Table("table-4", title, columns, tuple(rows), (note,), units, better=better)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    fits, whole = corruption.Fits(logs), logs.whole
    compared, beside = comparison_table(whole), beside_table(logs, fits)
    first = [headline_table(whole), beside]
    gaps = [table for table in (ladder_table(whole), gap_table(whole)) if table is not None]
    with house_style():
        curves = [*time_figures(whole), *distribution_figures(whole)]
    figures = (
        "Lines: mean of the episodes; bands: ± 1.96 SEM. Time is normalised by the horizon: "
        f"{horizon_words(logs.base)}."
    )
    found = [
        Section(
            "result",
            "In brief",
            "" if beside else UNLIKE,
            [table for table in first if table is not None],
        ),
        Section("tables", "Tables 2 to 4", "", [*paper_tables(whole)[:2], table_4(logs, fits)]),
        *corruption.sections(logs, fits),
        *ablation.sections(logs),
        Section("figures", "Figures over time", figures, (), curves),
    ]
    if gaps:
        found.append(Section("gap", "The reality gap", "", gaps))
    if compared is not None:
        found.append(Section("paired", "Paired comparison", "", [compared]))
    return found
