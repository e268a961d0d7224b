"""Primary metrics against hand-made episodes and their general properties."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.metrics import EventTable, irr, mean_idleness, nt, pta_series, throughput

NAN = np.nan
SEEDS = st.integers(0, 10_000)
Build = Callable[..., EventTable]


def test_pta_by_hand() -> None:
    # 2 of 5 existing items: 40 %; the sixth is padding. The other episode has no item.
    times = np.array([[1.0, NAN, 3.0, NAN, NAN, NAN], [NAN] * 6])
    exists = np.array([[True] * 5 + [False], [False] * 6])
    # Steps 0..4: none, one of five, one, two, two.
    expected = [[0.0, 20.0, 20.0, 40.0, 40.0], [NAN] * 5]
    np.testing.assert_array_equal(pta_series(times, exists, 4), expected)


def test_pta_rejects_other_shape() -> None:
    with pytest.raises(ValueError, match="times has shape"):
        pta_series(np.zeros((2, 3)), np.ones((3, 2), dtype=bool), 4)


def test_nt_by_hand() -> None:
    # T = 4: 50 % is reached at step 2, 90 % at step 4, 100 % never.
    series = [0.0, 25.0, 50.0, 75.0, 90.0]
    assert [float(nt(series, x)) for x in (50.0, 90.0, 100.0)] == [0.5, 1.0, 1.0]
    assert nt([60.0, 60.0], 50.0) == 0.0
    assert np.isnan(nt([NAN, NAN], 50.0))


def test_nt_meets_a_threshold_exactly_on_the_share() -> None:
    # 63 of 70 items are 90 % although 63 / 70 is not a binary fraction.
    times = np.where(np.arange(70) < 63, 5.0, NAN)
    assert nt(pta_series(times, np.ones(70, dtype=bool), 10), 90.0) == 0.5


@pytest.mark.parametrize("threshold", [0.0, 100.5, NAN])
def test_nt_rejects_threshold(threshold: float) -> None:
    with pytest.raises(ValueError, match="threshold"):
        nt([0.0, 1.0], threshold)


def test_nt_rejects_a_series_without_steps() -> None:
    with pytest.raises(ValueError, match="horizon 0"):
        nt([0.0], 50.0)


def test_throughput_by_hand() -> None:
    # 3 items by step 10, 2 agents: 3 / (2 x 10) = 0.15; the one at step 12 comes too late.
    assert throughput([1.0, 4.0, 10.0, 12.0, NAN], agents=2, horizon=10) == 0.15
    assert np.isnan(throughput([1.0], agents=0, horizon=10))


@pytest.mark.parametrize(("agents", "horizon"), [(-1, 10), (2, 0)])
def test_throughput_rejects(agents: int, horizon: int) -> None:
    with pytest.raises(ValueError, match=r"agents -1|horizon 0"):
        throughput([1.0], agents, horizon)


def test_idleness_by_hand() -> None:
    # Four nodes: (0 + 0.5 + 1 + 0.5) / 4 = 0.5; falling from 0.75 to 0.5 over 2 s is 0.125 / s.
    assert mean_idleness([0.0, 0.5, 1.0, 0.5]) == 0.5
    np.testing.assert_array_equal(irr([0.75, 0.5, 0.625]), [0.25, -0.125])
    np.testing.assert_array_equal(irr([0.75, 0.5], step=2.0), [0.125])


def test_idleness_rejects() -> None:
    with pytest.raises(ValueError, match="no node"):
        mean_idleness(np.zeros((2, 0)))
    with pytest.raises(ValueError, match="step 0"):
        irr([1.0, 0.5], step=0.0)


@given(SEEDS)
def test_irr_sums_to_the_total_fall(seed: int) -> None:
    series = np.random.default_rng(seed).random((2, 20))
    np.testing.assert_allclose(irr(series).sum(axis=-1), series[:, 0] - series[:, -1])
