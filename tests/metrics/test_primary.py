"""Primary metrics against hand-made episodes and their general properties."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mjforage.metrics import EventTable, irr, mean_idleness, nt, pta, pta_series, throughput

NAN = np.nan
SEEDS = st.integers(0, 10_000)
Build = Callable[..., EventTable]


def test_pta_by_hand() -> None:
    # 2 of 5 existing items: 40 %; the sixth is padding. The other episode has no item.
    times = np.array([[1.0, NAN, 3.0, NAN, NAN, NAN], [NAN] * 6])
    exists = np.array([[True] * 5 + [False], [False] * 6])
    np.testing.assert_array_equal(pta(times, exists), [40.0, NAN])
    # Steps 0..4: none, one of five, one, two, two.
    expected = [[0.0, 20.0, 20.0, 40.0, 40.0], [NAN] * 5]
    np.testing.assert_array_equal(pta_series(times, exists, 4), expected)


def test_pta_rejects_other_shape() -> None:
    with pytest.raises(ValueError, match="times has shape"):
        pta(np.zeros((2, 3)), np.ones((3, 2), dtype=bool))


@given(SEEDS)
def test_pta_bounds_growth_and_order(random_events: Build, seed: int) -> None:
    events = random_events(seed)
    found = pta_series(events.discovered_at, events.exists, 30)
    taken = pta_series(events.collected_at, events.exists, 30)
    defined = ~np.isnan(found)
    assert ((found >= 0) & (found <= 100))[defined].all()
    assert (np.diff(found, axis=-1) >= 0)[defined[:, 1:]].all()
    assert (found >= taken)[defined].all()
    np.testing.assert_array_equal(found[:, -1], pta(events.discovered_at, events.exists))


@given(SEEDS)
def test_pta_adds_up_over_disjoint_items(random_events: Build, seed: int) -> None:
    events = random_events(seed)
    some = np.random.default_rng(seed).random(events.exists.shape) < 0.5
    total = np.zeros(len(some))
    for part in (events.exists & some, events.exists & ~some):
        size = part.sum(axis=-1)
        total += np.where(size > 0, pta(events.collected_at, part) * size, 0.0)
    whole = pta(events.collected_at, events.exists) * events.exists.sum(axis=-1)
    np.testing.assert_allclose(total, whole)


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


@given(SEEDS, st.floats(1.0, 100.0), st.floats(1.0, 100.0))
def test_nt_bounds_and_order(random_events: Build, seed: int, a: float, b: float) -> None:
    events = random_events(seed)
    series = pta_series(events.discovered_at, events.exists, 30)
    sooner, later = nt(series, min(a, b)), nt(series, max(a, b))
    defined = ~np.isnan(sooner)
    assert (sooner <= later)[defined].all()
    assert ((sooner >= 0) & (later <= 1))[defined].all()


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


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_mean_idleness_has_the_same_bits_in_every_batch(dtype: type) -> None:
    values: NDArray[np.floating] = np.random.default_rng(3).random((7, 1297)).astype(dtype)
    together = mean_idleness(values)
    assert [float(mean_idleness(row)) for row in values] == together.tolist()
    assert mean_idleness(np.asfortranarray(values)).tolist() == together.tolist()


@given(SEEDS)
def test_irr_sums_to_the_total_fall(seed: int) -> None:
    series = np.random.default_rng(seed).random((2, 20))
    np.testing.assert_allclose(irr(series).sum(axis=-1), series[:, 0] - series[:, -1])
