"""Cells of the report's tables: their text, number and marks."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from mjforage.mission.scoring import Description
from mjforage.runs.run_info import RunInfo
from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.run_logs import Case

OVER_T = frozenset({"nt50", "nt90", "dsl", "itl", "itl_level", "handover"})
"""Metrics that are times as shares of the horizon."""
NORMAL_95 = 1.96  # the paper's, and of the bands of curves
FEW = 20  # episodes from which an interval of the mean covers
ROUGH = "rough"
INTERVAL = (
    "Mean and 95 % interval, ± half of it or its ends (`metrics.mean_interval`); rough: of fewer "
    f"than {FEW} episodes, or of a metric whose worst value is not known, it covers less often"
)
MORE_DIGITS = 2  # than a metric has, at most, where an interval is narrow


class Cell(NamedTuple):
    """One cell of a row."""

    text: str
    number: Number | None = None  # what it shows, unrounded; None for words
    also: str = ""  # small print below it
    best: bool = False  # bold


TOLD = "told of items"
"""Column of what policies know of the items before an episode."""


UNDEFINED = Cell(NOTHING, Number(math.nan))


def row(head: str, cells: Iterable[Cell], colour: str = "", **about: Any) -> Row:
    """A row of such cells; keywords are fields of `Row`."""
    cells = tuple(cells)
    return Row(
        head,
        tuple(cell.text for cell in cells),
        colour,
        best=frozenset(place for place, cell in enumerate(cells) if cell.best),
        values=tuple(cell.number for cell in cells),
        also=tuple(cell.also for cell in cells),
        **about,
    )


def metrics_table(
    name: str,
    title: str,
    metrics: Sequence[Description],
    rows: Iterable[Row],
    notes: Sequence[str],
    **about: Any,
) -> Table:
    """A table with a column per metric; keywords are fields of `Table`."""
    return Table(
        name,
        title,
        tuple(metric.label for metric in metrics),
        tuple(rows),
        tuple(notes),
        **{
            "units": tuple(metric.unit for metric in metrics),
            "better": tuple(metric.better for metric in metrics),
        }
        | about,
    )


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


def number_cell(
    value: float, digits: int, half: float = math.nan, also: str = "", best: bool = False
) -> Cell:
    """A number, ± half of its interval where that is known."""
    text = number(value, digits)
    if not math.isnan(half):
        text += f" ± {number(half, digits)}"
    return Cell(text, Number(value, value - half, value + half), also, best)


def mean_cell(one: Number, digits: int, rough: bool, also: str = "", best: bool = False) -> Cell:
    """A mean with its interval, ± half of it where it is as wide on both sides."""
    known = math.isfinite(one.value) and math.isfinite(one.low)
    around = spread(one, digits)
    text = f"{number(one.value, digits)} {around if around[0] == '±' else f'({around})'}"
    text += f" {ROUGH}" if rough else ""
    return Cell(text if known else number(one.value, digits), one, also, best)


def spread(one: Number, digits: int) -> str:
    """An interval: ± half of it where it is as wide on both sides, to its digits; else its ends."""
    below, above = (number(side, digits) for side in (one.value - one.low, one.high - one.value))
    return f"± {above}" if below == above else span(one.low, one.high, digits)


def is_rough(metric: Description, episodes: int) -> bool:
    """True if an interval of a mean of so many episodes does not cover what it says."""
    return episodes < FEW or not metric.bounded


def printed_row(head: str, numbers: Iterable[tuple[float | None, int]], **about: Any) -> Row:
    """A row of published numbers, each with its digits, None where there is none."""
    pairs = ((math.nan if value is None else value, digits) for value, digits in numbers)
    return row(head, [number_cell(*pair) for pair in pairs], paper=True, **about)


def span(low: float, high: float, digits: int) -> str:
    """The ends of an interval."""
    return f"{number(low, digits)} to {number(high, digits)}"


def interval_cell(one: Number, digits: int) -> Cell:
    """A number with its interval in parentheses; a dash where undefined."""
    text = number(one.value, digits)
    known = not math.isnan(one.value) and not math.isnan(one.low)
    return Cell(f"{text} ({span(one.low, one.high, digits)})" if known else text, one)


def summary_cell(case: Case, metric: Description, best: bool = False) -> Cell:
    """Mean of a case with its interval, and a time in minutes below it."""
    entry = case.summary(metric.key)
    also = in_minutes(case.logs.run, metric, entry.mean)
    return mean_cell(entry.number, metric.digits, is_rough(metric, entry.n), also, best)


def in_minutes(run: RunInfo, metric: Description, mean: float) -> str:
    """A mean time in minutes; empty for other metrics, or if undefined."""
    timed = metric.key in OVER_T or metric.unit == "steps"
    if not timed or math.isnan(mean):
        return ""
    steps = mean * (run.horizon if metric.key in OVER_T else 1)
    return f"{number(minutes(run, steps), 1)} min"


def minutes(run: RunInfo, steps: float) -> float:
    """Duration of so many steps of a run [min]."""
    return steps * run.period_s / 60
