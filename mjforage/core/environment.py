"""Environment variables of other people's libraries, which are to matter only where one is used."""

import importlib
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress


def mujoco_despite(variable: str = "MUJOCO_GL") -> None:
    """Import MuJoCo, which refuses to be imported with a variable of another machine.

    The variable stays for whoever draws. Without one nothing is imported.
    """
    if not os.environ.get(variable) or "mujoco" in sys.modules:
        return
    before = dict(os.environ)
    try:
        importlib.import_module("mujoco")
    except Exception:  # noqa: BLE001  whatever the library says that it should draw with
        with _aside(variable):
            importlib.import_module("mujoco")
        for name in os.environ.keys() - before.keys():  # it sets others on its way
            del os.environ[name]


def matplotlib_despite(variable: str = "MPLBACKEND") -> None:
    """Import matplotlib, which refuses to be imported with a backend of a notebook elsewhere.

    One that is there is chosen as ever. Without the variable nothing is imported.
    """
    backend = os.environ.get(variable)
    if not backend or "matplotlib" in sys.modules:
        return
    with _aside(variable):
        settings = importlib.import_module("matplotlib").rcParams
    with suppress(ValueError):
        settings["backend"] = backend


@contextmanager
def _aside(variable: str) -> Iterator[None]:
    """Without a variable within the block."""
    value = os.environ.pop(variable)
    try:
        yield
    finally:
        os.environ[variable] = value
