"""One change of everything that something is, made by its type: new fields are among them."""

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from mjforage.base.errors import UserError


def changes(whole: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted name of a field, at any depth, and `whole` with another value there; unchecked."""
    hints = get_type_hints(type(whole), include_extras=True)
    for field in dataclasses.fields(whole):
        if not field.init:
            continue
        value, name = getattr(whole, field.name), path + field.name
        for inner, other in _changes(value, hints[field.name], name):
            made = object.__new__(type(whole))
            made.__dict__.update(vars(whole) | {field.name: other})
            yield inner, made


def _changes(value: Any, hint: Any, name: str) -> Iterator[tuple[str, Any]]:
    if dataclasses.is_dataclass(value):
        yield from changes(value, f"{name}.")
    elif isinstance(value, Mapping) and any(map(dataclasses.is_dataclass, value.values())):
        for key, entry in value.items():
            yield f"{name} without {key}", {k: v for k, v in value.items() if k != key}
            for inner, other in changes(entry, f"{name}.{key}."):
                yield inner, {**value, key: other}
    else:
        other = another(value, hint)
        assert other != value, name
        yield name, other


def another(value: Any, hint: Any) -> Any:
    """Another value of a field's type.

    Raises
    ------
    TypeError
        If the type is none that this knows: teach it.
    """
    kind = get_origin(hint) or hint
    if kind is Annotated:
        return another(value, get_args(hint)[0])
    if kind is Literal:
        return next(each for each in get_args(hint) if each != value)
    if kind in (Union, UnionType):
        return another(value, next(each for each in get_args(hint) if each is not NoneType))
    if kind is bool:
        return not value
    if kind in (int, float):
        return (value or 0) + (1 if kind is int else 0.25)
    if kind is str:
        return f"{value or ''}x"
    if kind is tuple:
        inside = get_args(hint)
        if inside[-1] is not Ellipsis:
            return tuple(another(None, each) for each in inside)
        return (*(value or ()), another(None, inside[0]))
    if isinstance(kind, type) and issubclass(kind, Mapping):
        return {**(value or {}), "x": another(None, get_args(hint)[1])}
    if kind is Any:
        return "x"
    raise TypeError(f"{hint}: no other value known for this type")


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of what stands in JSON; of a list, its last."""
    if isinstance(value, dict) and value:
        for key, one in value.items():
            yield from leaves(one, (*path, key))
    elif isinstance(value, list) and value:
        yield from leaves(value[-1], (*path, len(value) - 1))
    else:
        yield path


def with_other(value: Any, path: tuple[Any, ...]) -> Any:
    """The same with something else in one place."""
    if not path:
        return "something else"
    changed = value.copy()
    changed[path[0]] = with_other(value[path[0]], path[1:])
    return changed


def tree_of(folder: Path) -> dict[str, bytes]:
    """Every file of a folder."""
    return {str(path): path.read_bytes() for path in folder.rglob("[!.]*") if path.is_file()}


def assert_refused(folder: Path, ask: Callable[[], object], name: str) -> None:
    """That nothing is computed, and the folder stays as it was."""
    before = tree_of(folder)
    try:
        ask()
    except UserError as error:
        assert "holds another" in str(error), (name, error)
    else:
        raise AssertionError(f"{name}: gone on with")
    assert tree_of(folder) == before, name
