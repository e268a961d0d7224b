"""Configuration of numba: every hot function of ours is an `@kernel`.

Kernels take related arrays as one named tuple, and take what they need out of it
before their loops: reading a field counts references, which costs more than the arithmetic.
"""

import copy
import importlib
from collections.abc import Callable
from functools import cache
from typing import Any, Generic, TypeVar, cast

import numba
import numpy as np
from numba.core import event, types

from mjforage.base.kernel_cache import AWAITED, KernelCache

F = TypeVar("F", bound=Callable[..., object])
T = TypeVar("T")


class _Compiling(event.Listener):
    """Counter of the kernels that numba is compiling in this process, without cached ones."""

    def __init__(self) -> None:
        self.depth = 0  # a kernel compiles those that it calls

    def on_start(self, event: event.Event) -> None:
        self.depth += 1

    def on_end(self, event: event.Event) -> None:
        self.depth -= 1


_compiling = _Compiling()
for _kind in ("numba:compile", AWAITED):
    event.register(_kind, _compiling)  # type: ignore[no-untyped-call]


def compiling() -> bool:
    """True if this process is compiling a kernel, or waiting for one that is."""
    return _compiling.depth > 0


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


def _writable(of: Any) -> Any:
    """The type of an argument as if all of its arrays could be written."""
    kinds = cast(Any, types)
    if isinstance(of, kinds.Array):
        return of if of.mutable else of.copy(readonly=False)
    if isinstance(of, kinds.BaseTuple):
        parts = tuple(map(_writable, of))
        made = getattr(of, "instance_class", None)
        return of if parts == tuple(of) else kinds.BaseTuple.from_types(parts, made)
    return of


def _with_read_only(made: Any) -> None:
    """Let a kernel of ours run on read-only arrays by its compilation for writable ones.

    So read-only views cost no second compilation. Somebody else's kernels are compiled for such
    arrays, and refused if they write to them.
    """
    compile_for = made._compile_for_args

    def compile_once(*arguments: Any, **named: Any) -> Any:
        given = tuple(map(made.typeof_pyval, arguments))
        writable = tuple(map(_writable, given))
        if named or given == writable:
            return compile_for(*arguments, **named)
        entry = made.compile(writable)
        made._insert([of._code for of in given], entry)
        return entry

    made._compile_for_args = compile_once


def _is_ours(function: Callable[..., object]) -> bool:
    return function.__module__.startswith("mjforage.")


def _compiled(function: F, inline: str, fastmath: object = False) -> F:
    """Compile for Python, and apart for other kernels."""
    options: dict[str, Any] = {"fastmath": fastmath, "nogil": True, "inline": inline}

    def dispatcher(bare: bool) -> Any:
        jit = cast(Any, numba).njit(**options, no_cpython_wrapper=bare, no_cfunc_wrapper=True)
        made = jit(function)
        if hasattr(made, "overloads"):  # not when numba is switched off
            made._cache = KernelCache(made)
            made.compile = made._cache.once(made.compile)
        return made

    outer = dispatcher(bare=False)
    if hasattr(outer, "overloads"):
        _with_bare(outer, lambda: dispatcher(bare=True))
        if _is_ours(function):
            _with_read_only(outer)
    return cast(F, outer)


def kernel(function: F) -> F:
    """Compile `function` in nopython mode, cached on disk, without fast-math.

    Fast-math is left out so that results are bitwise the same whatever the batch size.
    """
    return _compiled(function, "never")


def kinds_of(value: object, ours: bool = False) -> object:
    """Kind of a value, as fine as numba's types, found a dozen times faster.

    Of numbers and arrays and tuples of such; of kernels as arguments it would not. For kernels that
    are `ours` it is no difference whether an array may be written, see `_with_read_only`.
    """
    if isinstance(value, np.ndarray):
        flags = value.flags
        writable = ours or flags.writeable
        layout = flags.c_contiguous, flags.f_contiguous, writable, flags.aligned
        return value.dtype, value.ndim, layout
    if isinstance(value, tuple):
        return type(value), *(kinds_of(part, ours) for part in value)
    return type(value)


_entries: dict[object, Callable[..., Any]] = {}  # by kernel and kinds of its arguments


class BoundKernel(Generic[T]):
    """A kernel bound to its first arguments that no longer checks types: for kernels
    called once per decision, where finding out the types of dozens of arrays takes most of a call.

    The first call compiles; later arguments must be of the same types as those of the first call
    (arrays: of the same item, dimensions and contiguity), which is the caller's business. A copy
    keeps copies of the first arguments.
    """

    def __init__(self, function: Callable[..., T], *fixed: object) -> None:
        self._function, self._fixed = function, fixed
        self._entry: Callable[..., T] | None = None

    def __call__(self, *rest: object) -> T:
        """Run the kernel on the first arguments and these."""
        if self._entry is not None:
            return self._entry(*self._fixed, *rest)
        arguments, dispatcher = (*self._fixed, *rest), cast(Any, self._function)
        ours = _is_ours(self._function)
        kinds = (self._function, *(kinds_of(each, ours) for each in arguments))
        self._entry = _entries.get(kinds)
        if self._entry is not None:
            return cast(T, self._entry(*arguments))
        answer = self._function(*arguments)
        if hasattr(dispatcher, "overloads"):  # not when numba is switched off
            given = tuple(map(dispatcher.typeof_pyval, arguments))
            types = tuple(map(_writable, given)) if ours else given
            self._entry = _entries[kinds] = dispatcher.overloads[types].entry_point
        return answer

    @property
    def fixed(self) -> tuple[object, ...]:
        """Its first arguments."""
        return self._fixed

    def __deepcopy__(self, memo: dict[int, Any]) -> "BoundKernel[T]":
        """The same kernel on copies."""
        return BoundKernel(self._function, *copy.deepcopy(self._fixed, memo))

    def __reduce__(self) -> tuple[Any, ...]:
        """Import path and arguments of the kernel; other processes find the compiled code."""
        function = cast(Any, self._function)
        return _bound_again, (function.__module__, function.__name__, *self._fixed)


def _bound_again(module: str, name: str, *fixed: object) -> BoundKernel[Any]:
    """Bound kernel by its name: numba would pickle a kernel's source, and not its cached code."""
    return BoundKernel(getattr(importlib.import_module(module), name), *fixed)


def inlined(function: F) -> F:
    """Compile a helper that is pasted into its callers, for innermost loops passing arrays."""
    return _compiled(function, "always")


def reassociating(function: F) -> F:
    """Compile a sum whose terms may be added in any order, which processors do several at a time.

    Its last bits depend on the processor: compare it with a margin (`TOLERANCE`), and only to skip
    what an exact sum would skip as well.
    """
    return _compiled(function, "never", {"reassoc", "contract"})


TOLERANCE = 1.0 - 1e-9
"""Factor on a rough sum of terms of one sign that makes it no larger than the exact one."""
