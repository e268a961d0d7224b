"""Errors by which other libraries refuse environment variables."""

import linecache
import os
import re
import sys
from itertools import takewhile
from traceback import walk_tb
from types import TracebackType

_OURS = ("mjforage", "__main__")


def library_of(error: BaseException) -> str:
    """Name of the package from outside that raised an error; "" if we or Python did."""
    places = _places(error.__traceback__)
    return places[-1][0] if places and places[-1][0] not in _OURS else ""


def refusal(error: BaseException) -> str:
    """Message of a library that refuses environment variables.

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
    named = re.findall(r"[A-Z][A-Z0-9_]+", f"{error} {places[-1][2]}")
    if isinstance(error, Warning):
        named.append("PYTHONWARNINGS")
    if importing or not isinstance(error, Exception):  # such as a panic of polars
        named += [name for name in os.environ if name.startswith(f"{library.upper()}_")]
    names = sorted({name for name in named if os.environ.get(name)})
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
