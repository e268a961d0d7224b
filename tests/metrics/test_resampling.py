"""Resampled episodes and percentile intervals: numpy as oracle."""

import numpy as np
import pytest

from mjforage.metrics.resampling import percentiles, resampled


def test_the_interval_has_the_share_asked_for_in_its_middle() -> None:
    """Of 0 to 1000 the middle 95 % reach from 25 to 975, the middle half from 250 to 750."""
    assert percentiles(np.arange(1001.0)) == pytest.approx((25.0, 975.0))
    assert percentiles(np.arange(1001.0), 0.5) == pytest.approx((250.0, 750.0))


def test_many_resamples_are_drawn_in_blocks() -> None:
    rng = np.random.default_rng(9)
    found = list(resampled([np.arange(3000)], 9, 700))  # 333 resamples fill a block
    assert len(found) == 3
    np.testing.assert_array_equal(np.concatenate(found), rng.integers(3000, size=(700, 3000)))


def test_each_group_is_drawn_within_itself() -> None:
    (drawn,) = resampled([np.array([0, 1]), np.array([2, 3, 4])], 0, 50)
    assert (drawn[:, :2] < 2).all() and (drawn[:, 2:] >= 2).all()
    assert len(np.unique(drawn)) == 5


def test_rejects() -> None:
    with pytest.raises(ValueError, match="resamples 0"):
        next(resampled([np.arange(3)], 0, 0))
    with pytest.raises(ValueError, match=r"level 1\.0"):
        percentiles(np.arange(3.0), 1.0)
