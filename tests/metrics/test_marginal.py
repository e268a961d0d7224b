import numpy as np
import pytest

from mjforage.metrics import paired_contribution

FULL = np.array([4.0, 8.0, 6.0, np.nan])
WITHOUT = np.array([2.0, 4.0, 3.0, 5.0])


def test_it_is_the_contribution_of_the_means_of_whole_pairs() -> None:
    found = paired_contribution(FULL, WITHOUT, 0, higher_is_better=True)
    assert float(found.value) == pytest.approx((6.0 - 3.0) / 6.0)
    assert int(found.n) == 3


def test_costs_are_compared_with_the_lesser_team() -> None:
    found = paired_contribution(WITHOUT, FULL, 0, higher_is_better=False)
    assert float(found.value) == pytest.approx((6.0 - 3.0) / 6.0)


def test_pairs_stay_together_in_every_resample() -> None:
    found = paired_contribution(FULL, WITHOUT, 0, higher_is_better=True)
    assert (float(found.low), float(found.high)) == pytest.approx((0.5, 0.5))
    shuffled = paired_contribution(FULL[:3], WITHOUT[[1, 2, 0]], 0, higher_is_better=True)
    assert float(shuffled.low) < 0.4
    assert float(shuffled.high) > 0.6


@pytest.mark.parametrize(
    ("full", "without"), [([0.0, 0.0], [0.0, 0.0]), ([1.0, np.nan], [1.0, 2.0])]
)
def test_undefined_intervals_are_nan(full: list[float], without: list[float]) -> None:
    found = paired_contribution(full, without, 0, higher_is_better=True)
    assert np.isnan(found.low)
    assert np.isnan(found.high)


def test_shapes_must_fit() -> None:
    with pytest.raises(ValueError, match="full"):
        paired_contribution([1.0, 2.0], [1.0], 0, higher_is_better=True)
    with pytest.raises(ValueError, match=r"\(episode,\) is needed"):
        paired_contribution([[1.0]], [[1.0]], 0, higher_is_better=True)


def test_intervals_of_costs_are_of_the_cost_and_have_the_level_and_draws_asked_for() -> None:
    """Without the agent each episode costs twice as much: a half of it, in every resample."""
    found = paired_contribution(WITHOUT[:3], FULL[:3], 0, higher_is_better=False)
    assert (float(found.low), float(found.high)) == (0.5, 0.5)
    whole = np.linspace(1.0, 9.0, 20)
    rest = np.random.default_rng(1).permutation(whole) / 2
    wide, narrow, other = (
        paired_contribution(whole, rest, seed, higher_is_better=True, level=level)
        for seed, level in ((0, 0.95), (0, 0.5), (1, 0.95))
    )
    assert wide.low < narrow.low < narrow.high < wide.high
    assert (wide.low, wide.high) != (other.low, other.high)
