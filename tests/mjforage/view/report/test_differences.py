"""Intervals of a few episodes are too narrow: they must not be shown as findings."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mjforage.core.mission_metrics import describe
from mjforage.view.report.differences import (
    LEVEL,
    Difference,
    corrected,
    family_note,
    p_text,
    set_apart,
)
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.report_page import render
from mjforage.view.report.run_logs import load_logs
from mjforage.view.report.text_tables import full_table, headline_table, paper_tables

NOTE = "Intervals from fewer than 10 episodes are too narrow; none is bold."


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


def test_what_is_undefined_is_no_test() -> None:
    nothing = Difference(np.full(20, np.nan), np.zeros(20), describe("csr"))
    clear = Difference(np.linspace(5.0, 6.9, 20), np.zeros(20), describe("pta_c"))
    assert set_apart([nothing, clear]) == [False, True]
    assert corrected([nothing, clear])[1] == clear.p
    assert "for the 1 test of this table" in family_note([nothing, clear])
    assert p_text(np.nan) == "–"


@pytest.mark.parametrize(("episodes", "few"), [(3, True), (12, False)])
def test_a_page_of_few_episodes_says_so_and_has_no_bold_interval(
    make_run: Callable[..., Path], episodes: int, few: bool
) -> None:
    logs = load_logs(make_run(episodes=episodes))
    table = comparison_table(logs)
    assert table is not None
    page = render(logs, (), headline_table(logs), paper_tables(logs), full_table(logs), table)
    assert (page.count(NOTE) == 1) is few
    assert any(row.best for row in table.rows) is not few
