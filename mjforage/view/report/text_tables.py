"""Tables of metrics of a run: headline, the paper's, all metrics, and the one for a terminal."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import polars as pl
from rich.table import Table as RichTable
from rich.text import Text

from mjforage.mission.scoring import Description, describe
from mjforage.view.page import style
from mjforage.view.page.table import NOTHING, Number, Row, Table, with_words
from mjforage.view.report.best_marks import NOTE, best_of
from mjforage.view.report.cells import (
    FEW,
    INTERVAL,
    ROUGH,
    TOLD,
    Cell,
    is_rough,
    metrics_table,
    minutes,
    needed_digits,
    number,
    number_cell,
    row,
    span,
    spread,
    summary_cell,
)
from mjforage.view.report.published import (
    STRAIGHT,
    STRAIGHT_NOTE,
    Published,
    elsewhere,
    published_for,
)
from mjforage.view.report.run_logs import UNDEFINED, RunLogs, Summary, case_name, parse_summary

HEADLINE = ("pta_d", "pta_c", "below_90", "rmse", "nt50", "nt90", "csr", "length")
TERMINAL = ("pta_d", "pta_c", "below_90", "rmse", "nt90", "csr")
NOBODY: Mapping[str, str] = MappingProxyType({})
LINKED = (*TERMINAL[:5], "handover")  # where it is defined; no more would fit


def _paper_rows(known: Published, metrics: Sequence[Description], map_: str) -> list[Row]:
    """Rows of the means that the paper prints, and of its public code over many seeds."""
    nan = float("nan")
    return [
        row(
            source.run.format(map_),
            [
                number_cell(source.mean.get(m.key, nan), m.digits, source.interval.get(m.key, nan))
                for m in metrics
            ],
            paper=True,
        )
        for source in known.sources
        if any(metric.key in source.mean for metric in metrics)
    ]


def metric_table(
    logs: RunLogs,
    name: str,
    title: str,
    keys: Sequence[str],
    *,
    paper: bool = True,
    notes: Sequence[str] = (),
) -> Table:
    """Policies down, metrics across; the paper's figures under the policies that it has.

    What policies are told of the items is a column where any is told something.
    """
    metrics = [describe(key) for key in keys]
    best = [best_of(logs, metric) for metric in metrics]
    rows: list[Row] = []
    told: list[str] = []
    for case in logs.by_policy:
        pairs = zip(metrics, best, strict=True)
        cells = [summary_cell(case, metric, case in winners) for metric, winners in pairs]
        rows.append(row(case.head, cells, case.look.colour))
        known = published_for(logs.run, case.policy) if paper else None
        if known and case.world == logs.run.worlds[-1]:
            rows += _paper_rows(known, metrics, elsewhere(logs.run))
        told += [logs.run.told.get(case.policy, NOTHING)] + [NOTHING] * (len(rows) - len(told) - 1)
    straight = any(one.paper and one.head.startswith(STRAIGHT) for one in rows)
    notes = (*notes, *([STRAIGHT_NOTE] if straight else ()))
    table = metrics_table(name, title, metrics, rows, notes)
    return with_words(table, TOLD, told) if logs.run.told else table


def headline_table(logs: RunLogs) -> Table:
    """Return the few numbers that a reader wants first."""
    note = (
        f"{INTERVAL}; {NOTE}. NT_50 and NT_90 are shares of the horizon, "
        f"{number(minutes(logs.run, logs.run.horizon), 0)} min; a share that is never removed "
        "counts as the whole of it."
    )
    return metric_table(logs, "headline", "Result in brief", HEADLINE, paper=False, notes=[note])


def paper_table(logs: RunLogs) -> Table:
    """Return our numbers of the metrics of the paper's Tables 2 to 4, with its own below."""
    keys = ("pta_d", "pta_c", "rmse", "rmse_columns", "nt50", "nt90", "throughput", "csr")
    notes = (
        "RMSE_columns is the number that the paper printed; RMSE follows its equation. The "
        "sensitivity slopes of its Table 4 come from `mjforage study corruption`.",
        f"{INTERVAL}; the paper's own: ± 1.96 SEM; {NOTE}.",
    )
    title = "The paper's Tables 2 to 4"
    return metric_table(logs, "paper", title, keys, notes=notes)


def undefined_note(metrics: Iterable[Description]) -> list[str]:
    """A note on metrics without a number anywhere; none if there are none."""
    labels = [metric.label for metric in metrics]
    return [f"Undefined in every episode: {', '.join(labels)}."] if labels else []


def full_table(logs: RunLogs) -> Table:
    """Every metric: mean, 95 % interval, IQM, mean of the worst 5 %, and n; dashes without it.

    Those of a link, and others that no episode of the run defines, are only named.
    """
    nowhere = [m for m in logs.metrics.values() if logs.has(m.key) and not logs.defined(m.key)]
    rows = [
        row(
            case.head,
            full_cells(case.summary(metric.key), metric),
            case.look.colour,
            group=metric.head,
            note=metric.definition,
            group_better=metric.better,
        )
        for metric in logs.metrics.values()
        if metric not in nowhere
        for case in logs.by_policy
    ]
    columns = ("mean", "95 % interval", "IQM", "worst 5 %", "n")
    notes = (
        f"{INTERVAL}. IQM: mean of the middle half. Worst 5 %: mean of the worst twentieth of the "
        "episodes. n: episodes where the metric is defined; the others are left out.",
        *undefined_note(nowhere),
    )
    return Table("metrics", "All metrics", columns, tuple(rows), notes)


def full_cells(entry: Summary, metric: Description) -> tuple[Cell, ...]:
    """Cells of `full_table` for one entry."""
    digits = metric.digits
    words = span(entry.low, entry.high, digits) if entry.low == entry.low else NOTHING
    words += f" {ROUGH}" if entry.n > 1 and is_rough(metric, entry.n) else ""
    return (
        number_cell(entry.mean, digits),
        Cell(words, Number(float("nan"), entry.low, entry.high)),
        number_cell(entry.iqm, digits),
        number_cell(entry.worst, digits),
        Cell(str(entry.n), Number(entry.n)),
    )


def terminal_table(
    summary: Mapping[str, Any],
    bounds: Collection[str] = (),
    told: Mapping[str, str] = NOBODY,
) -> RichTable:
    """Headline numbers of a `summary.json` for the terminal, mean and 95 % interval below it.

    Raises `UserError` if an entry lacks a key or holds something that is not a number.

    Parameters
    ----------
    summary
        {world: {policy: {metric: {"mean", "sem", "ci95", "iqm", "worst5", "n"}}}}
    bounds, told
        as of `RunInfo`
    """
    parsed = parse_summary(summary)
    cases = [(world, policy) for world in parsed for policy in style.ordered(parsed[world])]

    def defined(key: str) -> bool:
        return any(parsed[world][policy].get(key, UNDEFINED).n for world, policy in cases)

    keys = filter(defined, LINKED) if defined("handover") else TERMINAL
    metrics = [describe(key) for key in keys]
    title = f"mean, 95 % interval; {ROUGH}: fewer than {FEW} episodes, it covers less often"
    title += "\n(below a policy): what it is told of the items" if told else ""
    table = _titled(title)
    table.add_column("policy", no_wrap=True)
    for metric in metrics:
        # Longer units would not fit 80 columns; the report has them.
        unit = f"\n[{metric.unit}]" if 0 < len(metric.unit) <= len("steps") else "\n"
        table.add_column(Text(metric.plain + unit), justify="right", no_wrap=True)
    for world, policy in cases:
        found = [parsed[world][policy].get(metric.key, UNDEFINED) for metric in metrics]
        cells = map(_terminal_cell, found, metrics)
        name = case_name(world, policy, list(parsed), bounds).replace(" (bound)", "\n(bound)")
        if policy in told and policy not in bounds:
            name += f"\n({told[policy]})"
        head = Text(name, style=style.policy_colour(policy))
        table.add_row(head, *map(Text, cells))
    return table


def _titled(title: str) -> RichTable:
    """A table without lines for the terminal, not filled in."""
    return RichTable(
        title=title, title_justify="left", title_style="dim", box=None, padding=(0, 1, 0, 0)
    )


def plain_table(table: Table) -> RichTable:
    """A report's table for the terminal, intervals below their numbers."""
    shown = _titled(table.title)
    shown.add_column(table.head, no_wrap=True)
    for name, unit in zip(table.columns, table.units, strict=True):
        shown.add_column(Text(f"{name}\n[{unit}]"), justify="right", no_wrap=True)
    for one in table.rows:
        cells = (cell.replace(" (", "\n").rstrip(")").replace(" to ", "–") for cell in one.cells)
        shown.add_row(Text(one.head, style=one.colour), *map(Text, cells))
    return shown


def needed_table(needed: pl.DataFrame, difference: float) -> RichTable:
    """Rows of `Run.episodes_needed`, for the terminal."""
    metric = describe(needed["metric"][0])
    table = _titled(
        f"episodes that find a difference of {difference:g} in {metric.plain} {metric.unit}"
    )
    for column in ("world", "policy", "SD", "episodes"):
        table.add_column(column, justify="right" if column in ("SD", "episodes") else "left")
    for world, policy, _, sd, episodes in needed.iter_rows():
        told = NOTHING if episodes is None else f"{episodes:,}"
        spread = NOTHING if sd is None else number(sd, metric.digits)
        table.add_row(world, policy, spread, told)
    return table


def _terminal_cell(entry: Summary, metric: Description) -> str:
    """Mean, below it its interval in the digits that it needs, and whether that is rough."""
    mean = number(entry.mean, metric.digits)
    if math.isnan(entry.low):
        return mean
    digits = min(metric.digits, needed_digits((entry.high - entry.low) / 2, metric.digits))
    around = spread(entry.number, digits).replace(" to ", "–")
    return "\n".join([mean, around, *([ROUGH] if is_rough(metric, entry.n) else [])])
