"""MuJoCo's warnings: not printed, but counted and made errors.

MuJoCo puts an unstable state back to the start and goes on.
"""

import contextlib
import threading
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np
from numba import cfunc, types
from numpy.typing import NDArray

from mjforage.base.errors import UserError

COUNT, INFO = 1, 0  # last axis of Batch.warning
_WARNINGS = mujoco.mjtWarning
UNSTABLE = (
    int(_WARNINGS.mjWARN_BADQPOS),
    int(_WARNINGS.mjWARN_BADQVEL),
    int(_WARNINGS.mjWARN_BADQACC),
)


class InstabilityError(UserError):
    """A simulation became unstable or ran out of memory; names seed, time, body and remedy."""


def check_warnings(
    model: mujoco.MjModel,
    warnings: NDArray[np.int32],
    ids: NDArray[np.intp],
    seeds: Sequence[int | str],
    time_s: NDArray[np.float64],
) -> None:
    """Fail if a simulation has a MuJoCo warning.

    Raises `InstabilityError`, naming the first such simulation.

    Parameters
    ----------
    model : the scene's
    warnings : (simulation, kind, 2) counters as in `mujoco.batch.Batch.warning`
    ids : simulations that were stepped
    seeds, time_s : (simulation,) names of the runs, and the time they had reached before the step
    """
    if not warnings[..., COUNT].any():
        return
    risen = ids[warnings[ids, :, COUNT].any(axis=1)]
    if not risen.size:
        return
    sim = int(risen[0])
    kind = int(np.argmax(warnings[sim, :, COUNT] > 0))
    label = _WARNINGS(kind).name.removeprefix("mjWARN_")
    where = f"seed {seeds[sim]}, t = {time_s[sim]:.2f} s"
    if kind in UNSTABLE:
        body = model.body(int(model.dof_bodyid[warnings[sim, kind, INFO]])).name.split("/")[0]
        raise InstabilityError(
            f"physics: unstable at {where}, body {body} ({label}); take a smaller time step, or "
            "check the vessel's parameters and commands"
        )
    raise InstabilityError(
        f"physics: MuJoCo warning {label} at {where}; use fewer items or vessels"
    )


@lru_cache(maxsize=1)
def _silent_handler() -> Any:
    """A warning handler that does nothing, without the GIL."""

    def ignore(_: int) -> None:
        return

    return cfunc(types.void(types.uintp))(ignore)


_lock = threading.Lock()
_handlers: list[Any] = []  # the one before the first of those in the context, once for each


@contextlib.contextmanager
def warnings_suppressed() -> Iterator[None]:
    """Context in which MuJoCo counts warnings, and writes neither them nor MUJOCO_LOG.TXT.

    It may be entered again, and by several threads: the last to leave puts back what was before.
    """
    with _lock:
        if not _handlers:
            _handlers.append(mujoco.get_mju_user_warning())
            mujoco.set_mju_user_warning(_silent_handler().ctypes)
        else:
            _handlers.append(_handlers[0])
    try:
        yield
    finally:
        with _lock:
            before = _handlers.pop()
            if not _handlers:
                mujoco.set_mju_user_warning(before)
