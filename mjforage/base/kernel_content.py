"""Content of a compiled kernel: everything that its machine code depends on, as text.

A kernel is known by its own bytecode and constants, by those of every function that it calls, be it
by way of others, and by the values of the global names that they read. Comments, other functions of
the same file and the place of the file are no part of it.
"""

from collections.abc import Callable, Iterator
from functools import cache
from types import CodeType, FunctionType, ModuleType
from typing import Any, cast

from numba.core import types

Called = tuple[Any, ...]


def content(dispatcher: Any) -> str:
    """Text on which a kernel's machine code depends, besides the types of its arguments.

    `dispatcher`: a function that numba compiles; as it is called for the first time, since what it
    calls may stand below it in its file.
    """
    found: dict[int, str] = {}
    left = [dispatcher]
    while left:
        one = left.pop()
        if id(one) not in found:
            found[id(one)], called = _own(one)
            left += called
    return "\n".join([_own(dispatcher)[0], *sorted(found.values())])


@cache
def _own(dispatcher: Any) -> tuple[str, Called]:
    """One function's own content, and the functions that it calls."""
    function = getattr(dispatcher, "py_func", dispatcher)
    called: list[Any] = []
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    parts = [
        f"{function.__module__}.{function.__qualname__}",
        repr([(name, _in_order(it)) for name, it in sorted(_options(dispatcher).items())]),
        *_code(function.__code__, function.__doc__),
        *(_value(value, called) for value in (function.__defaults__, *cells)),
    ]
    for name, value in _read(function):
        parts.append(f"{name} = {_value(value, called)}")
    return " ".join(parts), tuple(called)


def _code(code: CodeType, doc: str | None) -> Iterator[str]:
    """Bytecode and what it names; a docstring is none of it."""
    yield code.co_code.hex()
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_argcount))
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code(constant, None)
        elif constant is None or constant != doc:
            yield repr(_in_order(constant))


def _options(dispatcher: Any) -> dict[str, Any]:
    return cast(dict[str, Any], getattr(dispatcher, "targetoptions", {}))


def _in_order(value: Any) -> Any:
    """A set as a list: its own order is another one in every process."""
    return sorted(value) if isinstance(value, set | frozenset) else value


def _read(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """Global names that a function reads, and what of those is a module of anybody's."""
    for name in sorted(_names(function.__code__)):
        if name not in function.__globals__:
            continue
        value = function.__globals__[name]
        yield name, value
        if isinstance(value, ModuleType):
            for part in sorted(_names(function.__code__) & vars(value).keys()):
                yield f"{name}.{part}", vars(value)[part]


def _names(code: CodeType) -> set[str]:
    inner = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*map(_names, inner))


def _value(value: Any, called: list[Any]) -> str:
    """A value that a kernel reads; what it can call is appended to `called`."""
    if isinstance(value, ModuleType):
        return f"module {value.__name__}"
    if hasattr(value, "py_func") or (isinstance(value, FunctionType) and not _foreign(value)):
        called.append(value)
        return f"function {value.__module__}.{value.__qualname__}"
    if isinstance(value, FunctionType) and (made := getattr(value, "__wrapped__", None)):
        return _value(made, called)
    if isinstance(value, type):
        return f"{value.__module__}.{value.__qualname__} {getattr(value, '_fields', '')}"
    if isinstance(value, tuple | list):
        return f"{type(value).__name__}({', '.join(_value(one, called) for one in value)})"
    if hasattr(value, "tobytes") and hasattr(value, "dtype"):
        return f"{value.dtype.descr} {value.shape} {value.tobytes().hex()}"
    if definition := getattr(value, "_defn", None):  # an intrinsic of numba's
        return _value(definition, called)
    text = repr(_in_order(value))
    return type(value).__qualname__ if " at 0x" in text else text


def _foreign(function: Callable[..., Any]) -> bool:
    """True if a function is a library's, whose version identifies it well enough."""
    return function.__module__.partition(".")[0] in ("numpy", "numba", "math", "builtins")


def type_content(kind: Any) -> str:
    """A type of numba's as text, with the names of the fields of tuples."""
    if isinstance(kind, types.BaseNamedTuple):
        made = cast(Any, kind).instance_class
        inner = ", ".join(map(type_content, cast(Any, kind).types))
        return f"{made.__module__}.{made.__qualname__}{made._fields}({inner})"
    if isinstance(kind, types.BaseTuple):
        return f"({', '.join(map(type_content, cast(Any, kind).types))})"
    if isinstance(kind, types.Dispatcher):
        return content(cast(Any, kind).dispatcher)
    return str(kind)
