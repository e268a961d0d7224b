"""Threads of a launch: what each gives to the kernel."""

from types import SimpleNamespace
from typing import Any, NamedTuple, cast
from unittest.mock import patch

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base import device
from mjforage.base.device import Launch, OnDevice, kind_of
from mjforage.base.wholes import floor, rounded

Array = NDArray[np.float64]


class Sums(NamedTuple):
    """What a kernel adds up."""

    total: Array  # (episode,)
    weight: Array  # (item,)
    spare: Array  # (item,) memory


def _add(sums: Sums, values: Array, scale: float, ids: NDArray[np.int64]) -> None:
    """Weighted sums of the values of some episodes (episode, item)."""
    for e in ids:
        sums.spare[:] = 0.0
        sums.spare[:] += sums.weight * values[e]
        sums.total[e] += scale * sums.spare.sum()


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Arrays of the device are arrays of numpy."""
    monkeypatch.setattr(device, "SIMULATED", True)


def test_threads_have_their_episode_their_memory_and_what_all_share(simulated: None) -> None:
    rng = np.random.default_rng(0)
    sums, values = Sums(np.ones(4), rng.normal(size=3), np.ones(3)), rng.normal(size=(4, 3))
    launch, copies = Launch(_add, shared="weight", memory="sums.spare"), OnDevice()
    mask = np.array([True, False, True, True])
    given = launch.arguments(copies, 4, sums, values, 2.0, mask)
    assert given[0].spare.shape == (4, 3) and given[0].weight.shape == (3,)
    threads = SimpleNamespace(grid=None)
    with patch.object(device, "_cuda", lambda: threads):
        thread = launch.thread(*map(kind_of, given))
    for e in (5, 4, 3, 2, 1, 0):  # those beyond the batch have nothing to do
        threads.grid = lambda axes, e=e: e
        thread(4, given)
    wanted = Sums(np.ones(4), sums.weight, np.ones(3))
    _add(wanted, values, 2.0, np.flatnonzero(mask))
    np.testing.assert_array_equal(sums.total, 1.0)
    np.testing.assert_array_equal(copies.fetch(sums.total), wanted.total)


def test_copies_are_written_and_read(simulated: None) -> None:
    copies, array = OnDevice(), np.arange(3.0)
    copy = copies.of(array)
    array[0] = 5.0
    assert copies.of(array) is copy and copy[0] == 0.0
    copies.send(array)
    assert copy[0] == 5.0
    copy[1] = 7.0
    assert copies.fetch(array)[1] == 7.0


def test_rows_are_written_where_other_arrays_were(
    simulated: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the device has of other rows stays, whatever the host holds of them."""
    put = cast(Any, device.PUT_ROWS.kernel).py_func
    monkeypatch.setattr(device, "PUT_ROWS", lambda episodes, *arguments: put(*arguments))
    sums, values = Sums(np.ones(4), np.arange(3.0), np.ones(3)), np.ones((4, 3), np.int16)
    launch, before = Launch(_add, shared="weight", memory="sums.spare"), OnDevice()
    known = launch.arguments(before, 4, sums, values, 2.0, values)
    for copy in known[0][0], known[1]:
        copy[:] = 7
    rows = np.array([3, 1])
    others = Sums(np.arange(4.0), np.arange(3.0), np.ones(3)), np.zeros((4, 3), np.int16)
    found = launch.arguments(before.renewed(rows), 4, *others, 2.0, others[1])
    for one, other in zip((*known[0], known[1]), (*found[0], found[1]), strict=True):
        assert one is other
    np.testing.assert_array_equal(found[0].total, [7, 1, 7, 3])
    np.testing.assert_array_equal(found[1], [[7] * 3, [0] * 3] * 2)
    late = before.renewed(rows).renewed(np.array([0]))  # nothing is bound in between
    changed = Sums(np.full(4, 5.0), np.arange(3.0) + 1, np.ones(3)), others[1]
    again = launch.arguments(late, 4, *changed, 2.0, changed[1])
    np.testing.assert_array_equal(again[0].total, [5, 1, 7, 3])
    np.testing.assert_array_equal(again[0].weight, [1, 2, 3])
    with pytest.raises(ValueError, match=r"bound float64 \(5,\), before float64 \(4,\)"):
        late.renewed(rows).bound(np.zeros(5), False)


@pytest.mark.parametrize("value", [-1.5, -1.0, -0.25, 0.0, 0.75, 3.0, 1e9 + 0.5])
def test_floor_is_that_of_python(value: float) -> None:
    assert floor(value) == cast(Any, floor).py_func(value) == np.floor(value)


@pytest.mark.parametrize("value", [-2.5, -0.5, 0.49999999999999994, 0.5, 1.5, 1e14 + 0.5, np.inf])
def test_rounded_is_that_of_numpy(value: float) -> None:
    assert rounded(value) == cast(Any, rounded).py_func(value) == np.round(value)
