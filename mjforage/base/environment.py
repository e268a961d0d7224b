"""Environment variables of other people's libraries, which are to matter only where one is used."""

import importlib
import linecache
import os
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import takewhile
from traceback import walk_tb
from types import TracebackType
from typing import TextIO

from mjforage.base.errors import printable

_OURS = ("mjforage", "__main__")
_COUNT = re.compile(r"[A-Z]+_(NUM|MAX)_THREADS")
_COUNTS = re.compile(r"[1-9]\d{0,3}(,[1-9]\d{0,3})*")  # OpenMP takes one for each level


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


def drop_thread_counts() -> None:
    """Forget counts of threads that are none, which numba and polars refuse in many lines."""
    for name, value in list(os.environ.items()):
        if _COUNT.fullmatch(name) and not _COUNTS.fullmatch(value):
            del os.environ[name]


def shorten_warnings() -> None:
    """Tell warnings in their first line, as some libraries put a whole traceback into one."""
    warnings.showwarning = _show_warning


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    if stream := file or sys.stderr:
        first = str(message).strip().partition("\n")[0]
        stream.write(f"{category.__name__}: {printable(first)}\n")


def library_of(error: BaseException) -> str:
    """Name of the package from outside that raised an error; "" if we or Python did."""
    places = _places(error.__traceback__)
    return places[-1][0] if places and places[-1][0] not in _OURS else ""


def refusal(error: BaseException) -> str:
    """What is said of an error by which a library refuses variables that are set.

    A variable is meant if the message or the line that raised has its name, or if that begins with
    the library's and the library was being imported, or gave up altogether.

    Returns
    -------
    variables, values and remedy in one line; "" if none of them seems to be the reason
    """
    library = library_of(error)
    if not library:
        return ""
    places = _places(error.__traceback__)
    outside = takewhile(lambda place: place[0] not in _OURS, reversed(places))
    importing = any(function == "<module>" for _, function, _ in outside)
    told = re.findall(r"[A-Z][A-Z0-9_]+", f"{error} {places[-1][2]}")
    if isinstance(error, Warning):
        told.append("PYTHONWARNINGS")
    if importing or not isinstance(error, Exception):  # such as a panic of polars
        told += [name for name in os.environ if name.startswith(f"{library.upper()}_")]
    names = sorted({name for name in told if os.environ.get(name)})
    if not names:
        return ""
    settings = ", ".join(f"{name}={os.environ[name]}" for name in names)
    these = "it or give a value that it takes" if len(names) == 1 else "what is wrong of these"
    reason = str(error).strip().partition("\n")[0]
    return f"{settings}: {library} fails ({reason}); unset {these}"


def _places(trace: TracebackType | None) -> list[tuple[str, str, str]]:
    """Package, function and line of each frame that is not Python's own, the outermost first."""
    return [
        (package, frame.f_code.co_name, linecache.getline(frame.f_code.co_filename, line))
        for frame, line in walk_tb(trace)
        if (package := frame.f_globals.get("__name__", "").partition(".")[0])
        and package not in sys.stdlib_module_names
    ]
