"""Tables of cases beside one another: their means, and differences on the same episodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mjforage.metrics import probability_of_improvement, statistics
from mjforage.mission.scoring import Description
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.cells import (
    NORMAL_95,
    Cell,
    metrics_table,
    number_cell,
    row,
    summary_cell,
)
from mjforage.view.report.differences import (
    Difference,
    corrected,
    family_note,
    judged,
    set_apart,
)
from mjforage.view.report.run_logs import Case

SAME = "Mean difference over the same episodes, with its bootstrap 95 % interval of itself alone"
CHANCE = (
    " P(better): probability that an episode of the first policy beats one of the second, ties "
    "counting half."
)


@dataclass(frozen=True)
class Contrast:
    """A case minus another, as a row of a table."""

    head: str
    case: Case
    against: Case
    group: str = ""

    def gap(self, metric: Description) -> Difference:
        """Their difference in a metric."""
        return Difference(self.case.values(metric.key), self.against.values(metric.key), metric)


@dataclass(frozen=True)
class _Line:
    """A contrast in one metric."""

    contrast: Contrast
    metric: Description

    @cached_property
    def gap(self) -> Difference:
        return self.contrast.gap(self.metric)

    def ends(self, cases: Sequence[Case]) -> list[Cell]:
        """Mean ± 1.96 SEM of each case."""
        found = [case.values(self.metric.key) for case in cases]
        return [
            number_cell(
                float(statistics.mean(x)), self.metric.digits, NORMAL_95 * float(statistics.sem(x))
            )
            for x in found
        ]

    def chance(self) -> Cell:
        """Probability that the case is better in an episode; undefined without a direction."""
        cases, way = (self.contrast.case, self.contrast.against), self.metric.better
        x, y = (way * case.values(self.metric.key) for case in cases)
        share = probability_of_improvement(x, y) if way else np.nan
        return number_cell(float(share), 2)

    @property
    def defined(self) -> bool:
        """True if the metric is defined in some episode of either case."""
        cases = (self.contrast.case, self.contrast.against)
        return any(np.isfinite(case.values(self.metric.key)).any() for case in cases)


def means_table(
    name: str,
    title: str,
    metrics: Sequence[Description],
    groups: Mapping[str, Mapping[str, Case]],
) -> Table:
    """Mean of each metric, group by group of cases, each under the head of its row."""
    rows = [
        row(head, [summary_cell(case, m) for m in metrics], case.look.colour, group=group)
        for group, cases in groups.items()
        for head, case in cases.items()
    ]
    return metrics_table(name, title, metrics, rows, ["Mean ± 1.96 SEM."], head="variant")


def differences_table(
    name: str,
    title: str,
    metrics: Sequence[Description],
    contrasts: Sequence[Contrast],
    words: str = SAME,
    head: str = "variant",
) -> Table:
    """A row per contrast, a column per metric that has a difference, bold where it differs from 0.

    Parameters
    ----------
    words : name of a difference
    head : head of the column of row names
    """
    found = [{metric: one.gap(metric) for metric in metrics} for one in contrasts]
    metrics = [m for m in metrics if any(gaps[m].n for gaps in found)] or metrics
    lines = [[gaps[metric] for metric in metrics] for gaps in found]
    rows = [
        row(one.head, cells, one.case.look.colour, group=one.group)
        for one, cells in zip(contrasts, judged(lines), strict=True)
    ]
    note = f"{words}; {family_note([one for line in lines for one in line])}."
    return metrics_table(name, title, metrics, rows, [note], stacked=True, head=head)


def every_metric_table(
    name: str,
    title: str,
    metrics: Sequence[Description],
    contrasts: Sequence[Contrast],
    words: str,
    ends: Sequence[str] = (),
    *,
    swapped: bool = False,
    notes: Sequence[str] = (),
) -> Table:
    """A row per contrast and metric: the difference with its interval and p, bold if it is not 0.

    Parameters
    ----------
    words : name of a difference
    ends : what both cases are called, whose means stand first; none: P(better) stands last
    swapped : True if the one that is subtracted comes first
    """
    every = [_Line(one, metric) for one in contrasts for metric in metrics]
    lines = [line for line in every if line.defined]
    family = [line.gap for line in lines]
    rows: list[Row] = []
    for line, p, apart in zip(lines, corrected(family), set_apart(family), strict=True):
        cases = (line.contrast.case, line.contrast.against)
        cells = [
            *(line.ends(cases[:: -1 if swapped else 1]) if ends else ()),
            *line.gap.cells(p, apart),
            *(() if ends else (line.chance(),)),
            Cell(str(line.gap.n), Number(line.gap.n)),
        ]
        group, better = line.contrast.group, line.metric.better
        rows.append(row(line.metric.head, cells, group=group, better=better))
    note = f"{words}; {family_note(family)} (p).{'' if ends else CHANCE}"
    columns = ("difference", "95 % interval", "p", *(() if ends else ("P(better)",)), "n")
    return Table(name, title, (*ends, *columns), tuple(rows), (note, *notes), head="metric")
