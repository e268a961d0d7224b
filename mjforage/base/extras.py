"""Optional libraries: the extra of mjforage that installs each, and messages that name it.

A base installation evaluates, compares and reports. What trains, films or computes on a cluster
asks here for its library at its door.
"""

import importlib.util
import re
from importlib.metadata import requires

from mjforage.base.errors import UserError

_DISTRIBUTIONS = {"opengl": "pyopengl"}
"""Distributions that go by another name than what they let one import."""


def require(what: str, *modules: str) -> None:
    """Refuse to go on without a library.

    Raises `UserError` if one is not installed; it names the extra that brings it.

    Parameters
    ----------
    what : that needs it, for the message
    modules : names of top-level modules; nothing is imported
    """
    for module in modules:
        if importlib.util.find_spec(module) is None:
            raise UserError(f"{what}: needs {module}; {how_to_install(module)}")


def how_to_install(module: str) -> str:
    """The remedy for a module that is not installed."""
    extra = extra_with(module)
    return f"install it with pip install 'mjforage[{extra}]'" if extra else "install it"


def extra_with(module: str) -> str:
    """The extra of mjforage that brings a module, by the name of its distribution; "" if none.

    Of several the smallest.
    """
    wanted = _normal(module.partition(".")[0])
    wanted = _DISTRIBUTIONS.get(wanted, wanted)
    extras: dict[str, set[str]] = {}
    for text in requires("mjforage") or ():
        name = re.match(r"[\w.-]+", text)
        extra = re.search(r"""extra == ["']([\w-]+)["']""", text)
        if name and extra:
            extras.setdefault(extra[1], set()).add(_normal(name[0]))
    found = [extra for extra, names in extras.items() if wanted in names]
    return min(found, key=lambda extra: len(extras[extra]), default="")


def _normal(name: str) -> str:
    return name.replace("_", "-").lower()
