import numpy as np
import pytest

from mjforage.metrics import mean, paired_contribution, sem

FULL = np.array([4.0, 8.0, 6.0, np.nan])
WITHOUT = np.array([2.0, 4.0, 3.0, 5.0])


def test_it_is_the_contribution_of_the_means_of_whole_pairs() -> None:
    found = paired_contribution(FULL, WITHOUT, higher_is_better=True)
    assert mean(found) == pytest.approx((6.0 - 3.0) / 6.0)
    np.testing.assert_array_equal(np.isnan(found), [False, False, False, True])


def test_costs_are_compared_with_the_lesser_team() -> None:
    """Without the agent each episode costs twice as much: a half of it, in every episode."""
    found = paired_contribution(WITHOUT, FULL, higher_is_better=False)
    np.testing.assert_allclose(found[:3], 0.5)


def test_pairs_stay_together() -> None:
    """A half in every episode has no spread; pairs of unlike episodes have."""
    assert sem(paired_contribution(FULL, WITHOUT, higher_is_better=True)) == 0.0
    assert sem(paired_contribution(FULL[:3], WITHOUT[[1, 2, 0]], higher_is_better=True)) > 0.1


@pytest.mark.parametrize("higher", [True, False])
def test_its_standard_error_is_that_of_the_ratio(higher: bool) -> None:
    """Against the spread of contributions of 2,000 samples."""
    rng = np.random.default_rng(0)
    full = rng.gamma(9.0, size=(2000, 200))
    without = 0.3 * full + rng.gamma(1.0, size=(2000, 200))
    sides = [np.mean(full, axis=1), np.mean(without, axis=1)]
    gain = (sides[0] - sides[1]) if higher else (sides[1] - sides[0])
    spread = np.std(gain / sides[0 if higher else 1])
    found = paired_contribution(full[0], without[0], higher_is_better=higher)
    assert float(sem(found)) == pytest.approx(spread, rel=0.15)


@pytest.mark.parametrize(
    ("full", "without"), [([0.0, 0.0], [0.0, 0.0]), ([np.nan, np.nan], [1.0, 2.0])]
)
def test_undefined_contributions_are_nan(full: list[float], without: list[float]) -> None:
    assert np.isnan(paired_contribution(full, without, higher_is_better=True)).all()


def test_shapes_must_fit() -> None:
    with pytest.raises(ValueError, match="full"):
        paired_contribution([1.0, 2.0], [1.0], higher_is_better=True)
    with pytest.raises(ValueError, match=r"\(episode,\) is needed"):
        paired_contribution([[1.0]], [[1.0]], higher_is_better=True)
