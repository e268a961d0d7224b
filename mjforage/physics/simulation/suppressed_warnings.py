"""Suppression of MuJoCo's warnings and MUJOCO_LOG.TXT, since counters are checked."""

import contextlib
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import mujoco
from numba import cfunc, types


@lru_cache(maxsize=1)
def _no_words() -> Any:
    """A warning handler that does nothing, without the GIL."""

    def ignore(_: int) -> None:
        return

    return cfunc(types.void(types.uintp))(ignore)


@contextlib.contextmanager
def warnings_suppressed() -> Iterator[None]:
    """Context in which MuJoCo counts warnings and prints nothing."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(_no_words().ctypes)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
