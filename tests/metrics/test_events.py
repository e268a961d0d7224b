"""The event table accepts what can have happened and names what cannot."""

from typing import Any

import numpy as np
import pytest

from mjforage.metrics import EventTable, counts_by_step

NAN = np.nan


def columns(**changed: Any) -> dict[str, Any]:
    """Three items: fetched, only seen, untouched; plus one of padding."""
    table: dict[str, Any] = {
        "discovered_at": np.array([2.0, 5.0, NAN, NAN]),
        "discovered_by": np.array([0, 1, -1, -1]),
        "collected_at": np.array([4.0, NAN, NAN, NAN]),
        "collected_by": np.array([2, -1, -1, -1]),
        "exists": np.array([True, True, True, False]),
    }
    return table | changed


def test_valid_table_keeps_its_values_and_cannot_be_written() -> None:
    given_columns = columns()
    events = EventTable(**given_columns)
    for name, column in given_columns.items():
        np.testing.assert_array_equal(getattr(events, name), column)
        with pytest.raises(ValueError, match="read-only"):
            getattr(events, name)[0] = 1
        with pytest.raises(ValueError, match="cannot set WRITEABLE"):
            getattr(events, name).setflags(write=True)
    given_columns["collected_at"][0] = 99.0
    assert events.collected_at[0] == 4.0


def test_no_items_at_all_is_valid() -> None:
    empty = np.zeros((2, 0))
    whole = empty.astype(np.int64)
    events = EventTable(empty, whole, empty, whole, empty.astype(bool))
    np.testing.assert_array_equal(counts_by_step(events.collected_at, 3), np.zeros((2, 4)))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"discovered_at": np.array([2.0, 5.0, NAN])}, r"exists has shape \(4,\) but discovered"),
        ({"collected_by": np.array([2, -1])}, "collected_by"),
        ({"exists": np.array([1, 1, 1, 0])}, "booleans"),
        ({"discovered_at": np.array([-1.0, 5.0, NAN, NAN])}, r"discovered_at\[0\] is -1.0"),
        ({"collected_at": np.array([np.inf, NAN, NAN, NAN])}, r"collected_at\[0\] is inf"),
        ({"discovered_by": np.array([0.0, 1.0, -1.0, -1.0])}, "float64; integers"),
        ({"discovered_by": np.array([0, 1, -1, -2])}, "agent -2 is unknown"),
        ({"discovered_by": np.array([0, 1, 3, -1])}, r"item \[2\]: discovered_at is nan but"),
        ({"collected_by": np.array([-1, -1, -1, -1])}, r"item \[0\]: collected_at is 4.0 but"),
        ({"collected_at": np.array([1.0, NAN, NAN, NAN])}, "collected at 1.0 but discovered at 2"),
        (
            {
                "collected_at": np.array([4.0, NAN, 6.0, NAN]),
                "collected_by": np.array([2, -1, 2, -1]),
            },
            r"item \[2\] is collected at 6.0 but discovered at nan",
        ),
        ({"exists": np.array([False, True, True, False])}, "does not exist"),
    ],
)
def test_impossible_table_is_rejected(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        EventTable(**columns(**changed))


def test_single_numbers_are_rejected() -> None:
    with pytest.raises(ValueError, match="not one number"):
        EventTable(**columns(discovered_at=np.float64(2.0)))


def test_counts_by_hand() -> None:
    # Events at 0, 2, 2, 2.5 and 7 with T = 4: 1 until t = 1, 3 at 2, 2.5 counts from 3 on.
    times = [0.0, 2.0, 2.0, 2.5, 7.0, NAN]
    np.testing.assert_array_equal(counts_by_step(times, 4), [1, 1, 3, 4, 4])


@pytest.mark.parametrize(("times", "horizon"), [([1.0], 0), ([-1.0], 3), (np.float64(1.0), 3)])
def test_counts_reject(times: Any, horizon: int) -> None:
    with pytest.raises(ValueError, match=r"needed|NaN for never"):
        counts_by_step(times, horizon)
