"""Inter-team metrics against a hand-made episode and their general properties."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

from mjforage.metrics import (
    EventTable,
    csr_series,
    itl,
    itl_level,
    mean_dsl,
)

NAN = np.nan
SCOUTS = [0, 1]
SEEDS = st.integers(0, 10_000)
Build = Callable[..., EventTable]

# Five items, T = 10. Scouts 0 and 1 find items 0, 1 and 3; forager 2 stumbles on item 2.
EPISODE = EventTable(
    discovered_at=np.array([1.0, 2.0, 4.0, 5.0, NAN]),
    discovered_by=np.array([0, 1, 2, 0, -1]),
    collected_at=np.array([4.0, 7.0, 4.0, NAN, NAN]),
    collected_by=np.array([2, 3, 2, -1, -1]),
    exists=np.ones(5, dtype=bool),
)


def test_dsl_by_hand() -> None:
    # (4 - 1) / 10 and (7 - 2) / 10; item 2 was no scout's, item 3 was never collected.
    np.testing.assert_allclose(mean_dsl(EPISODE, SCOUTS, 10), 0.4)
    assert np.isnan(mean_dsl(EPISODE, [], 10))


def test_csr_by_hand() -> None:
    # Collected: items 0, 1, 2; two of the three were found by scouts.
    # Nothing until step 3; items 0 and 2 at 4: one of two; item 1 at 7: two of three.
    expected = [NAN] * 4 + [1 / 2] * 3 + [2 / 3] * 4
    np.testing.assert_allclose(csr_series(EPISODE, SCOUTS, 10), expected)


def test_csr_is_undefined_with_nothing_collected() -> None:
    untouched = EventTable(
        EPISODE.discovered_at,
        EPISODE.discovered_by,
        collected_at=np.full(5, NAN),
        collected_by=np.full(5, -1),
        exists=EPISODE.exists,
    )
    assert np.isnan(csr_series(untouched, SCOUTS, 10)).all()


def test_csr_is_0_without_scouts() -> None:
    assert csr_series(EPISODE, [], 10)[-1] == 0.0


@pytest.mark.parametrize(
    ("scouts", "message"),
    [
        ([0, 0], "listed twice"),
        ([-1], "negative"),
        ([0.0], "flat"),
        ([[0, 1]], "flat"),
        (0, "flat"),
    ],
)
def test_bad_scouts_are_rejected(scouts: Any, message: str) -> None:
    for metric in (csr_series, mean_dsl):
        with pytest.raises(ValueError, match=message):
            metric(EPISODE, scouts, 10)


def test_bad_horizon_is_rejected() -> None:
    with pytest.raises(ValueError, match="horizon 0"):
        mean_dsl(EPISODE, SCOUTS, 0)


def test_itl_by_hand() -> None:
    # T = 4. Increments 1 3 1 0 peak at step 2; 0 1 0 4 at step 4: |2 - 4| / 4 = 0.5.
    found, taken = [2, 3, 6, 7, 7], [0, 0, 1, 1, 5]
    assert itl(found, taken) == 0.5
    # Levels: 7 is first reached at step 3, 5 at step 4: 0.25.
    assert itl_level(found, taken) == 0.25


def test_itl_ignores_what_happened_at_the_start() -> None:
    # 9 items in view at t = 0 are no increment; both teams peak at step 1.
    assert itl([9, 10, 10], [0, 1, 1]) == 0.0


def test_itl_of_an_idle_team_counts_from_step_1() -> None:
    assert itl([0, 0, 0, 0, 3], [0, 0, 0, 0, 0]) == 3 / 4
    assert np.isnan(itl([NAN, NAN], [0, 1]))
    assert np.isnan(itl_level([0, 1], [NAN, NAN]))


def test_itl_takes_the_first_of_equal_steps_also_in_percent() -> None:
    # One item of 49 per step: in percent the increments differ in their last bits.
    counts = np.arange(50)
    percent = 100.0 * counts / 49
    assert np.argmax(np.diff(percent)) != 0
    assert itl(percent, counts) == 0.0


@pytest.mark.parametrize("metric", [itl, itl_level])
def test_itl_rejects(metric: Callable[..., Any]) -> None:
    with pytest.raises(ValueError, match="pad the shorter"):
        metric([0, 1, 2], [0, 1])
    with pytest.raises(ValueError, match="horizon 0"):
        metric([0], [0])
