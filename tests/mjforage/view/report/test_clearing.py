"""Horizon that would have cleared the map: closed forms, and the table of the page."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from mjforage.view.report.clearing import UNKNOWN, about, clearing_step, clearing_table
from mjforage.view.report.run_logs import load_logs

pytestmark = pytest.mark.usefixtures("unprinted")
NEVER = math.inf
MakeRun = Callable[..., Path]


def step(removed: Sequence[float], horizon: int = 100) -> float:
    return clearing_step(np.array(removed), horizon)


def test_a_cleared_episode_took_until_its_last_removal() -> None:
    assert step([3.0, 80.0, 12.0]) == 80.0


def test_one_item_left_has_an_even_chance_after_the_half_life_of_the_last_quarter() -> None:
    """One removed half way through the last quarter, one left: 1 in 12.5 + 25 item steps."""
    assert step([10.0, 87.5, NEVER]) == pytest.approx(100 + math.log(2) * 37.5)


def test_of_several_items_left_the_last_one_counts() -> None:
    """Chance that both are gone: (1 - exp(-t/62.5))^2 = 1/2."""
    expected = 100 - 62.5 * math.log(1 - math.sqrt(0.5))
    assert step([87.5, NEVER, NEVER]) == pytest.approx(expected)


def test_what_stood_still_in_the_last_quarter_tells_no_horizon() -> None:
    assert step([10.0, 75.0, NEVER]) == NEVER
    assert step([10.0, 75.5, NEVER]) < NEVER, "what was removed in it does"


@pytest.mark.parametrize(
    ("steps", "shown"), [(8.2, 9), (99.5, 100), (100.6, 110), (457.9, 460), (1234.0, 1300)]
)
def test_an_estimate_has_two_digits_and_is_never_too_short(steps: float, shown: int) -> None:
    assert about(steps) == shown


def test_the_table_counts_episodes_and_tells_times_in_minutes(make_run: MakeRun) -> None:
    """Over 12 steps of 10 s: greedy clears the map in 12 and in 6 steps, 1.5 minutes on average.

    In two other episodes two items stay and one; levy leaves all four times three.
    """
    folder = make_run(policies=("greedy", "levy"), episodes=4, items=3)
    path = folder / "items.parquet"
    taken = [3, 6, 12, 6, 3, 3, None, None, 2, None, 1, 2, *[None] * 12]
    items = pl.read_parquet(path).sort("policy", "episode", "item")
    items.with_columns(t_collected=pl.Series(taken, dtype=pl.Int64)).write_parquet(path)
    table = clearing_table(load_logs(folder))
    assert table is not None and table.better[:3] == (1, -1, -1)
    greedy, levy = table.rows
    assert greedy.cells == ("2 of 4", "1.5", "1.5", "2 of 2", UNKNOWN)
    assert levy.cells == ("0 of 4", "–", "3.0", "4 of 4", UNKNOWN)
