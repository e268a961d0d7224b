"""The one place of this package where numba is configured."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core.caching import FunctionCache

F = TypeVar("F", bound=Callable[..., object])


def _stamp() -> str:
    """Changes whenever a source file of this package does: kernels call kernels of other files."""
    files = sorted(Path(__file__).resolve().parent.rglob("*.py"))
    found = [(file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files]
    return hashlib.sha256(repr(found).encode()).hexdigest()


_STAMP = _stamp()  # taken before any other file of this package is read


class _Cache(FunctionCache):
    """numba's disk cache, which by itself knows the kernel's own file only.

    The sources' hash stands at the head of an index, before what names their classes, and in the
    names of its files: whatever older sources left is never read.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        index: Any = self._cache_file
        index._version = f"{index._version} {_STAMP}"
        head, _, number = index._data_name_pattern.rpartition(".{number")
        index._data_name_pattern = f"{head}.{_STAMP[:12]}.{{number{number}"


def kernel(function: F) -> F:
    """Compile `function` in nopython mode, cached on disk.

    No fast-math: sums keep their order, so a result never depends on the batch it is in.
    """
    dispatcher = cast(Any, numba).njit(fastmath=False, nogil=True)(function)
    dispatcher._cache = _Cache(dispatcher.py_func)
    return cast(F, dispatcher)
