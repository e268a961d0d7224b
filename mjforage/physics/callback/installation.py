"""Putting the compiled callback in place, once it has proved itself on a toy model."""

import mujoco
from numba.core.errors import NumbaError

from mjforage.base.errors import UserError
from mjforage.physics.callback.native import native_callback
from mjforage.physics.callback.self_test import failure, toy_model
from mjforage.physics.callback.structs import StructError

_proved = False


def install() -> None:
    """Put the callback in place, also where someone has cleared it since.

    Raises `UserError` if someone else's passive callback is in place, or ours does not work with
    this MuJoCo.
    """
    global _proved
    if mujoco.get_mjcb_passive() is not None:
        if _proved:
            return
        raise UserError(
            "another passive callback is installed in this process; clear it with "
            "mujoco.set_mjcb_passive(None) before using mjforage's physics"
        )
    if problem := _problem():
        mujoco.set_mjcb_passive(None)
        raise UserError(
            f"MuJoCo callback: {problem}; MuJoCo {mujoco.__version__} is not supported, install "
            "one of >=3.17,<5"
        )
    _proved = True


def _problem() -> str | None:
    """Set the callback and, the first time, test it; the problem, or None."""
    try:
        toy = None if _proved else toy_model()
        mujoco.set_mjcb_passive(native_callback().ctypes)
        return failure(toy) if toy is not None else None
    except (StructError, OSError, AttributeError, NumbaError) as error:
        return str(error).splitlines()[0]
