"""Intervals of bounded, skewed means: by hand, scipy as oracle, and how often they cover."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mjforage.metrics import mean_interval, worst_mean

NAN = np.nan


def test_without_ends_it_is_the_t_interval() -> None:
    sample = np.random.default_rng(0).gamma(2.0, size=(3, 12))
    found = mean_interval(sample)
    wanted = tuple(stats.ttest_1samp(sample, 0.0, axis=-1).confidence_interval(0.95))
    for end, by_scipy in zip((found.low, found.high), wanted, strict=True):
        np.testing.assert_allclose(end, np.asarray(by_scipy), rtol=1e-9)


def test_it_is_drawn_out_by_what_more_episodes_at_an_end_would_move_the_mean() -> None:
    """Of 80 and 100, ten times each: mean 90, t half width 2.093 * sqrt(100 / 19) = 4.80. One and a
    half more of 0 move a mean of 20 by 1.5 * 90 / 21 = 6.43, which makes 8.02 together; at the top
    the same of 100 move it by .71, which makes 4.85.
    """
    found = mean_interval(np.repeat([80.0, 100.0], 10), 0.0, 100.0)
    ends = [float(found.low), float(found.value), float(found.high)]
    assert ends == pytest.approx([81.98, 90.0, 94.85], abs=0.005)
    assert found.n == 20


def test_where_all_are_alike_a_rare_failure_may_go_unseen() -> None:
    """Rule of three: with 2.95 % of failures none is seen in 100 episodes once in 20."""
    found = mean_interval([100.0] * 100, 0.0, 100.0)
    assert float(found.low) == pytest.approx(97.05, abs=0.005)
    assert found.high == 100.0
    assert pytest.approx(0.05, abs=5e-4) == 0.9705**100


def test_values_at_both_ends_alone_have_the_exact_binomial_interval() -> None:
    for times, n in ((3, 20), (1, 9), (19, 20)):
        found = mean_interval([1.0] * times + [0.0] * (n - times), 0.0, 1.0)
        wanted = stats.binomtest(times, n).proportion_ci(0.95, "exact")
        assert (found.low, found.high) == pytest.approx((wanted.low, wanted.high))


def test_undefined_values_are_left_out_and_rows_do_not_know_each_other() -> None:
    values = np.array([[1.0, NAN, 3.0, 5.0], [NAN, NAN, 2.0, NAN], [NAN] * 4])
    found = mean_interval(values, 0.0, 10.0)
    alone = mean_interval([1.0, 3.0, 5.0], 0.0, 10.0)
    assert (found.low[0], found.high[0], found.n[0]) == (alone.low, alone.high, 3)
    np.testing.assert_array_equal(found.value, [3.0, 2.0, NAN])
    np.testing.assert_array_equal(found.low[1:], [NAN, NAN])
    np.testing.assert_array_equal(found.high[1:], [NAN, NAN])


def test_a_value_beyond_a_stated_end_is_the_end() -> None:
    assert mean_interval([1.0, 1.2], 0.0, 1.0).high == 1.2


@given(st.lists(st.floats(0, 1), min_size=2, max_size=12))
def test_it_holds_the_mean_and_stays_within_the_ends(sample: list[float]) -> None:
    found = mean_interval(sample, 0.0, 1.0)
    assert 0.0 <= found.low <= found.value + 1e-12
    assert found.value - 1e-12 <= found.high <= 1.0


@pytest.mark.parametrize("n", [20, 50, 100])
def test_it_covers_a_mean_with_rare_failures_where_a_t_interval_does_not(n: int) -> None:
    """98 in 100 episodes give 99 to 100, the others 0 to 80."""
    rng = np.random.default_rng(n)
    failed = rng.random((2000, n)) < 0.02
    values = np.where(failed, rng.uniform(0, 80, failed.shape), rng.uniform(99, 100, failed.shape))
    truth = 0.98 * 99.5 + 0.02 * 40.0

    def covered(least: float, most: float) -> float:
        found = mean_interval(values, least, most)
        return float(np.mean((found.low <= truth) & (truth <= found.high)))

    assert covered(0.0, 100.0) >= 0.93
    assert covered(-np.inf, np.inf) < 0.93


def test_the_worst_twentieth() -> None:
    """Of 0 to 99 the 5 lowest have the mean 2, the 5 highest 97; of few episodes the worst one."""
    assert worst_mean(np.arange(100.0), 1) == 2.0
    assert worst_mean(np.arange(100.0), -1) == 97.0
    np.testing.assert_array_equal(worst_mean([[3.0, 2.0, NAN], [NAN] * 3], 1), [2.0, NAN])
    assert np.isnan(worst_mean([1.0, 2.0], 0))


def test_rejects_infinite_values() -> None:
    with pytest.raises(ValueError, match="use NaN"):
        mean_interval([1.0, np.inf])
