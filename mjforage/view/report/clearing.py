"""Clearing of the map: how often, how soon, and the horizon that would be enough."""

import math

import numpy as np
import polars as pl

from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.cells import UNDEFINED, Cell, minutes, number, number_cell, row
from mjforage.view.report.run_logs import Case, FloatArray, RunLogs

LAST = 4  # an episode's pace is that of its last quarter
UNKNOWN = "cannot be told"

TITLE = "Cleared maps and sufficient horizons"
COLUMNS = ("cleared", "mean time", "items left", "stalled", "sufficient horizon")
NOTE = (
    "Mean time: of the episodes that were cleared. The other columns are of the episodes that were "
    "not. Items left: mean. Stalled: episodes in whose last quarter no item was removed. "
    "Sufficient horizon: half of these episodes would be cleared by then, if each remaining item "
    "were removed with the probability per step that items had in the last quarter of its episode. "
    "A stalled episode counts as never cleared; where more than half are stalled, no horizon can "
    "be given. A policy that keeps slowing down needs more."
)


def clearing_step(removed: FloatArray, horizon: int) -> float:
    """Step by which an episode is as likely as not to be cleared, at the pace of its last quarter.

    Each item left is taken to be removed with a chance per step that is the number removed in that
    quarter over the steps that items waited in it (the maximum likelihood of a constant hazard).

    Parameters
    ----------
    removed : (item,) step at which each was removed, infinite if it was not

    Returns
    -------
    float
        The last removal if it was cleared; infinite if nothing was removed in the last quarter.
    """
    left = int(np.isinf(removed).sum())
    if not left:
        return float(removed.max(initial=0.0))
    start = horizon - horizon / LAST
    lately = int(np.isfinite(removed[removed > start]).sum())
    if not lately:
        return math.inf
    waited = float(np.clip(np.minimum(removed, horizon) - start, 0.0, None).sum())
    return horizon - math.log1p(-(0.5 ** (1 / left))) * waited / lately


def about(steps: float) -> int:
    """Steps rounded up to two digits: no more is known of them."""
    unit = int(10 ** max(0, len(str(math.ceil(steps))) - 2))
    return math.ceil(steps / unit) * unit


def _episodes(case: Case) -> list[FloatArray]:
    """Step of each item's removal, infinite for never, episode by episode."""
    rows = case.items().sort("episode", maintain_order=True)
    times = rows["t_collected"].cast(pl.Float64).fill_null(math.inf).to_numpy()
    first = np.searchsorted(rows["episode"].to_numpy(), np.arange(1, case.logs.run.episodes))
    return np.split(times, first)


def _row(case: Case) -> Row:
    run, episodes = case.logs.run, _episodes(case)
    steps = np.array([clearing_step(removed, run.horizon) for removed in episodes])
    left = np.array([np.isinf(removed).sum() for removed in episodes])
    others, cleared = np.sort(steps[left > 0]), int((left == 0).sum())
    took = minutes(run, float(steps[left == 0].mean())) if cleared else math.nan
    counted = Cell(f"{cleared} of {len(steps)}", Number(cleared))
    if not others.size:
        cells = [counted, number_cell(took, 1), UNDEFINED, UNDEFINED, Cell(NOTHING)]
        return row(case.head, cells, case.look.colour)
    enough, stalled = float(others[(others.size - 1) // 2]), int(np.isinf(others).sum())
    horizon = Cell(UNKNOWN)
    if math.isfinite(enough):
        also = f"{number(minutes(run, about(enough)), 0)} min"
        horizon = Cell(f"≈ {about(enough)}", Number(enough), also)
    cells = [
        counted,
        number_cell(took, 1),
        number_cell(float(left[left > 0].mean()), 1),
        Cell(f"{stalled} of {others.size}", Number(stalled)),
        horizon,
    ]
    return row(case.head, cells, case.look.colour)


def clearing_table(logs: RunLogs) -> Table | None:
    """A row per policy and world; None where every episode was cleared."""
    if not any(case.items()["t_collected"].null_count() for case in logs.cases):
        return None
    rows = tuple(map(_row, logs.by_policy))
    units = ("episodes", "min", "items", "episodes", "steps")
    return Table("clearing", TITLE, COLUMNS, rows, (NOTE,), units, better=(1, -1, -1, -1, -1))
