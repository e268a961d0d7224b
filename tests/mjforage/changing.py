"""One change of every field of a dataclass, made by its type: new fields are among them."""

import dataclasses
from collections.abc import Iterator, Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints


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
