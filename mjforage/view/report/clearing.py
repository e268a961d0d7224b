"""The table of the question itself: how long it takes to clean up."""

import math
from collections.abc import Iterator

import polars as pl

from mjforage.metrics import Interval, clearing_time, median_time, never_share
from mjforage.view.page.table import Number, Table
from mjforage.view.report.cells import Cell, minutes, number, row, span
from mjforage.view.report.run_logs import Case, RunLogs

SHARES = (0.5, 0.9, 0.99)
NEVER = "never"
NOTE = (
    "Minutes until that share of an episode's items is collected: median of the episodes and its "
    "95 % interval, between two of them. Never: share of the episodes that end before."
)


def clearing(case: Case) -> list[tuple[float, Interval, Interval]]:
    """Of every share: the share, the median time [min] and the share of episodes without one."""
    items = case.items(("t_collected",)).with_columns(
        pl.col("t_collected").cast(pl.Float64).fill_null(math.inf)
    )
    each = [one["t_collected"].to_numpy() for one in items.partition_by("episode")]
    step_min = minutes(case.logs.run, 1)
    times = [(share, [clearing_time(one, share) * step_min for one in each]) for share in SHARES]
    return [(share, median_time(found), never_share(found)) for share, found in times]


def clearing_frame(logs: RunLogs) -> pl.DataFrame:
    """A row per world, policy and share, see `Run.clearing`."""
    return pl.DataFrame(
        [
            {"world": case.world, "policy": case.policy, "share": share}
            | dict(zip(("median_min", "low_min", "high_min", "n"), map(float, time), strict=True))
            | {"never": float(lost.value), "never_low": float(lost.low)}
            | {"never_high": float(lost.high)}
            for case in logs.cases
            for share, time, lost in clearing(case)
        ]
    ).with_columns(pl.col("n").cast(pl.Int64))


def clearing_table(*runs: RunLogs) -> Table:
    """Policies of one run or of several down, shares across."""
    named = len(runs) > 1
    rows = [
        row(f"{logs.folder.name}: {case.head}" if named else case.head, _cells(case), colour)
        for logs in runs
        for case in logs.by_policy
        for colour in (case.look.colour,)
    ]
    columns = [(f"{share:.0%} after".replace("%", " %"), "never") for share in SHARES]
    names = tuple(name for pair in columns for name in pair)
    title = "Time to clean up"
    return Table("clearing", title, names, tuple(rows), (NOTE,), ("min", "%") * len(SHARES))


def _cells(case: Case) -> Iterator[Cell]:
    for _, time, never in clearing(case):
        value, low, high = map(float, time[:3])
        ends = f" ({_ends(low, high)})" if low == low else ""
        known = Number(*(one if math.isfinite(one) else math.nan for one in (value, low, high)))
        yield Cell(f"{_time(value)}{ends}", known)
        value, low, high = (100.0 * float(one) for one in never[:3])
        ends = f" ({span(low, high, 0)})" if low == low else ""
        yield Cell(f"{number(value, 0)}{ends}", Number(value, low, high))


def _ends(low: float, high: float) -> str:
    return NEVER if math.isinf(low) else f"{_time(low)} to {_time(high)}"


def _time(value: float) -> str:
    return NEVER if math.isinf(value) else number(value, 1)
