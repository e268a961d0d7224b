"""The batched core of the environments against plain numpy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mjforage.graph_planner.graph.navigation import STAY
from mjforage.learning.environments.core import (
    _how_it_ended,
    _share_happened,
)
from mjforage.mission.moves import CHOSEN, OTHERWISE_STAY, preferences_of

seeds = st.integers(0, 2**32 - 1)


def test_what_happened_is_counted() -> None:
    when, items = np.array([[0, -1, 7, -1], [-1] * 4], np.int16), np.array([3, 4], np.int32)
    assert _share_happened(when, items).tolist() == [100.0 * 2 / 3, 0.0]


@given(seeds)
def test_a_chosen_move_is_preferred_and_staying_comes_next(seed: int) -> None:
    actions = np.random.default_rng(seed).integers(0, 9, (3, 4))
    expected = np.zeros((3, 4, 9))
    expected[..., STAY] = OTHERWISE_STAY
    np.put_along_axis(expected, actions[..., None], CHOSEN, axis=-1)
    np.testing.assert_array_equal(preferences_of(actions), expected)


@given(seeds)
def test_how_a_step_ended(seed: int) -> None:
    random = np.random.default_rng(seed)
    played, active = random.random((2, 16)) < 0.7
    wanted, taken = random.integers(0, 3, (16, 2)), random.integers(0, 3, (16, 2)).astype(np.int8)
    exhausted = random.random((16, 2)) < 0.6
    item_node = random.integers(-1, 1, (16, 2)).astype(np.int32)
    left, gone = (item_node >= 0).any(axis=1), exhausted.all(axis=1)
    terminated = played & (~left | gone)
    expected = (
        terminated,
        played & ~terminated & ~active,
        ((taken != wanted) & played[:, None]).sum(axis=1),
    )
    found = _how_it_ended(played, active, wanted, taken, exhausted, item_node)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype
