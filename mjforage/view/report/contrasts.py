"""Tables of cases beside one another: their means, and differences on the same episodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mjforage.metrics import probability_of_improvement
from mjforage.mission.scoring import Description
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.cells import (
    INTERVAL,
    Cell,
    metrics_table,
    number_cell,
    row,
    summary_cell,
)
from mjforage.view.report.differences import estimates, family_note, judged
from mjforage.view.report.run_logs import Case, FloatArray

SAME = "Mean difference over the same episodes, with its 95 % interval"
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

    @property
    def cases(self) -> tuple[Case, Case]:
        """Both cases."""
        return self.case, self.against

    def values(self, metric: Description) -> tuple[FloatArray, FloatArray]:
        """(episode,) values of both cases in a metric."""
        return self.case.values(metric.key), self.against.values(metric.key)

    def gaps(self, metric: Description) -> FloatArray:
        """(episode,) their differences in a metric."""
        first, second = self.values(metric)
        return first - second


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
    return metrics_table(name, title, metrics, rows, [f"{INTERVAL}."], head="variant")


def differences_table(
    name: str,
    title: str,
    metrics: Sequence[Description],
    contrasts: Sequence[Contrast],
    words: str = SAME,
    head: str = "variant",
) -> Table:
    """A row per contrast, a column per metric that has a difference, bold where it differs from 0.

    `words`: name of a difference; `head`: head of the column of row names.
    """
    defined = [m for m in metrics if any(np.isfinite(one.gaps(m)).any() for one in contrasts)]
    metrics = defined or metrics
    lines = judged([[(one.gaps(m), m.digits) for m in metrics] for one in contrasts])
    rows = [
        row(one.head, [gap.cell() for gap in gaps], one.case.look.colour, group=one.group)
        for one, gaps in zip(contrasts, lines, strict=True)
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
    notes: Sequence[str] = (),
) -> Table:
    """A row per contrast and metric: the difference with its interval and p, bold if it is not 0.

    Rows of metrics that neither case defines in any episode are left out.

    Parameters
    ----------
    words : name of a difference
    ends : what both cases are called, whose means stand first; none: P(better) stands last
    """
    every = [(one, metric, one.values(metric)) for one in contrasts for metric in metrics]
    lines = [line for line in every if np.isfinite(line[-1]).any()]
    family = estimates([(contrast.gaps(metric), metric.digits) for contrast, metric, _ in lines])
    rows: list[Row] = []
    for (contrast, metric, values), gap in zip(lines, family, strict=True):
        cells = [
            *([summary_cell(one, metric) for one in contrast.cases] if ends else []),
            *gap.cells,
            *([] if ends else [_chance(*values, metric.better)]),
            Cell(str(gap.n), Number(gap.n)),
        ]
        rows.append(row(metric.head, cells, group=contrast.group, better=metric.better))
    note = f"{words}; {family_note(family)}.{'' if ends else CHANCE}"
    columns = ("difference", "95 % interval", "p", *(() if ends else ("P(better)",)), "n")
    return Table(name, title, (*ends, *columns), tuple(rows), (note, *notes), head="metric")


def _chance(x: FloatArray, y: FloatArray, way: int) -> Cell:
    """Probability that an episode of x is better; undefined for a metric without a direction."""
    share = probability_of_improvement(way * x, way * y) if way else np.nan
    return number_cell(float(share), 2)
