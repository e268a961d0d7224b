"""The process against its covariance, exactly (as a linear map of its draws) and by statistics."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mjforage.base.randomness import Stream, episode_keys, stream_key
from mjforage.forcing.gauss_markov import (
    LEVELS,
    ROOT,
    SMALLEST,
    gauss_markov_pair,
    normal_pair,
)

KEY = np.uint64(stream_key(episode_keys(3, np.arange(1))[0], Stream.GUSTS))
Draw = tuple[int, int]  # index and step of a normal
Weights = dict[Draw, float]


def combined(a: Weights, b: Weights, wa: float, wb: float) -> Weights:
    return {d: wa * a.get(d, 0.0) + wb * b.get(d, 0.0) for d in {**a, **b}}


@cache
def vertex(level: int, index: int) -> Weights:
    """Weights of the draws in the process at time index * ROOT / 2**level."""
    if level == 0:
        return {(index, 0): 1.0}
    if index % 2 == 0:
        return vertex(level - 1, index // 2)
    left, right = vertex(level - 1, index // 2), vertex(level - 1, index // 2 + 1)
    length = ROOT / 2 ** (level - 1)
    return bridged(left, right, length, length / 2, (index // 2, level))


def bridged(left: Weights, right: Weights, length: float, since: float, draw: Draw) -> Weights:
    """Doob's bridge at `since` in an interval, in its general form."""
    a, b, whole = math.sinh(length - since), math.sinh(since), math.sinh(length)
    inside = combined(left, right, a / whole, b / whole)
    return inside | {draw: math.sqrt(2 * a * b / whole)}


def weights_at(time: float) -> Weights:
    cell = math.floor(time / SMALLEST)
    ends = vertex(LEVELS, cell), vertex(LEVELS, cell + 1)
    return bridged(*ends, SMALLEST, time - cell * SMALLEST, (cell, LEVELS + 1))


def covariance(a: Weights, b: Weights) -> float:
    return sum(weight * b.get(draw, 0.0) for draw, weight in a.items())


times = st.floats(-90, 200).map(lambda t: round(t, 6))


@given(a=times, lag=st.floats(0, 60))
@example(a=0.0, lag=ROOT)
@example(a=ROOT - 1e-6, lag=2e-6)
@example(a=-ROOT / 3, lag=SMALLEST)
def test_any_two_times_have_the_covariance_of_the_process(a: float, lag: float) -> None:
    first, second = weights_at(a), weights_at(a + lag)
    assert covariance(first, first) == pytest.approx(1.0, abs=1e-12)
    same_cell = math.floor(a / SMALLEST) == math.floor((a + lag) / SMALLEST)
    tolerance = SMALLEST if same_cell else 1e-10
    assert covariance(first, second) == pytest.approx(math.exp(-lag), abs=tolerance)


@given(time=times)
@example(time=0.0)
@example(time=-1e-6)
def test_the_kernel_is_that_linear_map_of_its_draws(time: float) -> None:
    weights = weights_at(time)
    for component in range(2):
        slow = sum(w * normal_pair(KEY, *draw)[component] for draw, w in weights.items())
        assert gauss_markov_pair(KEY, time)[component] == pytest.approx(slow, abs=1e-8)


def test_asking_in_between_changes_nothing() -> None:
    coarse = [gauss_markov_pair(KEY, t) for t in np.arange(50.0)]
    fine = {float(t): gauss_markov_pair(KEY, float(t)) for t in np.arange(1600)[::-1] / 32}
    assert [fine[float(t)] for t in range(50)] == coarse


def test_the_path_is_continuous_across_intervals() -> None:
    for edge in (0.0, ROOT, ROOT / 2, 17 * SMALLEST, -5 * SMALLEST):
        before, after = gauss_markov_pair(KEY, edge - 1e-12), gauss_markov_pair(KEY, edge + 1e-12)
        assert np.abs(np.subtract(before, after)).max() < 1e-4
    a, b = gauss_markov_pair(KEY, 1.0), gauss_markov_pair(KEY, 1.0 + SMALLEST)
    assert a != b
