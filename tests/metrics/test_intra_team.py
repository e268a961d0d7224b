"""Intra-team metrics against hand-made cases, plain oracles and their general properties."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.metrics import (
    EventTable,
    contributions,
    coverage_overlap,
    gini,
    marginal_contribution,
    team_gini_series,
)

NAN = np.nan
SEEDS = st.integers(0, 10_000)
Build = Callable[..., EventTable]
SHARES = st.lists(st.floats(1e-3, 1e3), min_size=1, max_size=8)


def test_gini_by_hand() -> None:
    # (1, 3): both ordered pairs differ by 2, 4 / (2 x 4 x 2) = 0.25.
    # (0, 0, 6): four ordered pairs differ by 6, 24 / (2 x 9 x 2) = 2/3 = (n - 1) / n.
    assert gini([1.0, 3.0]) == 0.25
    np.testing.assert_allclose(gini([0.0, 0.0, 6.0]), 2 / 3)
    np.testing.assert_array_equal(gini([[5, 5], [0, 0], [0, 4]]), [0.0, NAN, 0.5])
    assert np.isnan(gini([]))


@pytest.mark.parametrize("share", [-1.0, NAN, np.inf])
def test_gini_rejects(share: float) -> None:
    with pytest.raises(ValueError, match=r"contribution\[1\]"):
        gini([1.0, share])


@given(SHARES, st.floats(1e-3, 1e3), st.randoms())
def test_gini_is_the_double_sum_free_of_scale_and_order(
    shares: list[float], factor: float, random: Any
) -> None:
    c = np.array(shares)
    double_sum = np.abs(c[:, None] - c).sum() / (2 * c.size**2 * c.mean())
    value = gini(c)
    np.testing.assert_allclose(value, double_sum, atol=1e-12)
    assert 0.0 <= value <= (c.size - 1) / c.size + 1e-12
    np.testing.assert_allclose(gini(c * factor), value, atol=1e-12)
    random.shuffle(shares)
    np.testing.assert_array_equal(gini(shares), value)
    np.testing.assert_allclose(gini(np.tile(c, 3)), value, atol=1e-12)


def test_team_gini_by_hand() -> None:
    # Agents 2 and 3 collect 3 and 1 of five items: (2 + 2) / (2 x 4 x 2) = 0.25.
    by = np.array([2, 3, 2, 2, -1])
    times = np.array([1.0, 3.0, 3.0, 4.0, NAN])
    np.testing.assert_array_equal(contributions(by, [3, 2]), [1, 3])
    # t = 0 nothing; 1 and 2: (1, 0) -> 1/2; 3: (2, 1) -> 2 / (2 x 4 x 1.5) = 1/6; 4: 1/4.
    series = team_gini_series(times, by, [2, 3], 4)
    np.testing.assert_allclose(series, [NAN, 1 / 2, 1 / 2, 1 / 6, 1 / 4])


def test_gini_of_nobody_is_undefined() -> None:
    by = np.array([[0, 1], [-1, -1]])
    assert contributions(by, []).shape == (2, 0)
    assert np.isnan(team_gini_series(np.ones((2, 2)), by, [], 3)).all()


@pytest.mark.parametrize(
    ("times", "agents", "horizon", "message"),
    [
        (np.ones(3), [0], 4, "times has shape"),
        (np.ones(2), [0, 0], 4, "listed twice"),
        (np.ones(2), [-1], 4, "negative"),
        (np.ones(2), [0], 0, "horizon 0"),
    ],
)
def test_team_gini_rejects(times: Any, agents: list[int], horizon: int, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        team_gini_series(times, np.array([0, 1]), agents, horizon)


def test_coverage_overlap_by_hand() -> None:
    # Four nodes are seen, two of them by two or more: 2 / 4. Nothing seen: undefined.
    seen = np.array([[0, 1, 2, 3, 1], [0, 0, 0, 0, 0], [1, 1, 0, 0, 0]])
    np.testing.assert_array_equal(coverage_overlap(seen), [0.5, NAN, 0.0])
    assert coverage_overlap(seen[0]) == 0.5


@pytest.mark.parametrize("seen", [np.array([0.5, 1.0]), np.int64(1), np.array([True, False])])
def test_coverage_overlap_rejects_what_is_no_count(seen: Any) -> None:
    with pytest.raises(ValueError, match="integers"):
        coverage_overlap(seen)


def test_coverage_overlap_rejects_negative_counts() -> None:
    with pytest.raises(ValueError, match=r"times_seen\[1, 0\] is -2"):
        coverage_overlap(np.array([[0, 1], [-2, 1], [1, 1]]))


def test_marginal_contribution_is_the_papers_table() -> None:
    # Greedy with one scout less: PTA_D 98.85 -> 88.08, PTA_C 98.20 -> 82.26 and RMSE
    # .0017 -> .0130 give .1090, .1623 and .8692 (the table of the role-based contributions).
    found = marginal_contribution(98.85, 88.08, higher_is_better=True)
    taken = marginal_contribution(98.20, 82.26, higher_is_better=True)
    error = marginal_contribution(0.0017, 0.0130, higher_is_better=False)
    np.testing.assert_allclose([found, taken, error], [0.1090, 0.1623, 0.8692], atol=5e-5)


def test_marginal_contribution_undefined_and_negative() -> None:
    values = marginal_contribution([0.0, 50.0], [10.0, 60.0], higher_is_better=True)
    np.testing.assert_allclose(values, [NAN, -0.2])  # (50 - 60) / 50
    assert np.isnan(marginal_contribution(1.0, 0.0, higher_is_better=False))


def test_marginal_contribution_rejects_shapes() -> None:
    with pytest.raises(ValueError, match="shape"):
        marginal_contribution([1.0, 2.0], [1.0, 2.0, 3.0], higher_is_better=True)
