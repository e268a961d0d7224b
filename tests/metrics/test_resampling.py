"""Bootstrap intervals: scipy as oracle, coverage, strata, independence of rows."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mjforage.metrics import bootstrap, iqm, mean

NAN = np.nan
SAMPLE = np.random.default_rng(8).gamma(2.0, size=80)


def test_by_hand() -> None:
    # The mean of two draws from {0, 1} is 0, 1/2 or 1 with 1/4, 1/2, 1/4: the central half of
    # these is [1/4 quantile, 3/4 quantile] inside [0, 1], the central 95 % is all of it.
    interval = bootstrap([0.0, 1.0], seed=0)
    np.testing.assert_array_equal([interval.low, interval.value, interval.high], [0.0, 0.5, 1.0])
    narrow = bootstrap([0.0, 1.0], seed=0, level=0.4)  # quantiles 0.3 and 0.7
    np.testing.assert_array_equal([narrow.low, narrow.high], 0.5)


@pytest.mark.parametrize("statistic", [mean, iqm])
def test_agrees_with_scipy(statistic: Any) -> None:
    ours = bootstrap(SAMPLE, seed=1, statistic=statistic, resamples=20_000)
    theirs = stats.bootstrap(
        (SAMPLE,),
        lambda sample, axis: statistic(np.moveaxis(sample, axis, -1)),
        n_resamples=20_000,
        method="percentile",
        rng=np.random.default_rng(2),
    )
    ends = theirs.confidence_interval
    tolerance = 0.06 * float(theirs.standard_error)
    np.testing.assert_allclose(ours.low, ends.low, atol=tolerance)
    np.testing.assert_allclose(ours.high, ends.high, atol=tolerance)
    assert ours.value == statistic(SAMPLE)


def test_covers_the_truth_about_95_times_in_100() -> None:
    samples = np.random.default_rng(4).normal(size=(300, 60))
    interval = bootstrap(samples, seed=5, resamples=400)
    covered = np.mean((interval.low <= 0) & (interval.high >= 0))
    assert 0.90 <= covered <= 0.98


def test_same_seed_same_bits_in_every_batch() -> None:
    values = np.random.default_rng(0).normal(size=(2, 3, 25))
    values[1, 0, 4:9] = NAN
    together = bootstrap(values, seed=11)
    again = bootstrap(values, seed=11)
    other = bootstrap(values, seed=12)
    assert together.low.shape == (2, 3)
    assert (together.low == again.low).all()
    assert (together.low != other.low).any()
    for row in np.ndindex(2, 3):
        alone = bootstrap(values[row], seed=11)
        assert (alone.low, alone.high) == (together.low[row], together.high[row])
        assert alone.n == together.n[row]


def test_undefined_values_are_left_out_and_counted() -> None:
    gaps = np.insert(SAMPLE, [0, 10, 80], NAN)
    ours, plain = bootstrap(gaps, seed=3), bootstrap(SAMPLE, seed=3)
    np.testing.assert_array_equal([ours.low, ours.high, ours.n], [plain.low, plain.high, 80])
    few = bootstrap([[NAN, NAN], [2.0, NAN]], seed=0)
    np.testing.assert_array_equal(few.value, [NAN, 2.0])
    np.testing.assert_array_equal(few.low, [NAN, NAN])
    np.testing.assert_array_equal(few.n, [0, 1])


def test_strata_keep_what_differs_between_them_out_of_the_interval() -> None:
    # Two maps that differ by 100 and have no spread within: stratified, nothing varies.
    values, maps = np.repeat([0.0, 100.0], 10), np.repeat(["bay", "port"], 10)
    stratified = bootstrap(values, seed=0, strata=maps)
    np.testing.assert_array_equal([stratified.low, stratified.high], 50.0)
    assert bootstrap(values, seed=0).low < 40.0


def test_strata_go_with_their_episodes_where_some_are_undefined() -> None:
    """Three of the bay are undefined: 7 of 0 and 10 of 100 are left, and nothing varies."""
    values, maps = np.repeat([0.0, 100.0], 10), np.repeat(["bay", "port"], 10)
    values[:3] = NAN
    found = bootstrap(values, seed=0, strata=maps)
    np.testing.assert_allclose([found.value, found.low, found.high], 1000.0 / 17.0)


def test_many_resamples_are_drawn_in_blocks() -> None:
    values = np.arange(3000.0)  # 333 resamples fill a block
    rng = np.random.default_rng(9)
    means = values[rng.integers(3000, size=(700, 3000))].mean(axis=1)
    interval = bootstrap(values, seed=9, resamples=700)
    expected = np.quantile(means, [0.025, 0.975])
    np.testing.assert_allclose([interval.low, interval.high], expected)


@given(st.lists(st.floats(-100, 100), min_size=2, max_size=12), st.integers(0, 100))
def test_interval_stays_within_the_sample(sample: list[float], seed: int) -> None:
    interval = bootstrap(sample, seed, resamples=50)
    assert min(sample) - 1e-9 <= interval.low <= interval.high <= max(sample) + 1e-9


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resamples": 0}, "resamples 0"),
        ({"level": 1.0}, "level 1.0"),
        ({"strata": [0, 1]}, "strata of shape"),
    ],
)
def test_rejects(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        bootstrap(SAMPLE, seed=0, **options)
    with pytest.raises(ValueError, match="use NaN"):
        bootstrap([1.0, np.inf], seed=0)
