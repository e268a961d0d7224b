"""Differences and means as tables show them, and what is set apart."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mjforage.mission.scoring import Description, describe
from mjforage.view.page.table import Number
from mjforage.view.report import write_report
from mjforage.view.report.cells import is_rough, mean_cell
from mjforage.view.report.differences import Estimate, estimates, family_note, pairs
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.run_logs import load_logs

NOTE = "Differences of fewer than 10 episodes have no interval, and none is bold."


@pytest.mark.parametrize(("defined", "apart"), [(9, False), (10, True)])
def test_fewer_than_ten_pairs_set_nothing_apart(defined: int, apart: bool) -> None:
    gaps = np.where(np.arange(20) < defined, 5.0 + 0.1 * np.arange(20), np.nan)
    (found,) = estimates([(gaps, 2)])
    assert (found.n, found.apart) == (defined, apart)
    assert (found.cells[1].text == "–") is not apart
    assert found.cell().text.startswith("5.4")


def test_a_family_is_read_together() -> None:
    """One clear difference among many that are none stays; what one in twenty gives does not."""
    random = np.random.default_rng(3)
    noise = [(random.standard_normal(40), 2) for _ in range(60)]
    clear = (random.normal(3.0, 1.0, 40).astype(np.float64), 2)
    assert any(estimates([one])[0].apart for one in noise)
    found = estimates([*noise, clear])
    assert [one.apart for one in found] == [False] * 60 + [True]
    assert "hold for the 61 differences of this table together" in family_note(found)


def test_pairs_are_given_both_ways_round() -> None:
    values = {name: np.random.default_rng(seed).normal(seed, 1.0, 12) for seed, name in NAMED}
    found = pairs(values, 2)
    assert len(found) == 6
    there, back = found["a", "c"], found["c", "a"]
    assert there.value == pytest.approx(float(np.mean(values["a"] - values["c"])))
    assert (there.low, there.high, there.p) == (-back.high, -back.low, back.p)


NAMED = ((0, "a"), (1, "b"), (2, "c"))


@pytest.mark.usefixtures("unprinted")
@pytest.mark.parametrize(("episodes", "few"), [(3, True), (12, False)])
def test_a_page_of_few_episodes_says_so_and_has_no_bold_interval(
    make_run: Callable[..., Path], episodes: int, few: bool
) -> None:
    folder = make_run(episodes=episodes)
    table = comparison_table(load_logs(folder))
    assert (write_report(folder).read_text("utf-8").count(NOTE) == 1) is few
    assert any(row.best for row in table.rows) is not few


def found(low: float, value: float, high: float, p: float = 1e-6) -> Estimate:
    return Estimate(value, low, high, p, 20, describe("gini_foragers").digits)


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
    assert touching.cells[1].text.startswith("0.00 to")
    assert [one.apart for one in (clear, touching, below)] == [True, False, False]
    assert not found(0.01, 0.5, 1.0, p=0.06).apart


@pytest.mark.parametrize(
    ("low", "high", "rough", "cell"),
    [
        (88.0, 92.004, False, "90.00 ± 2.00"),
        (86.5, 91.0, False, "90.00 (86.50 to 91.00)"),
        (86.5, 91.0, True, "90.00 (86.50 to 91.00) rough"),
        (math.nan, math.nan, True, "90.00"),
    ],
)
def test_an_interval_is_written_low_to_high_where_its_sides_differ(
    low: float, high: float, rough: bool, cell: str
) -> None:
    assert mean_cell(Number(90.0, low, high), 2, rough).text == cell


def test_rough_are_few_episodes_and_metrics_whose_worst_value_is_not_stated() -> None:
    assert is_rough(describe("pta_c"), 19) and not is_rough(describe("pta_c"), 20)
    assert is_rough(describe("energy_per_item"), 1000)
    assert is_rough(Description("mine", "Mine"), 1000)
    assert not is_rough(Description("mine", "Mine", better=-1, most=9.0), 20)
    assert is_rough(Description("mine", "Mine", better=1, most=9.0), 20)
