"""Families of paired differences, and the probability of improvement; scipy as oracle."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mjforage.metrics import FEWEST, compared, episodes_needed, probability_of_improvement

NAN = np.nan
SMALL = st.lists(st.integers(-3, 3), min_size=1, max_size=9)


def test_one_difference_is_tested_as_scipy_flips_signs() -> None:
    gaps = np.random.default_rng(3).gamma(2.0, size=25) - 1.3
    found = compared([gaps])
    theirs = stats.permutation_test(
        (gaps,),
        lambda x, axis: np.abs(stats.ttest_1samp(x, 0.0, axis=axis).statistic),
        permutation_type="samples",
        n_resamples=20_000,
        alternative="greater",
        rng=np.random.default_rng(1),
    )
    bound = 2.326 * np.sqrt(theirs.pvalue * (1 - theirs.pvalue) / 2000)
    assert found.p[0] == pytest.approx(theirs.pvalue + bound, abs=0.012)
    assert (found.value[0], found.n[0]) == (pytest.approx(gaps.mean()), 25)


def test_of_many_episodes_a_single_one_has_the_t_interval() -> None:
    gaps = np.random.default_rng(3).normal(0.1, 1.0, 400)
    found = compared([gaps])
    wanted = stats.ttest_1samp(gaps, 0.0)
    low, high = map(float, wanted.confidence_interval(0.95))
    assert 0 < found.p[0] - wanted.pvalue < 0.025
    half = (high - low) / 2
    assert (found.low[0], found.high[0]) == pytest.approx((low, high), abs=0.06 * half)


@given(st.integers(0, 50), st.integers(1, 6))
def test_interval_and_p_never_disagree(seed: int, several: int) -> None:
    rng = np.random.default_rng(seed)
    family = rng.normal(rng.normal(0.0, 0.6, (several, 1)), 1.0, (several, 15)).round(1)
    found = compared(list(family))
    np.testing.assert_array_equal(found.p < 0.05, (found.low > 0) | (found.high < 0))


def test_a_family_holds_together_in_95_of_100() -> None:
    """60 families of 20 differences that are 0, of skewed values: some interval misses in 5 %."""
    rng = np.random.default_rng(5)
    missed = 0
    for _ in range(60):
        values = rng.gamma(1.0, size=(7, 30))
        pairs = [values[i] - values[j] for i in range(7) for j in range(i)]
        missed += bool((compared(pairs).p < 0.05).any())
    assert missed <= 7  # 1 % of binomial(60, 0.05) lies above


def test_more_differences_make_each_less_sure() -> None:
    rng = np.random.default_rng(1)
    gaps = rng.normal(0.5, 1.0, 30)
    alone = compared([gaps])
    among = compared([gaps, *rng.normal(size=(40, 30))])
    assert among.p[0] > alone.p[0]
    assert among.low[0] < alone.low[0] < alone.value[0] == among.value[0]


def test_pairs_lack_a_side_and_few_pairs_are_not_tested() -> None:
    gaps = np.array([*np.linspace(1.0, 3.0, FEWEST), NAN, NAN])
    few = np.array([*gaps[: FEWEST - 1], *[NAN] * 3])
    found, plain = compared([gaps, few]), compared([gaps])
    np.testing.assert_array_equal(found.n, [FEWEST, FEWEST - 1])
    assert np.isnan([found.p[1], found.low[1], found.high[1]]).all()
    assert (found.p[0], found.low[0]) == (plain.p[0], plain.low[0])
    assert found.value[1] == pytest.approx(few[: FEWEST - 1].mean())
    empty = compared([])
    assert empty.p.size == 0


def test_equal_differences_are_no_certainty_and_none_is_no_difference() -> None:
    """Of 10 equal differences all signs agree in 2 of 1024 draws."""
    found = compared([np.full(10, 3.0)])
    assert found.p[0] == pytest.approx(0.005, abs=0.002)
    assert (found.low[0], found.high[0]) == (3.0, 3.0)
    assert compared([np.zeros(12)]).p[0] == 1.0


def test_it_takes_episodes_in_proportion_to_the_variance() -> None:
    """Differences of 1 and -1 with the standard deviation 1.026: (2.8016 * 1.026)^2 + 1.92."""
    gaps = np.resize([1.0, -1.0], 20)
    assert episodes_needed(gaps, 1.0) == 11
    assert episodes_needed(gaps, 0.1) == 829
    assert episodes_needed(gaps[:9], 1.0) is None
    with pytest.raises(ValueError, match="above 0"):
        episodes_needed(gaps, 0.0)


def test_the_episodes_needed_find_the_difference_in_80_of_100() -> None:
    rng = np.random.default_rng(0)
    n = episodes_needed(rng.normal(0.0, 2.0, 5000), 1.0)
    assert n is not None
    p = stats.ttest_1samp(rng.normal(1.0, 2.0, (4000, n)), 0.0, axis=-1).pvalue
    assert np.mean(p < 0.05) == pytest.approx(0.8, abs=0.025)


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


def test_rejects() -> None:
    with pytest.raises(ValueError, match="use NaN"):
        compared([np.array([1.0, np.inf])])
    with pytest.raises(ValueError, match="leading axes"):
        probability_of_improvement(np.zeros((2, 3)), np.zeros((3, 3)))
