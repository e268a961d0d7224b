"""Hash of what a function, class or object of a user does: its code and the values it uses."""

import functools
import hashlib
import inspect
import sys
import sysconfig
import uuid
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import cloudpickle

DIGITS = 8
_LIBRARIES = tuple(sysconfig.get_path(name) for name in ("stdlib", "purelib", "platlib"))
_OURS = str(Path(__file__).parents[1])


def source_hash(made: Any, state: Any = None) -> str:
    """Hash of the code of a function or class, of what it uses of a user's modules, and of a state.

    Where a value cannot be written out, a new one each time: what cannot be told apart is never
    taken for the same.
    """
    found = hashlib.sha256()
    try:
        for text in _parts(made, set()):
            found.update(text)
        found.update(cloudpickle.dumps(state))
    except Exception:  # noqa: BLE001  whatever a user's object raises as it is written out
        return f"unreadable-{uuid.uuid4().hex[:DIGITS]}"
    return found.hexdigest()[:DIGITS]


def users_modules() -> list[ModuleType]:
    """Modules that can be imported and are neither of Python, nor installed, nor ours."""
    return [
        module
        for name, module in list(sys.modules.items())
        if name not in ("__main__", "__mp_main__") and _is_users(module)
        if getattr(module, "__name__", "") == name
    ]


def _is_users(module: ModuleType | None) -> bool:
    if module is None or getattr(module, "__name__", "") == "__main__":
        return True
    file = getattr(module, "__file__", None)
    return bool(file) and not str(file).startswith((*_LIBRARIES, _OURS))


def _parts(value: Any, seen: set[int]) -> Iterator[bytes]:
    """Pieces of what decides a value; each object once."""
    if id(value) in seen:
        return
    seen.add(id(value))
    if isinstance(value, ModuleType):
        file = getattr(value, "__file__", None)
        yield Path(file).read_bytes() if file and _is_users(value) else value.__name__.encode()
    elif isinstance(value, functools.partial):
        yield from _parts(value.func, seen)
        yield cloudpickle.dumps((value.args, value.keywords))
    elif inspect.ismethod(value):
        yield from _parts(value.__func__, seen)
        yield from _parts(value.__self__, seen)
    elif inspect.isroutine(value) or inspect.isclass(value):
        yield f"{value.__module__}:{value.__qualname__}".encode()
        if _is_users(sys.modules.get(value.__module__ or "__main__")):
            yield from _of_class(value, seen) if inspect.isclass(value) else _of_code(value, seen)
    elif type(value).__module__ not in ("builtins", "numpy") and hasattr(value, "__dict__"):
        yield from _parts(type(value), seen)
        yield cloudpickle.dumps(vars(value))
    else:
        yield cloudpickle.dumps(value)


def _of_class(made: type, seen: set[int]) -> Iterator[bytes]:
    for base in made.__bases__:
        yield from _parts(base, seen)
    for name, member in sorted(vars(made).items()):
        if name in ("__dict__", "__weakref__", "__doc__", "__firstlineno__"):
            continue
        yield name.encode()
        yield from _parts(getattr(member, "__func__", getattr(member, "fget", member)), seen)


def _of_code(function: Any, seen: set[int]) -> Iterator[bytes]:
    if not hasattr(function, "__code__"):
        return
    names = set()
    for code in _codes(function.__code__):
        names |= {*code.co_names}
        consts = [one for one in code.co_consts if not isinstance(one, CodeType)]
        plain = [sorted(map(repr, one)) if isinstance(one, frozenset) else one for one in consts]
        yield code.co_code + repr((code.co_names, code.co_varnames, plain)).encode()
    yield cloudpickle.dumps((function.__defaults__, function.__kwdefaults__))
    used = {name: function.__globals__[name] for name in names if name in function.__globals__}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        used[name] = cell.cell_contents
    for name, value in sorted((used | vars(function)).items()):
        yield name.encode()
        yield from _parts(value, seen)


def _codes(code: CodeType) -> Iterator[CodeType]:
    """A function's code, and that of the functions and comprehensions in it."""
    yield code
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield from _codes(one)
