"""All arrays that an object of ours holds, found by walking it, and which of them share memory."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.views import CachedViews

OURS = ("mjforage", "gymnasium")


def arrays(value: Any, path: str, met: dict[int, Any]) -> Iterator[tuple[str, NDArray[Any]]]:
    """All arrays that something of ours holds, by all names, but for what else was met before.

    Views that are lent (`CachedViews`) are made anew for whoever asks.
    """
    if isinstance(value, np.ndarray):
        yield path, value
    if id(value) in met or isinstance(value, np.ndarray | CachedViews):
        return
    met[id(value)] = value
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        yield from arrays(dict(zip(value._fields, value, strict=True)), path, met)
    elif isinstance(value, dict | list | tuple):
        for key, one in value.items() if isinstance(value, dict) else enumerate(value):
            yield from arrays(one, f"{path}/{key}", met)
    elif type(value).__module__.partition(".")[0] in OURS:
        slots = getattr(type(value), "__slots__", ())
        parts = getattr(value, "__dict__", {name: getattr(value, name) for name in slots})
        yield from arrays(dict(parts), path, met)


def memories(found: dict[str, NDArray[Any]]) -> list[list[str]]:
    """Who look at one piece of memory."""
    bounds = {path: np.lib.array_utils.byte_bounds(array) for path, array in found.items()}
    groups: list[list[str]] = []
    end = 0
    for path in sorted(bounds, key=lambda path: (bounds[path], path)):
        if found[path].size == 0:
            continue
        if bounds[path][0] >= end:
            groups.append([])
        groups[-1].append(path)
        end = max(end, bounds[path][1])
    return sorted(sorted(group) for group in groups)
