"""References such as `auction(margin=2, fast=true)`: a name and options, as text and back.

Values are TOML; a bare word is text. The text of a reference is its label: in tables, in files, and
in what a run is.
"""

import difflib
import hashlib
import inspect
import json
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from mjforage.base.errors import UserError

_BARE = re.compile(r"[\w./+~-]+")
_SAFE = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,59}")
_LARGEST = 2**63 - 1  # whole number as an option: kernels count in 64 bits
_UNSAFE = re.compile(r"[^A-Za-z0-9_.-]+")


@dataclass(frozen=True)
class Reference:
    """Reference to a registered part, with its options.

    Attributes
    ----------
    name : registered, of an entry point, or `package.module:Name`
    options : keyword -> value
    """

    name: str
    options: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        """The text that `parse_reference` reads, options in the order of their names."""
        if not self.options:
            return self.name
        inside = ", ".join(f"{key}={_text(self.options[key])}" for key in sorted(self.options))
        return f"{self.name}({inside})"


def parse_reference(text: str, kind: str) -> Reference:
    """Read a reference.

    Raises `UserError` if it is neither.

    `text`: NAME or NAME(OPTION=VALUE, ...); `kind`: kind of the named part, for messages.
    """
    name, opened, inside = text.strip().partition("(")
    name, inside = name.strip(), inside.strip()
    if not name or (opened and not inside.endswith(")")):
        raise UserError(f"{kind} {text!r}: expected NAME or NAME(OPTION=VALUE, ...)")
    options: dict[str, Any] = {}
    piece = ""
    for part in inside[:-1].split(",") if opened else ():
        piece = f"{piece},{part}" if piece else part
        key, sign, value = (word.strip() for word in piece.partition("="))
        found = _value(value) if sign and key.isidentifier() else None
        if found is None:  # a comma within a list or a text
            continue
        if key in options:
            raise UserError(f"{kind} {text!r}: option {key} is given twice")
        options[key], piece = found, ""
    if piece.strip():
        raise UserError(
            f"{kind} {text!r}: {piece.strip()!r} is no OPTION=VALUE; values are numbers, true, "
            'false, words, "texts" or [lists], separated by commas'
        )
    return Reference(name, options)


def with_options(
    kind: str, references: Iterable[str], overrides: Iterable[str]
) -> tuple[list[str], tuple[str, ...]]:
    """References with the options that overrides of the form KIND.NAME.OPTION=VALUE give them.

    Raises `UserError` if no reference has that name, or one has that option with another value.

    Returns: the references, and the overrides of other things.
    """
    found = [parse_reference(text, kind) for text in references]
    others = []
    for text in overrides:
        path, sign, value = text.partition("=")
        start, _, name = path.strip().partition(".")
        if start != kind:
            others.append(text)
            continue
        name, _, option = name.rpartition(".")
        parsed = parse_reference(f"{name}({option}={value})", kind)
        meant = [place for place, one in enumerate(found) if one.name == name]
        if not sign or not meant:
            given = ", ".join(one.name for one in found) or "none"
            close = difflib.get_close_matches(name, [one.name for one in found], n=1)
            hint = f"did you mean {kind}.{close[0]}.{option}? As it is, " if close else ""
            raise UserError(f"set {text}: {hint}give {kind}.NAME.OPTION=VALUE, NAME of {given}")
        for place in meant:
            there = {**parsed.options, **found[place].options}
            if there[option] != parsed.options[option]:
                raise UserError(f"set {text}: {found[place]} says otherwise; say it once")
            found[place] = Reference(name, there)
    return [str(one) for one in found], tuple(others)


def assigned(text: str) -> dict[str, Any]:
    """TOML value of the text behind `KEY=`, as `value`; a bare word is a text.

    A text of several lines may have other keys beside it.
    """
    try:
        return tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return {"value": text.strip()}


def _value(text: str) -> Any:
    """A TOML value of plain kind, or a bare word; None for neither."""
    try:
        tree = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text if _BARE.fullmatch(text) else None
    value = tree.pop("value")
    if tree or value != value:  # a second line, or NaN, which equals nothing
        return None
    return value if isinstance(value, bool | int | float | str | list | dict) else text


def _text(value: Any) -> str:
    """A value as TOML has it, bare where that reads the same."""
    if isinstance(value, str):
        plain = _BARE.fullmatch(value) and _value(value) == value
        return value if plain else json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return f"[{', '.join(_text(one) for one in value)}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {_text(v)}" for k, v in value.items()) + "}"
    return str(value).lower() if isinstance(value, bool) else repr(value)


def file_label(label: str) -> str:
    """A label as part of a file's name: itself if valid, else its valid part and a checksum."""
    if _SAFE.fullmatch(label):
        return label
    checksum = hashlib.sha256(label.encode()).hexdigest()[:8]
    return f"{_UNSAFE.sub('-', label)[:40].strip('-.')}-{checksum}"


def nearest(name: str, known: Iterable[str]) -> str:
    """A remedy for an unknown name: the nearest known one, or all in their order."""
    names = sorted(known) if isinstance(known, Set) else list(known)
    close = difflib.get_close_matches(str(name), names, n=1)
    return f"did you mean {close[0]}?" if close else f"choose {', '.join(names) or 'none'}"


def bind(
    made: Callable[..., object], reference: Reference, kind: str, given: int = 0
) -> tuple[Reference, Any]:
    """Check a reference's options against the signature of the class or function.

    Raises `UserError` if an option is unknown, missing or, as its annotation tells, of the wrong
    type.

    `given`: arguments before the options, which it is called with whatever they say. Returns: the
    reference as all spell it (options that are the default are left out, 2.0 is 2), and the keyword
    arguments to call with.
    """
    signature: Mapping[str, inspect.Parameter]
    try:
        signature = inspect.signature(made).parameters
    except (TypeError, ValueError):  # of a class written in C
        signature = {}
    open_end = any(one.kind is one.VAR_KEYWORD for one in signature.values())
    known = {
        name: one
        for name, one in list(signature.items())[given:]
        if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)
    }
    hints = _hints(made) if reference.options else {}
    spelt, values = {}, {}
    for name, value in reference.options.items():
        if name not in known and not open_end:
            remedy = nearest(name, known) if known else "it takes none"
            raise UserError(f"{kind} {reference.name}: unknown option {name}; {remedy}")
        where = f"{kind} {reference.name}: option {name} = {_text(value)}"
        values[name] = fitting(value, hints.get(name, Any), where)
        if name not in known or not _same(values[name], known[name].default):
            spelt[name] = _spelt(value, values[name])
    for name, one in known.items():
        if one.default is one.empty and name not in values:
            raise UserError(
                f"{kind} {reference.name}: option {name} is missing; give "
                f"{reference.name}({name}=...)"
            )
    return Reference(reference.name, spelt), values


def _same(value: object, default: object) -> bool:
    return type(value) is type(default) and value == default


def _spelt(value: Any, fitted: Any) -> Any:
    """2 and 2.0 are one number where a float is asked for."""
    whole = isinstance(fitted, float) and fitted.is_integer() and abs(fitted) < 1e15
    return int(fitted) if whole and type(value) in (int, float) else value


def _hints(made: Callable[..., object]) -> dict[str, Any]:
    """Annotations of the arguments, none where they cannot be read."""
    target = made.__init__ if inspect.isclass(made) else made
    try:
        return get_type_hints(target)
    except (NameError, TypeError, AttributeError):
        return {}


def fitting(value: Any, hint: Any, where: str) -> Any:
    """A plain value as its annotation asks: an integer as float, a text as path, a list as tuple.

    Raises `UserError` if it is of another type; annotations that are not of plain types are not
    checked.
    """
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        for one in inner:
            try:
                return fitting(value, one, where)
            except UserError:
                continue
        raise UserError(f"{where}: expected {_name(hint)}")
    if origin is Literal:
        if value not in inner:
            raise UserError(f"{where}: choose {', '.join(map(str, inner))}")
        return value
    kind = origin or hint
    if kind is float and type(value) is int:
        return float(value)
    if kind is Path and isinstance(value, str):
        return Path(value)
    if kind in (tuple, list, Sequence) and isinstance(value, list):
        each = inner[0] if inner else Any
        return (list if kind is list else tuple)(fitting(one, each, where) for one in value)
    checked = kind in (bool, int, float, str, tuple, list, dict, Path, NoneType)
    if checked and type(value) is not kind:
        raise UserError(f"{where}: expected {_name(hint)}")
    if kind is int and not -_LARGEST <= value <= _LARGEST:
        raise UserError(f"{where}: expected a number within +-{_LARGEST}")
    return value


def _name(hint: Any) -> str:
    if hint is bool:
        return "true or false"
    words = hint.__name__ if isinstance(hint, type) and not get_args(hint) else str(hint)
    return words.replace("pathlib.", "").replace("NoneType", "None")
