"""Intervals of a few episodes are too narrow: they must not be shown as findings."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mjforage.metrics import Interval
from mjforage.mission.scoring import describe
from mjforage.view.report import write_report
from mjforage.view.report.differences import (
    LEVEL,
    MANY,
    Difference,
    Estimate,
    family_note,
    set_apart,
)
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.run_logs import load_logs

NOTE = "Intervals from fewer than 10 episodes are too narrow: no difference is bold."


@pytest.mark.parametrize(("defined", "apart"), [(9, False), (10, True)])
def test_fewer_than_ten_pairs_set_nothing_apart(defined: int, apart: bool) -> None:
    x = np.where(np.arange(20) < defined, 5.0 + 0.1 * np.arange(20), np.nan)
    found = Difference(x, np.zeros(20), describe("pta_c"))
    assert (found.n, found.low > 0, set_apart([found])) == (defined, True, [apart])


def test_a_family_is_corrected_for_its_number() -> None:
    """One clear difference among many that are none stays; what one in twenty gives does not."""
    random = np.random.default_rng(3)
    metric = describe("pta_c")
    noise = [Difference(random.standard_normal(40), np.zeros(40), metric) for _ in range(60)]
    clear = Difference(random.normal(3.0, 1.0, 40).astype(np.float64), np.zeros(40), metric)
    alone = [one for one in noise if one.p < LEVEL]
    assert alone and not any(set_apart([*noise, clear])[:-1])
    assert set_apart([*noise, clear])[-1]
    assert "for the 61 tests of this table" in family_note([*noise, clear])


@pytest.mark.usefixtures("unprinted")
@pytest.mark.parametrize(("episodes", "few"), [(3, True), (12, False)])
def test_a_page_of_few_episodes_says_so_and_has_no_bold_interval(
    make_run: Callable[..., Path], episodes: int, few: bool
) -> None:
    folder = make_run(episodes=episodes)
    table = comparison_table(load_logs(folder))
    assert (write_report(folder).read_text("utf-8").count(NOTE) == 1) is few
    assert any(row.best for row in table.rows) is not few


def found(low: float, value: float, high: float, key: str = "gini_foragers") -> Estimate:
    interval = Interval(np.array(value), np.array(low), np.array(high), np.array(20))
    return Estimate(interval, 1e-6, describe(key).digits)


@pytest.mark.parametrize(
    ("low", "value", "high", "cell"),
    [
        (0.00021, 0.00213, 0.00412, "0.0021 (0.0002 to 0.0041)"),
        (-0.113, 0.02, 0.152, "0.02 (−0.11 to 0.15)"),
        (-1.0, 12.345, 25.0, "12 (−1 to 25)"),
        (0.5, 0.5, 0.5, "0.500 (0.500 to 0.500)"),
        (-1e-9, 0.0, 1e-9, "0.00000 (0.00000 to 0.00000)"),
        (math.nan, 0.5, math.nan, "0.500"),
    ],
)
def test_a_difference_has_the_digits_that_its_interval_needs(
    low: float, value: float, high: float, cell: str
) -> None:
    assert found(low, value, high).cell().text == cell


def test_nothing_is_set_apart_whose_printed_interval_reaches_zero() -> None:
    clear, touching, below = (found(low, 0.5, 1.0) for low in (0.01, 0.004, -0.1))
    assert touching.cells(0.5, best=False)[1].text.startswith("0.00 to")
    assert set_apart([clear, touching, below]) == [True, False, False]
    assert "where the interval leaves out 0" in family_note([clear])


def test_of_many_episodes_the_interval_is_196_sem() -> None:
    """500 differences of 1 or 3 in turn: mean 2, SEM 1 / sqrt(499)."""
    x = np.resize([4.0, 2.0], MANY)
    found = Difference(x, np.ones(MANY), describe("pta_c"))
    half = 1.96 / math.sqrt(MANY - 1)
    assert (found.value, found.low, found.high) == pytest.approx((2.0, 2 - half, 2 + half))
    assert found.normal and "± 1.96 SEM instead" in family_note([found])
