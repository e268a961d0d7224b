"""How often a policy cleared the map, how long it took, and what horizon would have done."""

import math

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.view.page import style
from mjforage.view.page.table import NOTHING, Number, Row, Table
from mjforage.view.report.run_logs import RunLogs, Series
from mjforage.view.report.text_tables import head_of, minutes, number

LAST = 4  # an episode's pace is that of its last quarter
UNKNOWN = "cannot be told"

TITLE = "Was the map cleared, and what horizon would do?"
COLUMNS = ("cleared", "took", "left", "stood still", "horizon that would do")
NOTE = (
    "Took: mean of the episodes that were cleared. Of the others, left: items in the mean; stood "
    "still: episodes in whose last quarter nothing was removed. Horizon that would do: by then "
    "half of the others would be cleared, if each item left were removed with the chance per step "
    "that items had in the last quarter of its episode. One that stood still counts as never "
    "cleared; where more than half did, no horizon can be told. A policy that goes on slowing down "
    "needs more."
)


def clearing_step(removed: NDArray[np.float64], horizon: int) -> float:
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


def _episodes(logs: RunLogs, series: Series) -> list[NDArray[np.float64]]:
    """Step of each item's removal, infinite for never, episode by episode."""
    rows = logs.items_of(series).sort("episode", maintain_order=True)
    times = rows["t_collected"].cast(pl.Float64).fill_null(math.inf).to_numpy()
    first = np.searchsorted(rows["episode"].to_numpy(), np.arange(1, logs.run.episodes))
    return np.split(times, first)


def _row(logs: RunLogs, series: Series, colour: str) -> Row:
    episodes = _episodes(logs, series)
    steps = np.array([clearing_step(removed, logs.run.horizon) for removed in episodes])
    left = np.array([np.isinf(removed).sum() for removed in episodes])
    others = np.sort(steps[left > 0])
    took = minutes(logs.run, float(steps[left == 0].mean())) if (left == 0).any() else math.nan
    items = float(left[left > 0].mean()) if others.size else math.nan
    still = int(np.isinf(others).sum())
    would = float(others[(others.size - 1) // 2]) if others.size else math.nan
    told = math.isfinite(would)
    cells = (
        f"{len(steps) - others.size} of {len(steps)}",
        number(took, 1),
        number(items, 1),
        f"{still} of {others.size}" if others.size else NOTHING,
        f"≈ {about(would)}" if told else UNKNOWN if others.size else NOTHING,
    )
    values = (
        Number(len(steps) - others.size),
        Number(took),
        Number(items),
        Number(still if others.size else math.nan),
        Number(would) if told else None,
    )
    also = ("", "", "", "", f"{number(minutes(logs.run, about(would)), 0)} min" if told else "")
    return Row(head_of(logs, series), cells, colour, values=values, also=also)


def clearing_table(logs: RunLogs) -> Table | None:
    """A row per policy and world; None where every episode was cleared."""
    if not any(logs.items_of(one)["t_collected"].null_count() for one in logs.series):
        return None
    looks = style.policy_styles(logs.policies)
    rows = tuple(
        _row(logs, (world, policy), looks[policy].colour)
        for policy in logs.policies
        for world in logs.run.worlds
    )
    units = ("episodes", "min", "items", "episodes", "steps")
    return Table("clearing", TITLE, COLUMNS, rows, (NOTE,), units, better=(1, -1, -1, -1, -1))
