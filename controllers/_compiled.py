"""The one place of this package where numba is configured.

What caches and compiles is as in `graph_planner/compiled.py`, which this package does not know, nor
that this one: neither may import the other, and one test holds both to the same.
"""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import types
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

    def __init__(self, function: Callable[..., object], bare: bool) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        index: Any = self._cache_file
        index._version = f"{index._version} {_STAMP}"
        head, _, number = index._data_name_pattern.rpartition(".{number")
        index._data_name_pattern = f"{head}.{_STAMP[:12]}{'.bare' * bare}.{{number{number}"
        if bare:
            index._index_path = index._index_path.removesuffix(".nbi") + ".bare.nbi"


def _with_bare(outer: Any, made: Callable[[], Any]) -> None:
    """Have other kernels call a compilation of their own, one for all values of an argument.

    It lacks what unpacks Python's objects, a good part of the time of compiling. numba would also
    compile anew for every number that a caller spells out. Its dispatcher is made by the first
    kernel that is compiled and calls it: none where the disk holds all that is needed.
    """
    any_value = cast(Any, types).unliteral

    @cache
    def inner() -> Any:
        bare = made()
        bare._compiling_counter = outer._compiling_counter  # a kernel may call itself
        return bare

    def call_template(arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        return inner().get_call_template(
            tuple(map(any_value, arguments)), {name: any_value(of) for name, of in named.items()}
        )

    def overload(signature: Any) -> Any:
        return inner().get_overload(signature)

    outer.get_call_template, outer.get_overload = call_template, overload


def kernel(function: F) -> F:
    """Compile `function` in nopython mode, cached on disk.

    No fast-math: sums keep their order, so a result never depends on the batch it is in.

    For Python, and apart for other kernels.
    """

    def dispatcher(bare: bool) -> Any:
        made = cast(Any, numba).njit(
            fastmath=False, nogil=True, no_cpython_wrapper=bare, no_cfunc_wrapper=True
        )(function)
        if hasattr(made, "overloads"):  # not when numba is switched off
            made._cache = _Cache(function, bare)
        return made

    outer = dispatcher(bare=False)
    if hasattr(outer, "overloads"):
        _with_bare(outer, lambda: dispatcher(bare=True))
    return cast(F, outer)
