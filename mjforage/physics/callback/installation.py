"""Putting the callback in place, and saying which route it takes.

The native pointer stays in place. A Python callback is in place only inside `calling()`: while it
is, MuJoCo can compile no model, ours or other people's.
"""

import contextlib
import logging
from collections.abc import Iterator
from enum import Enum

import mujoco
from numba.core.errors import NumbaError

from mjforage.base.errors import UserError
from mjforage.physics.callback.interpreted import python_callback
from mjforage.physics.callback.native import native_callback
from mjforage.physics.callback.self_test import failure, toy_model
from mjforage.physics.callback.structs import StructError

logger = logging.getLogger(__name__)


class Route(Enum):
    """How MuJoCo reaches the forces."""

    NATIVE = "native"
    PYTHON = "python"


_installed: Route | None = None


def installed() -> Route | None:
    """The route in place, or None."""
    return _installed


def install(route: Route | None = None) -> Route:
    """Choose the route of this process and put the native callback in place; return the route.

    Parameters
    ----------
    route : None for the route already chosen; at first the native one, or the Python one where the
        native one fails

    Raises
    ------
    UserError
        If someone else's passive callback is in place, or if no route works.
    """
    global _installed
    if _installed is not None and route in (None, _installed):
        return _installed
    uninstall()
    if mujoco.get_mjcb_passive() is not None:
        raise UserError(
            "another passive callback is installed in this process; clear it with "
            "mujoco.set_mjcb_passive(None) before using mjforage's physics"
        )
    chosen = Route.NATIVE if route is None else route
    problem = _problem(chosen)
    if problem and route is None:
        logger.warning("native MuJoCo callback: %s; a slower Python callback takes over", problem)
        chosen = Route.PYTHON
        problem = _problem(chosen)
    if problem:
        raise UserError(
            f"{chosen.value} MuJoCo callback: {problem}; MuJoCo {mujoco.__version__} is not "
            "supported, install one of >=3.17,<5"
        )
    if chosen is Route.NATIVE:
        mujoco.set_mjcb_passive(native_callback().ctypes)
    _installed = chosen
    return chosen


def uninstall() -> None:
    """Take the callback away; does nothing if it is not ours."""
    global _installed
    if _installed is Route.NATIVE:
        mujoco.set_mjcb_passive(None)
    _installed = None


@contextlib.contextmanager
def calling() -> Iterator[None]:
    """Within it, stepping a model of ours calls our forces, whatever the route.

    Raises
    ------
    UserError
        As `install`.
    """
    if install() is Route.NATIVE:
        if mujoco.get_mjcb_passive() is None:  # cleared by someone since
            mujoco.set_mjcb_passive(native_callback().ctypes)
        yield
        return
    mujoco.set_mjcb_passive(python_callback)
    try:
        yield
    finally:
        mujoco.set_mjcb_passive(None)


def _problem(route: Route) -> str | None:
    """Try a route on the toy model; the problem, or None. Leaves no callback in place."""
    toy = toy_model()
    try:
        callback = native_callback().ctypes if route is Route.NATIVE else python_callback
        mujoco.set_mjcb_passive(callback)
        return failure(toy)
    except (StructError, OSError, AttributeError, NumbaError) as error:
        return str(error).splitlines()[0]
    finally:
        mujoco.set_mjcb_passive(None)
