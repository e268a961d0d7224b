"""Kernels of a control tick on a GPU: they compile for one, and each thread has its episode."""

import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import SimpleNamespace
from typing import Any, cast
from unittest.mock import patch

import pytest
from numba.core import types

from mjforage.base.compiled import _writable
from mjforage.base.device import Launch, names_of, require_gpu
from mjforage.base.errors import UserError
from tests.mjforage.physics.dynamics.device_kernels import LAUNCHES, fly

CAPABILITY = (9, 0)  # of an H100 and an H200


def test_simulated_threads_give_what_the_kernels_give() -> None:
    """Bit for bit: numba's simulator calls the kernels of the processor."""
    pytest.importorskip("numba_cuda")
    command = [sys.executable, "-m", "tests.mjforage.physics.dynamics.repeated_on_device"]
    simulated = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
    found = subprocess.run(command, env=simulated, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr[-2000:]
    assert found.stdout.split() == sorted(LAUNCHES)


@pytest.fixture(scope="module")
def flown() -> None:
    """Every kernel has been called, and so knows the types of its arguments."""
    fly()


@pytest.mark.parametrize("name", LAUNCHES)
def test_it_compiles_for_a_gpu(name: str, flown: None) -> None:
    """To PTX for an H100, without a driver."""
    pytest.importorskip("numba_cuda")
    pathfinder: Any = importlib.import_module("cuda.pathfinder")
    try:
        pathfinder.load_nvidia_dynamic_lib("nvvm")
    except pathfinder.DynamicLibNotFoundError:
        pytest.skip("no NVVM: pip install nvidia-nvvm")
    launch = LAUNCHES[name]
    given = next(iter(cast(Any, launch.kernel).overloads))
    arguments = [_moved(launch, *each) for each in zip(names_of(launch.kernel), given, strict=True)]
    thread = launch.thread(*map(_kind, arguments))
    kinds = cast(Any, types)
    with _without_a_driver():
        text, _ = importlib.import_module("numba.cuda").compile_ptx(
            thread, (kinds.int64, kinds.Tuple(arguments)), cc=CAPABILITY, opt=False
        )
    assert ".target sm_90" in text and ".entry" in text


def test_without_a_gpu_there_is_one_line() -> None:
    """Libraries or card missing."""
    with (
        patch("numba.cuda.is_available", lambda: False),
        pytest.raises(UserError, match=r"^bench --device: .*GPU|numba_cuda"),
    ):
        require_gpu("bench --device")


@contextmanager
def _without_a_driver() -> Iterator[None]:
    """Have numba-cuda compile for a card that is not there, with NVVM alone."""
    card = SimpleNamespace(compute_capability=CAPABILITY)
    with ExitStack() as patches:
        told = {"NUMBA_FORCE_CUDA_CC": ".".join(map(str, CAPABILITY))}
        patches.enter_context(patch.dict(os.environ, told))  # for numba reads it anew at times
        patches.enter_context(patch("numba.cuda.config.FORCE_CUDA_CC", CAPABILITY))
        patches.enter_context(patch("numba.cuda.cuda_paths._get_nvrtc_path", lambda: None))
        patches.enter_context(patch("numba.cuda.dispatcher.get_current_device", lambda: card))
        yield


def _moved(launch: Launch, name: str, kind: Any) -> Any:
    """The type of an argument on the device, by that on the processor."""
    kinds = cast(Any, types)
    if isinstance(kind, kinds.BaseTuple):
        fields = getattr(kind, "fields", range(len(kind)))
        parts = [
            _moved(launch, f"{name}.{field}", part)
            for field, part in zip(fields, kind, strict=True)
        ]
        return kinds.BaseTuple.from_types(parts, getattr(kind, "instance_class", None))
    if not isinstance(kind, kinds.Array):
        return kinds.unliteral(kind)
    if name == "ids":
        return kinds.Array(kinds.boolean, 1, "C")
    return _writable(kind).copy(layout="C", ndim=kind.ndim + launch.is_memory(name))


def _kind(of: Any) -> Any:
    """The kind of a type, as `kind_of` has it of a value."""
    kinds = cast(Any, types)
    if isinstance(of, kinds.BaseTuple):
        return (getattr(of, "instance_class", tuple), *map(_kind, of))
    return "array" if isinstance(of, kinds.Array) else "number"
