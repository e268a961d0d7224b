"""Hash of what a function, class or object of a user does, as far as its source tells."""

import hashlib
import inspect
import uuid
from typing import Any

import cloudpickle

DIGITS = 8


def source_hash(made: Any, state: Any = None) -> str:
    """Hash of a function's or class's source, of what it uses of its module, and of a state.

    Where the source cannot be read, or the state not be written out, a new one each time: what
    cannot be told apart is never taken for the same.
    """
    found = hashlib.sha256()
    try:
        for text in _sources(made, set()):
            found.update(text.encode())
        found.update(cloudpickle.dumps(state))
    except Exception:  # noqa: BLE001  whatever a user's object raises as it is written out
        return f"unreadable-{uuid.uuid4().hex[:DIGITS]}"
    return found.hexdigest()[:DIGITS]


def _sources(made: Any, seen: set[int]) -> list[str]:
    """Sources of a function or class, and of the functions, classes and values that it names."""
    seen.add(id(made))
    texts = [inspect.getsource(made)]
    functions = [made] if inspect.isfunction(made) else list(vars(made).values())
    for function in filter(inspect.isfunction, functions):
        names = inspect.getclosurevars(function)
        texts.append(repr((function.__defaults__, function.__kwdefaults__)))
        for name, value in sorted({**names.globals, **names.nonlocals}.items()):
            if id(value) in seen or inspect.ismodule(value):
                continue
            if not (inspect.isfunction(value) or inspect.isclass(value)):
                texts.append(f"{name} = {hashlib.sha256(cloudpickle.dumps(value)).hexdigest()}")
            elif value.__module__ == made.__module__:
                texts += _sources(value, seen)
    return texts
