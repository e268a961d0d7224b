"""Intervals of a few episodes are too narrow: they must not be shown as findings."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mjforage.core.vocabulary import describe
from mjforage.view.report import write_report
from mjforage.view.report.differences import Difference
from mjforage.view.report.policy_pairs import comparison_table
from mjforage.view.report.run_logs import load_logs

NOTE = "Intervals from fewer than 10 episodes are too narrow; none is bold."


@pytest.mark.parametrize(("defined", "apart"), [(9, False), (10, True)])
def test_fewer_than_ten_pairs_set_nothing_apart(defined: int, apart: bool) -> None:
    x = np.where(np.arange(20) < defined, 5.0 + 0.1 * np.arange(20), np.nan)
    found = Difference(x, np.zeros(20), describe("pta_c"))
    assert (found.n, found.low > 0, found.apart) == (defined, True, apart)


@pytest.mark.parametrize(("episodes", "few"), [(3, True), (12, False)])
def test_a_page_of_few_episodes_says_so_and_has_no_bold_interval(
    make_run: Callable[..., Path], episodes: int, few: bool
) -> None:
    folder = make_run(episodes=episodes)
    assert (write_report(folder).read_text(encoding="utf-8").count(NOTE) == 1) is few
    table = comparison_table(load_logs(folder))
    assert table is not None
    assert any(row.best for row in table.rows) is not few
