"""Descriptive statistics against hand-made samples and scipy."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mjforage.metrics import count, half_width_95, iqm, mean, sem, stratified_sem

NAN = np.nan
SAMPLES = st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=40)
ALL = [count, mean, sem, half_width_95, iqm]


def test_by_hand() -> None:
    # 1, 2, 3, 10 and one undefined: mean 4, s^2 = (9 + 4 + 1 + 36) / 3 = 50 / 3,
    # SEM = sqrt(50 / 12); IQM without one value at each end (2 + 3) / 2.
    values = [10.0, NAN, 1.0, 3.0, 2.0]
    assert count(values) == 4
    assert mean(values) == 4.0
    np.testing.assert_allclose(sem(values), np.sqrt(50 / 12))
    np.testing.assert_allclose(half_width_95(values), 1.96 * np.sqrt(50 / 12))
    assert iqm(values) == 2.5


def test_strata_by_hand() -> None:
    # 1, 3 and one undefined: SEM 1; 10, 10, 16: SEM 2; an empty one: sqrt((2/5)^2 + (3/5 2)^2).
    strata = [[1.0, NAN, 3.0], [10.0, 10.0, 16.0], [NAN]]
    np.testing.assert_allclose(stratified_sem(strata), np.sqrt(0.4**2 + 1.2**2))
    np.testing.assert_allclose(stratified_sem([[1.0, 3.0]]), 1.0)
    assert np.isnan(stratified_sem([[NAN], []]))
    assert np.isnan(stratified_sem([[1.0, 3.0], [2.0]]))
    assert np.isnan(stratified_sem([]))


def test_too_few_values() -> None:
    values = np.array([[NAN, NAN], [7.0, NAN]])
    np.testing.assert_array_equal(count(values), [0, 1])
    np.testing.assert_array_equal(mean(values), [NAN, 7.0])
    np.testing.assert_array_equal(iqm(values), [NAN, 7.0])
    np.testing.assert_array_equal(sem(values), [NAN, NAN])
    assert np.isnan(mean([]))


@pytest.mark.parametrize("statistic", ALL)
@pytest.mark.parametrize("bad", [np.array([1.0, np.inf]), np.float64(3.0)])
def test_rejects(statistic: Callable[[Any], Any], bad: Any) -> None:
    with pytest.raises(ValueError, match="values"):
        statistic(bad)


@given(SAMPLES)
def test_agree_with_scipy(sample: list[float]) -> None:
    np.testing.assert_allclose(sem(sample), stats.sem(sample), rtol=1e-9, atol=1e-9)
    trimmed = stats.trim_mean(sample, 0.25)
    np.testing.assert_allclose(iqm(sample), trimmed, rtol=1e-9, atol=1e-6)


@given(SAMPLES)
def test_bounds(sample: list[float]) -> None:
    for centre in (mean(sample), iqm(sample)):
        assert min(sample) - 1e-6 <= centre <= max(sample) + 1e-6
