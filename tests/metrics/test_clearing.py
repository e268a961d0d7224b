"""Times until a share is collected, and their median over episodes."""

import math
from typing import Any

import numpy as np
import pytest
import scipy.stats

from mjforage.metrics import clearing_time, median_time, never_share


def test_a_share_is_reached_with_the_item_that_completes_it() -> None:
    times = [7.0, 3.0, math.inf, 1.0, 5.0, 9.0, 2.0, 8.0, 6.0, 4.0]
    assert [clearing_time(times, share) for share in (0.1, 0.5, 0.51, 0.9)] == [1.0, 5.0, 6.0, 9.0]
    assert math.isinf(clearing_time(times, 0.91))
    assert math.isnan(clearing_time([], 0.5))
    for share in (0.0, 1.1):
        with pytest.raises(ValueError, match="share"):
            clearing_time(times, share)


@pytest.mark.parametrize("n", [7, 20, 100])
def test_a_median_has_the_interval_that_scipy_gives_it(n: int) -> None:
    values = np.random.default_rng(n).exponential(size=n)
    known: Any = scipy.stats.quantile_test(values, p=0.5).confidence_interval(0.95)
    expected = [np.median(values), known.low, known.high, n]
    assert list(map(float, median_time(values))) == expected


def test_episodes_that_never_get_there_are_last() -> None:
    found = median_time([1.0, 2.0, math.inf, math.inf, 3.0, math.nan] * 4)
    assert list(map(float, found)) == [3.0, 2.0, math.inf, 20.0]
    assert math.isinf(median_time([1.0, math.inf]).value)
    assert math.isnan(median_time([1.0] * 5).low)
    assert math.isnan(median_time([]).value)
    share = never_share([1.0, 2.0, math.inf, 3.0, math.nan])
    known = scipy.stats.binomtest(1, 4).proportion_ci(0.95, "exact")
    assert (share.value, share.low, share.high) == pytest.approx((0.25, known.low, known.high))


def test_the_interval_of_a_median_covers() -> None:
    """At least 95 % of samples of a skewed law whose median is known, a third of it never."""
    draws = np.random.default_rng(5)
    times = draws.uniform(size=(4000, 20))
    times[times > 2 / 3] = math.inf
    intervals = [median_time(one) for one in times]
    share = np.mean([one.low <= 0.5 <= one.high for one in intervals])
    assert 0.95 <= share <= 0.97
