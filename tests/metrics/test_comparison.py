"""Paired difference and probability of improvement against hand-made pairs and scipy."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from metrics import paired_difference, probability_of_improvement

NAN = np.nan
SMALL = st.lists(st.integers(-3, 3), min_size=1, max_size=9)


def test_paired_difference_by_hand() -> None:
    # Pairs (3, 1), (5, 2): (2 + 3) / 2 = 2.5; the others lack a side.
    gap = paired_difference([3.0, 5.0, NAN, 9.0], [1.0, 2.0, 4.0, NAN], seed=0)
    np.testing.assert_array_equal([gap.value, gap.n], [2.5, 2])
    np.testing.assert_array_equal([gap.low, gap.high], [2.0, 3.0])


def test_pairing_removes_what_episodes_share() -> None:
    rng = np.random.default_rng(0)
    luck = rng.normal(scale=30.0, size=100)
    x = luck + 1.0 + rng.normal(size=100)
    y = luck + rng.normal(size=100)
    gap = paired_difference(x, y, seed=1)
    assert 0.0 < gap.low < 1.0 < gap.high
    turned = paired_difference(y, x, seed=1)
    np.testing.assert_allclose([turned.low, turned.high], [-gap.high, -gap.low])


def test_paired_difference_agrees_with_scipy() -> None:
    rng = np.random.default_rng(5)
    x, y = rng.gamma(2.0, size=(2, 60))
    ours = paired_difference(x, y, seed=1, resamples=20_000)
    theirs = stats.bootstrap(
        (x, y),
        lambda a, b, axis: np.mean(a - b, axis=axis),
        paired=True,
        n_resamples=20_000,
        method="percentile",
        rng=np.random.default_rng(2),
    )
    tolerance = 0.06 * float(theirs.standard_error)
    np.testing.assert_allclose(ours.low, theirs.confidence_interval.low, atol=tolerance)
    np.testing.assert_allclose(ours.high, theirs.confidence_interval.high, atol=tolerance)


def test_improvement_by_hand() -> None:
    # X = 1, 3 against Y = 1, 2: (1, 1) ties, (1, 2) loses, (3, 1) and (3, 2) win:
    # (0.5 + 0 + 1 + 1) / 4 = 0.625.
    better = probability_of_improvement([1.0, 3.0, NAN], [1.0, 2.0], seed=0)
    assert better.value == 0.625
    np.testing.assert_array_equal([better.n_x, better.n_y], 2)


def test_improvement_with_nothing_to_compare() -> None:
    better = probability_of_improvement([[NAN, NAN], [1.0, NAN]], [[1.0], [2.0]], seed=0)
    np.testing.assert_array_equal(better.value, [NAN, 0.0])
    np.testing.assert_array_equal(better.low, [NAN, NAN])


@given(SMALL, SMALL)
def test_improvement_is_the_share_of_pairs(x: list[int], y: list[int]) -> None:
    value = probability_of_improvement(x, y, seed=0, resamples=5).value
    u = stats.mannwhitneyu(x, y, method="asymptotic").statistic
    np.testing.assert_allclose(value, u / (len(x) * len(y)))
    turned = probability_of_improvement(y, x, seed=0, resamples=5).value
    np.testing.assert_allclose(value + turned, 1.0)
    stretched = probability_of_improvement(np.exp(x), np.exp(y), seed=0, resamples=5).value
    assert stretched == value


def test_improvement_interval_agrees_with_scipy() -> None:
    rng = np.random.default_rng(3)
    # In order and of one length, so that drawing both sides alike would show.
    x, y = np.sort(rng.integers(0, 12, 40) + 2.0), np.sort(rng.integers(0, 12, 40) + 0.0)

    def share(a: Any, b: Any, axis: int = -1) -> Any:
        return (np.sign(a[..., :, None] - b[..., None, :]) / 2 + 0.5).mean(axis=(-1, -2))

    ours = probability_of_improvement(x, y, seed=4, resamples=10_000)
    theirs = stats.bootstrap(
        (x, y),
        share,
        n_resamples=10_000,
        batch=500,
        method="percentile",
        rng=np.random.default_rng(2),
    )
    np.testing.assert_allclose(ours.value, share(x, y))
    tolerance = 0.08 * float(theirs.standard_error)
    np.testing.assert_allclose(ours.low, theirs.confidence_interval.low, atol=tolerance)
    np.testing.assert_allclose(ours.high, theirs.confidence_interval.high, atol=tolerance)


def test_rows_do_not_influence_each_other() -> None:
    x, y = np.random.default_rng(0).normal(size=(2, 3, 20))
    better, gap = probability_of_improvement(x, y, seed=7), paired_difference(x, y, seed=7)
    for row in range(3):
        alone = probability_of_improvement(x[row], y[row], seed=7)
        assert (alone.low, alone.high) == (better.low[row], better.high[row])
        assert paired_difference(x[row], y[row], seed=7).low == gap.low[row]


def test_rejects() -> None:
    with pytest.raises(ValueError, match="x has shape"):
        paired_difference([1.0, 2.0], [1.0], seed=0)
    with pytest.raises(ValueError, match="leading axes"):
        probability_of_improvement(np.zeros((2, 3)), np.zeros((3, 3)), seed=0)
    with pytest.raises(ValueError, match="resamples 0"):
        probability_of_improvement([1.0, 2.0], [1.0, 2.0], seed=0, resamples=0)
    with pytest.raises(ValueError, match="level 2"):
        probability_of_improvement([1.0, 2.0], [1.0, 2.0], seed=0, level=2.0)
