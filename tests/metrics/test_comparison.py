"""Paired difference and probability of improvement against hand-made pairs and scipy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mjforage.metrics import holm, iqm, paired_difference, paired_p, probability_of_improvement

NAN = np.nan
SMALL = st.lists(st.integers(-3, 3), min_size=1, max_size=9)


def test_paired_difference_by_hand() -> None:
    # Pairs (3, 1), (5, 2): (2 + 3) / 2 = 2.5; the others lack a side.
    gap = paired_difference([3.0, 5.0, NAN, 9.0], [1.0, 2.0, 4.0, NAN], seed=0)
    np.testing.assert_array_equal([gap.value, gap.n], [2.5, 2])
    np.testing.assert_array_equal([gap.low, gap.high], [2.0, 3.0])


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
    better = probability_of_improvement([1.0, 3.0, NAN], [1.0, 2.0])
    assert better == 0.625


def test_improvement_with_nothing_to_compare() -> None:
    better = probability_of_improvement([[NAN, NAN], [1.0, NAN]], [[1.0], [2.0]])
    np.testing.assert_array_equal(better, [NAN, 0.0])


@given(SMALL, SMALL)
def test_improvement_is_the_share_of_pairs(x: list[int], y: list[int]) -> None:
    value = probability_of_improvement(x, y)
    u = stats.mannwhitneyu(x, y, method="asymptotic").statistic
    np.testing.assert_allclose(value, u / (len(x) * len(y)))
    turned = probability_of_improvement(y, x)
    np.testing.assert_allclose(value + turned, 1.0)
    stretched = probability_of_improvement(np.exp(x), np.exp(y))
    assert stretched == value


def test_a_paired_difference_has_the_statistic_strata_and_level_asked_for() -> None:
    """Of 1 to 11 and 1000 the middle half is 4 to 9. Two maps differ by 100 and not within."""
    x = np.array([*range(1, 12), 1000.0])
    assert float(paired_difference(x, np.zeros(12), 0, statistic=iqm).value) == 6.5
    maps = np.repeat([0, 1], 10)
    kept = paired_difference(100.0 * maps, np.zeros(20), 0, strata=maps)
    np.testing.assert_array_equal([kept.low, kept.high], 50.0)
    wide, narrow = (paired_difference(x, np.zeros(12), 0, level=one) for one in (0.95, 0.5))
    assert wide.low < narrow.low < narrow.high < wide.high


def test_rejects() -> None:
    with pytest.raises(ValueError, match="x has shape"):
        paired_difference([1.0, 2.0], [1.0], seed=0)
    with pytest.raises(ValueError, match="leading axes"):
        probability_of_improvement(np.zeros((2, 3)), np.zeros((3, 3)))


def test_p_of_the_paired_t_test_as_scipy_has_it() -> None:
    random = np.random.default_rng(1)
    x, y = random.normal(0.3, 1.0, (4, 30)), random.normal(size=(4, 30))
    np.testing.assert_allclose(paired_p(x, y), stats.ttest_rel(x, y, axis=-1).pvalue, rtol=1e-9)
    with_gap = np.where(np.arange(30) == 7, np.nan, x)
    kept = np.arange(30) != 7
    expected = stats.ttest_rel(x[:, kept], y[:, kept], axis=-1).pvalue
    np.testing.assert_allclose(paired_p(with_gap, y), expected, rtol=1e-9)


def test_p_of_a_t_known_from_tables() -> None:
    """Nine differences of 1 and one of -1: mean .8, standard error .2, so t = 4 of 9 degrees."""
    differences = np.array([1.0] * 9 + [-1.0])
    assert float(paired_p(differences, np.zeros(10))) == pytest.approx(0.0031, abs=5e-5)


def test_equal_differences_are_no_certainty_and_none_is_no_difference() -> None:
    assert float(paired_p(np.full(12, 3.0), np.zeros(12))) == 2.0**-11
    assert float(paired_p(np.full(12, 0.3), np.full(12, 0.3))) == 1.0
    assert np.isnan(paired_p([1.0, np.nan], [0.0, 0.0]))


def test_p_refuses_unlike_shapes() -> None:
    with pytest.raises(ValueError, match="shape"):
        paired_p(np.zeros(3), np.zeros(4))


def test_holm_by_hand() -> None:
    """Four tests: 4 * .005, 3 * .01, 2 * .03 and .04, which may not fall below its forerunner."""
    np.testing.assert_allclose(holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02])


def test_holm_leaves_out_what_was_not_tested_and_stops_at_one() -> None:
    found = holm([np.nan, 0.02, 0.7, 0.9])
    assert np.isnan(found[0])
    np.testing.assert_allclose(found[1:], [0.06, 1.0, 1.0])
    assert holm([]).size == 0


@pytest.mark.parametrize(
    ("p", "words"),
    [([[0.1]], "flat list"), ([0.1, 1.2], r"p\[1\] is 1\.2"), ([-0.1], r"p\[0\] is -0\.1")],
)
def test_holm_refuses_what_are_no_p_values(p: list[float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        holm(p)
