"""The report's tables as plain text cells, from the summary, for page and terminal."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rich.table import Table as RichTable
from rich.text import Text

from mjforage.mission.mission_metrics import Description, describe
from mjforage.runs.run_info import RunInfo
from mjforage.view.page import style
from mjforage.view.page.table import NOTHING as NOTHING
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.best_marks import NOTE, best_of
from mjforage.view.report.published import (
    STRAIGHT,
    STRAIGHT_NOTE,
    Published,
    elsewhere,
    published_for,
)
from mjforage.view.report.run_logs import RunLogs, Series, Summaries, Summary, parse_summary

HEADLINE = ("pta_d", "pta_c", "rmse", "nt50", "nt90", "csr", "gini_foragers", "length")
TERMINAL = ("pta_d", "pta_c", "rmse", "nt50", "nt90", "throughput", "csr", "length")
LINKED = (*TERMINAL[:5], "csr", "handover", "length")  # where it is defined; no more would fit
OVER_T = frozenset({"nt50", "nt90", "dsl", "itl", "itl_level", "handover"})
"""Metrics that are times as shares of the horizon."""
NORMAL_95 = 1.96
MORE_DIGITS = 2  # than a metric has, at most, where an interval is narrow


def number(value: float, digits: int) -> str:
    """Fixed decimals with a true minus sign; a dash where undefined."""
    if math.isnan(value):
        return NOTHING
    text = f"{value:.{digits}f}"
    if text.startswith("-"):
        text = text[1:] if float(text) == 0 else f"−{text[1:]}"
    return text


def needed_digits(half: float, usual: int) -> int:
    """Decimals that show two digits of half an interval; `usual` where it has no width.

    At most two more than usual: where all of an interval is still 0 then, so is the difference.
    """
    if not (math.isfinite(half) and half > 0):
        return usual
    return min(max(0, 1 - math.floor(math.log10(half))), usual + MORE_DIGITS)


def plus_minus(entry: Summary, digits: int) -> str:
    """Mean ± 1.96 SEM; the mean alone where the SEM is undefined."""
    mean = number(entry.mean, digits)
    return mean if math.isnan(entry.sem) else f"{mean} ± {number(NORMAL_95 * entry.sem, digits)}"


def in_minutes(run: RunInfo, metric: Description, entry: Summary) -> str:
    """A mean time in minutes; nothing for what is no time, or undefined."""
    timed = metric.key in OVER_T or metric.unit == "steps"
    if not timed or math.isnan(entry.mean):
        return ""
    steps = entry.mean * (run.horizon if metric.key in OVER_T else 1)
    return f"{number(minutes(run, steps), 1)} min"


def minutes(run: RunInfo, steps: float) -> float:
    """What so many steps of a run take."""
    return steps * run.period_s / 60


def in_full(entry: Summary) -> Number:
    """Mean and the ends of ± 1.96 SEM, unrounded."""
    half = NORMAL_95 * entry.sem
    return Number(entry.mean, entry.mean - half, entry.mean + half)


def policy_name(policy: str, bounds: Collection[str]) -> str:
    """Policy, marked where it is one of those that are shown the truth: bounds, as the run says."""
    return f"{policy} (bound)" if policy in bounds else policy


def row_name(series: Series, worlds: Sequence[str], bounds: Collection[str]) -> str:
    """Policy, with its world where there are several."""
    name = policy_name(series[1], bounds)
    return name if len(worlds) == 1 else f"{name} · {series[0]}"


def head_of(logs: RunLogs, series: Series) -> str:
    """`row_name` of a world and policy of a run."""
    return row_name(series, logs.run.worlds, logs.run.bounds)


def entry_of(summary: Summaries, series: Series, key: str) -> Summary:
    """Summary of one metric; all undefined with n = 0 where the run has none."""
    missing = Summary(math.nan, math.nan, math.nan, math.nan, math.nan, 0)
    return summary[series[0]][series[1]].get(key, missing)


def _paper_rows(known: Published, metrics: Sequence[Description], map_: str) -> list[Row]:
    """What the paper prints, and what its public code gives over many seeds."""
    sources = [(f"{known.algorithm}, paper{map_}", known.printed, known.interval)]
    if known.pooled:
        sources.append((known.pooled.what.format(map_), known.pooled.mean, known.pooled.interval))
    rows = []
    for head, mean, half in sources:
        cells, values = [], []
        for metric in metrics:
            value, width = mean.get(metric.key, math.nan), half.get(metric.key, math.nan)
            text = number(value, metric.digits)
            if metric.key in half:
                text += f" ± {number(width, metric.digits)}"
            cells.append(text)
            values.append(Number(value, value - width, value + width))
        if any(cell != NOTHING for cell in cells):
            rows.append(Row(head, tuple(cells), paper=True, values=tuple(values)))
    return rows


def _by_policy(logs: RunLogs) -> list[Series]:
    """Worlds of one policy next to one another."""
    return [(world, policy) for policy in logs.policies for world in logs.run.worlds]


def metric_table(
    logs: RunLogs,
    name: str,
    title: str,
    keys: Sequence[str],
    *,
    paper: bool = True,
    notes: Sequence[str] = (),
) -> Table:
    """Policies down, metrics across; the paper's figures under the policies that it has."""
    metrics = [describe(key) for key in keys]
    looks, several = style.policy_styles(logs.policies), _by_policy(logs)
    winners = [best_of(logs, metric) for metric in metrics]
    rows: list[Row] = []
    for place, series in enumerate(several):
        entries = [entry_of(logs.summary, series, m.key) for m in metrics]
        cells = tuple(map(plus_minus, entries, (m.digits for m in metrics)))
        values = tuple(map(in_full, entries))
        best = frozenset(i for i, winner in enumerate(winners) if series in winner)
        colour = looks[series[1]].colour
        also = [in_minutes(logs.run, m, one) for one, m in zip(entries, metrics, strict=True)]
        row = Row(head_of(logs, series), cells, colour, best=best, values=values)
        rows.append(replace(row, also=tuple(also)))
        last = place + 1 == len(several) or several[place + 1][1] != series[1]
        known = published_for(logs.run, series[1]) if paper and last else None
        if known:
            rows += _paper_rows(known, metrics, elsewhere(logs.run))
    straight = any(row.paper and row.head.startswith(STRAIGHT) for row in rows)
    return Table(
        name,
        title,
        tuple(metric.label for metric in metrics),
        tuple(rows),
        (*notes, *([STRAIGHT_NOTE] if straight else ())),
        tuple(metric.unit for metric in metrics),
        better=tuple(metric.better for metric in metrics),
    )


def headline_table(logs: RunLogs) -> Table:
    """Return the few numbers that a reader wants first."""
    note = (
        "Mean ± 1.96 SEM over the episodes where the metric is defined; "
        f"{NOTE}. NT_50 and NT_90 are shares of the horizon, "
        f"{number(minutes(logs.run, logs.run.horizon), 0)} min; a share that is never removed "
        "counts as the whole of it."
    )
    return metric_table(logs, "headline", "Result in brief", HEADLINE, paper=False, notes=[note])


def paper_tables(logs: RunLogs) -> list[Table]:
    """Return the paper's Tables 2, 3 and 4 (its CSR column) with our numbers."""
    columns = "RMSE_columns is the number that the paper printed; RMSE follows its equation."
    bold = f"{NOTE[0].upper()}{NOTE[1:]}."
    return [
        metric_table(
            logs,
            "table-2",
            "PTA and RMSE at the end (paper's Table 2), mean ± 1.96 SEM",
            ("pta_d", "pta_c", "rmse", "rmse_columns"),
            notes=[columns, bold],
        ),
        metric_table(
            logs,
            "table-3",
            "Time to remove 50 and 90 %, and throughput (paper's Table 3), mean ± 1.96 SEM",
            ("nt50", "nt90", "throughput"),
            notes=[bold],
        ),
        metric_table(
            logs,
            "table-4",
            "Cooperative success ratio (paper's Table 4), mean ± 1.96 SEM",
            ("csr",),
            notes=[
                "The sensitivity slopes of this table come from `mjforage study corruption`.",
                bold,
            ],
        ),
    ]


def full_table(logs: RunLogs) -> Table:
    """Every metric: mean, 1.96 SEM, bootstrap 95 % interval, IQM and n; dashes without it.

    Those of a link, and others that no episode of the run defines, are only named.
    """
    looks = style.policy_styles(logs.policies)
    rows, nowhere = [], []
    for metric in logs.metrics.values():
        if logs.has(metric.key) and not logs.defined(metric.key):
            nowhere.append(metric.label)
            continue
        for series in _by_policy(logs):
            entry = entry_of(logs.summary, series, metric.key)
            cells = full_cells(entry, metric.digits)
            row = Row(head_of(logs, series), cells, looks[series[1]].colour)
            group, values = metric.head, full_values(entry)
            row = replace(row, group=group, note=metric.definition, values=values)
            rows.append(replace(row, group_better=metric.better))
    columns = ("mean", "1.96 SEM", "95 % interval", "IQM", "n")
    notes = (
        "Interval: bootstrap of the mean over episodes. IQM: mean of the middle half. n: episodes "
        "where the metric is defined; the others are left out.",
        *([f"Undefined in every episode: {', '.join(nowhere)}."] if nowhere else []),
    )
    return Table("metrics", "All metrics", columns, tuple(rows), notes)


def full_cells(entry: Summary, digits: int) -> tuple[str, ...]:
    """Cells of `full_table` for one entry."""
    interval = NOTHING
    if not math.isnan(entry.low):
        interval = f"{number(entry.low, digits)} to {number(entry.high, digits)}"
    return (
        number(entry.mean, digits),
        number(NORMAL_95 * entry.sem, digits),
        interval,
        number(entry.iqm, digits),
        str(entry.n),
    )


def full_values(entry: Summary) -> tuple[Number, ...]:
    """The numbers of `full_cells`."""
    interval = Number(math.nan, entry.low, entry.high)
    half = Number(NORMAL_95 * entry.sem)
    return (Number(entry.mean), half, interval, Number(entry.iqm), Number(entry.n))


def terminal_table(summary: Mapping[str, Any], bounds: Collection[str] = ()) -> RichTable:
    """Headline numbers of a `summary.json` for the terminal, mean and 1.96 SEM below it.

    Parameters
    ----------
    summary
        {world: {policy: {metric: {"mean", "sem", "ci95", "iqm", "n"}}}}

    Raises
    ------
    UserError
        If an entry lacks a key or holds something that is not a number.
    """
    parsed = parse_summary(summary)
    series = [(world, policy) for world in parsed for policy in style.ordered(parsed[world])]

    def defined(key: str) -> bool:
        return any(entry_of(parsed, one, key).n for one in series)

    over_link = defined("handover")
    keys = filter(defined, LINKED) if over_link else TERMINAL
    metrics = [describe(key) for key in keys]
    table = RichTable(
        title="mean ± 1.96 SEM",
        title_justify="left",
        title_style="dim",
        box=None,
        padding=(0, 1, 0, 0),
    )
    table.add_column("policy", no_wrap=True)
    for metric in metrics:
        # Longer units would not fit 80 columns; the report has them.
        unit = f"\n[{metric.unit}]" if 0 < len(metric.unit) <= len("steps") else "\n"
        table.add_column(Text(metric.plain + unit), justify="right", no_wrap=True)
    for world, policy in series:
        cells = [
            plus_minus(entry_of(parsed, (world, policy), m.key), m.digits).replace(" ± ", "\n± ")
            for m in metrics
        ]
        name = row_name((world, policy), list(parsed), bounds).replace(" (bound)", "\n(bound)")
        head = Text(name, style=style.policy_colour(policy))
        table.add_row(head, *(Text(cell) for cell in cells))
    return table
