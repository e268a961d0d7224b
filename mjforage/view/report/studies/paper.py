"""Everything in the paper: its numbers beside ours, its tables and its figures."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mjforage.mission.scoring import describe
from mjforage.runs.studies.variants import COMPLETE, lesser_name
from mjforage.view.page import style
from mjforage.view.page.figure import house_style
from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.cells import Cell, number_cell, printed_row, row, span, summary_cell
from mjforage.view.report.curves import time_figures
from mjforage.view.report.differences import estimates
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
from mjforage.view.report.reality_gap import gap_tables
from mjforage.view.report.report_page import curve_words
from mjforage.view.report.run_logs import policy_name
from mjforage.view.report.sections import Section
from mjforage.view.report.studies import ablation, corruption
from mjforage.view.report.studies.study_logs import StudyLogs
from mjforage.view.report.text_tables import headline_table, paper_table

UNLIKE = (
    "The paper's numbers are not shown: the scenario, its fleet or another setting is not the "
    "paper's, or no policy is one of its algorithms."
)


@dataclass(frozen=True)
class Beside:
    """A number of the paper and ours, of the same meaning unless `like` is false."""

    name: str
    paper: float
    ours: Number  # with our 95 % interval
    digits: int
    like: bool  # the same quantity, so that it may be asked whether the numbers agree
    place: str = NOTHING  # where the paper shows it
    half: float = float("nan")  # 1.96 SEM of the paper's, NaN where it prints none

    @property
    def cells(self) -> list[Cell]:
        """Place, paper, ours, interval, difference, and agreement."""
        value, low, high = self.ours
        nothing, wide = Cell(NOTHING), np.nan_to_num(self.half)
        if not np.isfinite([low, high]).all():
            theirs = number_cell(self.paper, self.digits)
            return [Cell(self.place), theirs, *(nothing,) * 4]
        meets = low - wide <= self.paper <= high + wide
        return [
            Cell(self.place),
            number_cell(self.paper, self.digits, self.half),
            number_cell(value, self.digits),
            Cell(span(low, high, self.digits), Number(float("nan"), low, high)),
            number_cell(value - self.paper, self.digits),
            Cell("yes" if meets else "no") if self.like else nothing,
        ]


def same_world(world: str) -> bool:
    """True if the paper's numbers are of this world."""
    return world == "graph"


def _means(logs: StudyLogs, known: Published, policy: str, world: str) -> Iterator[Beside]:
    mean, interval = known.sources[-1].mean, known.sources[-1].interval
    lesser = {lesser_name(team): values for team, values in known.ablated.items()}
    for variant, values in ({COMPLETE: mean} | lesser).items():
        whole = variant == COMPLETE
        for key, value in values.items() if variant in logs.runs else ():
            metric, entry = describe(key), logs.case(variant, world, policy).summary(key)
            yield Beside(
                f"{metric.label}{'' if whole else f', {logs.title(variant)}'}",
                value,
                entry.number,
                metric.digits,
                same_world(world),
                PLACES.get(key, NOTHING) if whole else "Table 5",
                interval.get(key, float("nan")) if whole else float("nan"),
            )


def _contributions(logs: StudyLogs, known: Published, policy: str, world: str) -> Iterator[Beside]:
    for team in ablation.teams(logs):
        for key, value in known.contribution[team].items():
            (ours,) = estimates([ablation.contribution(logs, team, world, policy, key)])
            name = f"MC of {describe(key).label}, one of {team}"
            yield Beside(name, value, ours.number, 4, same_world(world), "Table 6")


def _slopes(
    logs: StudyLogs, known: Published, policy: str, world: str, fits: corruption.Fits
) -> Iterator[Beside]:
    for (team, key), value in known.slopes.items():
        if fit := fits.of(team, world, policy, key):
            metric = describe(key)
            name = f"SS of {metric.label}, {team} corrupted"
            like = same_world(world) and not corruption.unlike_draws(logs)
            yield Beside(name, value, fit.slope, metric.digits, like, "Table 4")


def beside_table(logs: StudyLogs, fits: corruption.Fits) -> Table:
    """Every number of the paper beside ours; no rows if the run is not one to compare with."""
    rows: list[Row] = []
    found = {policy: published_for(logs.base, policy) for policy in logs.policies}
    beside = {policy: known for policy, known in found.items() if known}
    unlike = corruption.unlike_draws(logs)
    for policy, known in beside.items():
        for world in logs.worlds:
            group = f"{policy} · {world}, beside the paper's {known.algorithm} (graph)"
            means = *_means(logs, known, policy, world), *_contributions(logs, known, policy, world)
            slopes = _slopes(logs, known, policy, world, fits)
            apart = {"group": f"{group}: slopes" if unlike else group, "note": unlike}
            for about, pairs in (({"group": group}, means), (apart, tuple(slopes))):
                colour = style.policy_colour(policy)
                rows += [row(pair.name, pair.cells, colour, **about) for pair in pairs]
    notes = (
        f"{_maps(logs)} Interval: 95 %, over our episodes. Within: whether the paper's "
        "number lies in it, widened by the paper's own ± where it prints one; not given where the "
        "two differ in meaning, with hulls or with another rule of corruption. For the whole fleet "
        "of a baseline the numbers are those that its public code gives over many seeds (Tables 2 "
        "to 4 have what it printed of one).",
        *([STRAIGHT_NOTE] if STRAIGHT in {one.algorithm for one in beside.values()} else []),
    )
    columns = ("in the paper", "paper", "ours", "95 % interval", "difference", "within")
    title = "The paper's numbers beside ours"
    return Table("beside", title, columns, tuple(rows), notes, head="number")


def _maps(logs: StudyLogs) -> str:
    """Sentence on whether paper and study have the same map."""
    if elsewhere(logs.base):
        return "The paper's numbers are of its own map, ours of the map named above."
    return (
        "The paper's numbers are of its own map, and whether that is the one named above is not "
        "known here."
    )


def table_4(logs: StudyLogs, fits: corruption.Fits) -> Table:
    """Return the paper's Table 4: CSR and the two Sensitivity Slopes."""
    rows: list[Row] = []
    pairs = (("scouts", "pta_c"), ("foragers", "rmse_columns"))
    asked = tuple(pair for pair in pairs if pair[0] in corruption.teams(logs))
    csr, *metrics = (describe(key) for key in ("csr", *(key for _, key in asked)))
    for policy in logs.policies:
        for world in logs.worlds:
            case = logs.case(COMPLETE, world, policy)
            cells = [
                corruption.slope_cell(fits.of(team, world, policy, key), describe(key).digits)
                for team, key in asked
            ]
            head = policy_name(policy, logs.bounds) + logs.suffix(world)
            rows.append(row(head, [summary_cell(case, csr), *cells], style.policy_colour(policy)))
        if known := published_for(logs.base, policy):
            theirs = [known.slopes[pair] for pair in asked]
            digits = [metric.digits for metric in metrics]
            printed = [(known.printed.mean["csr"], csr.digits), *zip(theirs, digits, strict=True)]
            head = f"{known.algorithm}, paper{elsewhere(logs.base)}"
            rows.append(printed_row(head, printed))
    columns = ("CSR", *(f"SS of {describe(key).label}, {team}" for team, key in asked))
    title = "Cooperative success ratio and sensitivity slopes (paper's Table 4)"
    unlike = corruption.unlike_draws(logs) if any(one.paper for one in rows) else ""
    note = (
        "SS: change of the metric per unit of ε, the corruption of that team; the arrow is that of "
        "the metric. The nearer to 0, the less the metric depends on that team."
    )
    units, better = ("", *(unlike for _ in asked)), tuple(m.better for m in (csr, *metrics))
    return Table("table-4", title, columns, tuple(rows), (note,), units, better=better)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    fits, whole = corruption.Fits(logs), logs.whole
    first = [headline_table(whole), beside_table(logs, fits)]
    with house_style():
        drawn = [*time_figures(whole), *distribution_figures(whole)]
    return [
        Section("result", "In brief", "" if first[1].rows else UNLIKE, first),
        Section("tables", "Tables 2 to 4", "", [paper_table(whole), table_4(logs, fits)]),
        *corruption.sections(logs, fits),
        *ablation.sections(logs),
        Section("figures", "Figures over time", curve_words(logs.base), pictures=drawn),
        Section("gap", "The reality gap", tables=gap_tables(whole)),
        Section("paired", "Paired comparison", tables=[comparison_table(whole)]),
    ]
