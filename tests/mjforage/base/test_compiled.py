"""Kernels: compiled for Python and for one another, prepared for quick calls, kept on disk."""

import copy
import importlib
import pickle
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numba.core import event
from numba.core.errors import TypingError
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, compiling, kernel


class Pair(NamedTuple):
    factor: NDArray[np.float64]
    offset: float


@kernel
def _scale(by: Pair, values: NDArray[np.float64]) -> float:
    for i in range(values.size):
        values[i] = by.factor[i] * values[i] + by.offset
    return float(values.sum())


def test_a_prepared_kernel_keeps_its_first_arguments_and_sees_what_becomes_of_them() -> None:
    factor = np.array([2.0, 3.0])
    scale = BoundKernel(_scale, Pair(factor, 1.0))
    first, second = np.ones(2), np.array([1.0, 10.0])
    assert scale(first) == 3.0 + 4.0  # compiles
    assert scale(second) == 3.0 + 31.0  # goes straight to the compiled code
    factor[:] = 0.0
    assert scale(second) == 2.0
    assert first.tolist() == [3.0, 4.0]
    assert second.tolist() == [1.0, 1.0]


def test_a_prepared_kernel_passes_errors_on() -> None:
    fails = BoundKernel(_fail)
    for _ in range(2):
        with pytest.raises(ValueError, match="no number"):
            fails(1)


@kernel
def _fail(number: int) -> int:
    if number > 0:
        raise ValueError("no number")
    return number


def test_a_copy_of_a_prepared_kernel_has_arguments_of_its_own() -> None:
    factor = np.array([2.0, 3.0])
    scale = BoundKernel(_scale, Pair(factor, 1.0))
    scale(np.ones(2))
    for again in (copy.deepcopy(scale), pickle.loads(pickle.dumps(scale))):  # noqa: S301  ours
        factor[:] = 0.0
        assert again(np.ones(2)) == 3.0 + 4.0
        assert scale(np.ones(2)) == 2.0
        factor[:] = 2.0, 3.0


def test_a_pickled_kernel_is_looked_up_in_its_module(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that it is the one of that process, which the disk has compiled."""
    sent = pickle.dumps(BoundKernel(_scale, Pair(np.ones(1), 1.0)))
    monkeypatch.setattr(sys.modules[__name__], "_scale", lambda by, values: -1.0)
    assert pickle.loads(sent)(np.ones(1)) == -1.0  # noqa: S301  ours


@kernel
def _in_order(values: NDArray[np.float64], by: Pair) -> float:
    total = by.offset
    for place, value in enumerate(values.flat):
        total += (place + 1) * value
    return float(total)


@kernel
def _zero(values: NDArray[np.float64]) -> None:
    values[0] = 0.0


def test_prepared_kernels_take_every_place_of_arrays_of_other_types_and_layouts() -> None:
    by, wide = Pair(np.ones(1), 0.5), np.arange(12.0).reshape(3, 4)
    kinds: tuple[NDArray[Any], ...] = (
        *(wide, np.asfortranarray(wide), wide[:, ::2], wide[0], wide[0, ::2], wide[None]),
        *(wide.astype(np.float32), wide.astype(np.int64)),
    )
    for values in kinds + kinds:
        expected = 0.5 + float(np.arange(1, values.size + 1) @ values.ravel())
        assert BoundKernel(_in_order, values)(by) == expected


def test_what_may_not_be_written_is_not_by_another_s_code() -> None:
    mine, theirs = np.ones(2), np.ones(2)
    theirs.flags.writeable = False
    BoundKernel(_zero, mine)()
    with pytest.raises(TypingError):
        BoundKernel(_zero, theirs)()
    assert theirs[0] == 1.0


class Rise(NamedTuple):
    low: float
    high: float


class Fall(NamedTuple):
    high: float
    low: float


@kernel
def _height(of: Rise | Fall) -> float:
    return of.high - of.low


@kernel
def _depth(of: Rise | Fall) -> float:
    return of.low - of.high


def test_prepared_kernels_tell_named_tuples_and_kernels_apart() -> None:
    for _ in range(2):
        assert BoundKernel(_height)(Rise(1.0, 3.0)) == 2.0
        assert BoundKernel(_height)(Fall(1.0, 3.0)) == -2.0
        assert BoundKernel(_depth)(Rise(1.0, 3.0)) == -2.0


class Heard(event.Listener):
    """Answers of `compiling` whenever numba begins to compile."""

    def __init__(self) -> None:
        self.said: list[bool] = []

    def on_start(self, event: event.Event) -> None:
        self.said.append(compiling())

    def on_end(self, event: event.Event) -> None:
        pass


def test_it_is_known_whether_a_kernel_is_being_compiled() -> None:
    def more(x: float) -> float:
        return x + 1.0

    nowhere_else: Any = numba.njit(more)  # the disk does not keep it: compiled in every run
    heard = Heard()
    with event.install_listener("numba:compile", heard):
        assert not compiling() and nowhere_else(1.0) == 2.0
        assert heard.said == [True] and not compiling()
        assert nowhere_else(2.0) == 3.0 and heard.said == [True]


class Compiled(event.Listener):
    """Names of what numba compiles, and whether Python can call it."""

    def __init__(self) -> None:
        self.kernels: list[tuple[str, bool]] = []

    def on_start(self, event: event.Event) -> None:
        dispatcher = event.data["dispatcher"]
        bare = bool(dispatcher.targetoptions.get("no_cpython_wrapper"))
        self.kernels.append((dispatcher.py_func.__name__, not bare))

    def on_end(self, event: event.Event) -> None:
        pass


KERNELS = """
from mjforage.base.compiled import kernel

@kernel
def doubled(x):
    return 2 * x

@kernel
def total(x):
    return doubled(1) + doubled(x) + doubled(x=-3)

@kernel
def factorial(n):
    return 1 if n < 2 else n * factorial(n - 1)

@kernel
def above(n):
    return factorial(n) + 1
"""


@pytest.fixture
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Return a module of kernels that no disk has compiled."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    (tmp_path / "new_kernels.py").write_text(KERNELS)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("new_kernels")
    del sys.modules["new_kernels"]


def test_kernels_that_kernels_call_are_compiled_once_for_all_numbers_and_not_for_python(
    kernels: Any,
) -> None:
    heard = Compiled()
    with event.install_listener("numba:compile", heard):
        assert kernels.total(5) == 2 + 10 - 6
        assert heard.kernels == [("total", True), ("doubled", False)]
        assert kernels.doubled(4) == 8, "Python calls it too, by a compilation of its own"
        assert heard.kernels[2:] == [("doubled", True)]


def test_a_kernel_may_call_itself(kernels: Any) -> None:
    assert kernels.above(4) == 25
    assert kernels.factorial(5) == 120
