"""Compiled kernels must follow the sources of everything that they call."""

import copy
import importlib
import pickle
import subprocess
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

from graph_planner import compiled
from graph_planner.compiled import compiling, kernel, prepared


class Pair(NamedTuple):
    factor: NDArray[np.float64]
    offset: float


CALLER = """
from graph_planner.compiled import kernel
from flotilla.helm import rudder

@kernel
def steer(x: float) -> float:
    return rudder(x) + 1.0
"""
HELM = """
from graph_planner.compiled import {decorator}

@{decorator}
def rudder(x: float) -> float:
    return {factor} * x
"""
ASK = (
    "from flotilla.steering import steer; print(steer(10.0), sum(steer.stats.cache_hits.values()))"
)


def printed(program: str, folder: Path) -> str:
    command = [sys.executable, "-c", program]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def ask(folder: Path) -> list[float]:
    return [float(word) for word in printed(ASK, folder).split()]


def test_a_kernel_is_compiled_again_when_a_file_that_it_calls_changes(tmp_path: Path) -> None:
    package = tmp_path / "flotilla"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "steering.py").write_text(CALLER)
    for decorator in ("kernel", "inlined"):
        (package / "helm.py").write_text(HELM.format(decorator=decorator, factor=2.0))
        assert ask(tmp_path) == [21.0, 0.0]
        assert ask(tmp_path) == [21.0, 1.0]  # unchanged: taken from the disk
        (package / "helm.py").write_text(HELM.format(decorator=decorator, factor=3.25))
        assert ask(tmp_path) == [33.5, 0.0]


NAMED = """
from typing import NamedTuple
from graph_planner.compiled import kernel

class {name}(NamedTuple):
    x: float

@kernel
def steer(of: {name}) -> float:
    return of.x + 1.0
"""


def test_a_class_that_is_no_more_spoils_no_cache(tmp_path: Path) -> None:
    package = tmp_path / "flotilla"
    package.mkdir()
    (package / "__init__.py").touch()
    for name in ("Crew", "Fleet"):
        (package / "steering.py").write_text(NAMED.format(name=name))
        program = f"from flotilla import steering as s; print(s.steer(s.{name}(2.0)))"
        done = subprocess.run(
            [sys.executable, "-c", program],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stdout == "3.0\n"


@kernel
def _scale(by: Pair, values: NDArray[np.float64]) -> float:
    for i in range(values.size):
        values[i] = by.factor[i] * values[i] + by.offset
    return float(values.sum())


def test_a_prepared_kernel_keeps_its_first_arguments_and_sees_what_becomes_of_them() -> None:
    factor = np.array([2.0, 3.0])
    scale = prepared(_scale, Pair(factor, 1.0))
    first, second = np.ones(2), np.array([1.0, 10.0])
    assert scale(first) == 3.0 + 4.0  # compiles
    assert scale(second) == 3.0 + 31.0  # goes straight to the compiled code
    factor[:] = 0.0
    assert scale(second) == 2.0
    assert first.tolist() == [3.0, 4.0]
    assert second.tolist() == [1.0, 1.0]


def test_a_prepared_kernel_passes_errors_on() -> None:
    fails = prepared(_fail)
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
    scale = prepared(_scale, Pair(factor, 1.0))
    scale(np.ones(2))
    for again in (copy.deepcopy(scale), pickle.loads(pickle.dumps(scale))):  # noqa: S301  ours
        factor[:] = 0.0
        assert again(np.ones(2)) == 3.0 + 4.0
        assert scale(np.ones(2)) == 2.0
        factor[:] = 2.0, 3.0


def test_a_pickled_kernel_is_looked_up_in_its_module(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that it is the one of that process, which the disk has compiled."""
    sent = pickle.dumps(prepared(_scale, Pair(np.ones(1), 1.0)))
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
        assert prepared(_in_order, values)(by) == expected


def test_what_may_not_be_written_is_not_by_another_s_code() -> None:
    mine, theirs = np.ones(2), np.ones(2)
    theirs.flags.writeable = False
    prepared(_zero, mine)()
    with pytest.raises(TypingError):
        prepared(_zero, theirs)()
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
        assert prepared(_height)(Rise(1.0, 3.0)) == 2.0
        assert prepared(_height)(Fall(1.0, 3.0)) == -2.0
        assert prepared(_depth)(Rise(1.0, 3.0)) == -2.0


def test_prepared_kernels_look_into_tuples() -> None:
    whole = np.array([2, 3])
    factors: list[NDArray[Any]] = [whole.astype(np.float64), whole.astype(np.float32), whole]
    for factor in factors:
        assert prepared(_scale, Pair(factor, 1.0))(np.ones(2)) == 7.0


class Heard(event.Listener):
    """What `compiling` says whenever numba begins to compile."""

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
from {package} import kernel

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


@pytest.fixture(params=["graph_planner.compiled", "controllers._compiled"])
def kernels(
    tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Any]:
    """Return a module of kernels that is new, so that no disk has them compiled."""
    (tmp_path / "new_kernels.py").write_text(KERNELS.format(package=request.param))
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


@pytest.mark.parametrize("package", ["graph_planner.compiled", "controllers._compiled"])
def test_what_kernels_call_has_a_dispatcher_once_one_is_compiled(
    package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process that finds all on the disk makes none of these, nor waits for it."""
    bare, njit = [], numba.njit

    def noted(**options: Any) -> Any:
        bare.append(options["no_cpython_wrapper"])
        return njit(**options)

    monkeypatch.setattr(numba, "njit", noted)
    make: Any = importlib.import_module(package).kernel
    called: Any = make(lambda x: x + 1)
    calling: Any = make(lambda x: called(x) + called(2 * x))
    assert bare == [False, False]
    assert called(1) == 2 and bare == [False, False]
    assert calling(1) == 5 and bare == [False, False, True]


def test_a_kernel_may_call_itself(kernels: Any) -> None:
    assert kernels.above(4) == 25
    assert kernels.factorial(5) == 120


def test_kernels_are_compiled_again_when_those_of_controllers_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Kernels of mjforage call them."""
    for package in ("graph_planner", "controllers", "mjforage"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "chart.py").write_text("one = 1\n")
    monkeypatch.setattr(compiled, "_HERE", tmp_path / "graph_planner")
    stamps = set()
    for package in ("mjforage", "controllers", "graph_planner"):
        stamps.add(compiled._stamp.__wrapped__(tmp_path / "mjforage"))
        (tmp_path / package / "chart.py").write_text("two = 20\n")
    stamps.add(compiled._stamp.__wrapped__(tmp_path / "mjforage"))
    assert len(stamps) == 4
