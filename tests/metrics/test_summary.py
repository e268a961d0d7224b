"""The summary of a metric puts together what the single functions say."""

import numpy as np
import pytest

from mjforage.metrics import bootstrap, iqm, mean, sem, summarise


def test_summary_is_its_parts() -> None:
    values = np.random.default_rng(0).gamma(2.0, size=(3, 40))
    values[1, :7] = np.nan
    summary, interval = summarise(values, seed=5), bootstrap(values, seed=5)
    np.testing.assert_array_equal(summary.mean, mean(values))
    np.testing.assert_array_equal(summary.sem, sem(values))
    np.testing.assert_array_equal(summary.iqm, iqm(values))
    np.testing.assert_array_equal(summary.low, interval.low)
    np.testing.assert_array_equal(summary.high, interval.high)
    np.testing.assert_array_equal(summary.n, [40, 33, 40])


def test_summary_passes_strata_on() -> None:
    maps = np.repeat([0, 1], 5)
    summary = summarise(10.0 * maps, seed=0, strata=maps)
    np.testing.assert_array_equal([summary.low, summary.high], 5.0)
    with pytest.raises(ValueError, match="strata"):
        summarise(10.0 * maps, seed=0, strata=maps[:3])
