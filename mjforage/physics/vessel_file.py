"""Vessel files: strict TOML in which every number is `{ value = 1.0, unit = "m", source = "..." }`.

Strict means: an unknown or missing key, a wrong type, another unit, no source, or a number out of
range is one error that names the file, the key, the value and what was expected.
"""

import difflib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from pathlib import Path
from types import UnionType
from typing import Any, get_args, get_type_hints

from mjforage.core.assets import models_folder
from mjforage.core.errors import UserError

Tree = dict[str, Any]

_ENTRY = ("value", "unit", "source")
_KINDS = {"propeller": "Propeller", "force": "ForceThruster"}  # of [thruster]


def quantity(unit: str, low: float, high: float) -> dict[str, object]:
    """Field metadata: the unit and the closed range of a number."""
    return {"unit": unit, "low": low, "high": high}


def positive(unit: str, high: float) -> dict[str, object]:
    """Field metadata: the unit of a number above 0."""
    return {"unit": unit, "low": math.ulp(0.0), "high": high}


def range_words(about: Mapping[str, Any]) -> str:
    """The range of a number's metadata, for messages: `0 to 10`, or `above 0 to 10`."""
    least = "above 0" if about["low"] == math.ulp(0.0) else f"{about['low']:g}"
    return f"{least} to {about['high']:g}"


def vessel_names() -> list[str]:
    """Names of the vessels that ship with the package."""
    return sorted(path.stem for path in (models_folder() / "vessels").glob("*.toml"))


def vessel_path(name_or_path: str | Path) -> Path:
    """File of a shipped vessel's name or of a path.

    Raises
    ------
    UserError
        If there is no such vessel or file.
    """
    names = vessel_names()
    if str(name_or_path) in names:
        return models_folder() / "vessels" / f"{name_or_path}.toml"
    path = Path(name_or_path)
    try:
        if path.suffix == ".toml" and path.is_file():
            return path
    except (OSError, ValueError) as error:
        raise UserError(f"vessel {name_or_path}: cannot be opened ({error})") from error
    close = difflib.get_close_matches(str(name_or_path), names, n=1)
    hint = f"did you mean {close[0]}?" if close else f"choose {', '.join(names)}"
    raise UserError(f"vessel {name_or_path}: neither a shipped vessel nor a TOML file; {hint}")


def read_vessel(name_or_path: str | Path, schema: type[Any]) -> tuple[str, Tree]:
    """Name of the vessel and the values of the schema's other fields.

    Raises
    ------
    UserError
        For anything that does not follow the schema.
    """
    path = vessel_path(name_or_path)
    where = f"vessel {path.stem}"
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{where}: not readable as TOML ({error})") from error
    return path.stem, _table(schema, tree, where, "", skip=("name",))


def _table(
    schema: type[Any], tree: Tree, where: str, prefix: str, skip: tuple[str, ...] = ()
) -> Tree:
    known = {f.name: f for f in fields(schema) if f.name not in skip}
    hints = get_type_hints(schema)
    for key in tree:
        if key not in known:
            close = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
            hint = f"did you mean {prefix}{close[0]}?" if close else f"known: {', '.join(known)}"
            raise UserError(f"{where}: unknown key {prefix}{key}; {hint}")
    missing = [prefix + key for key, f in known.items() if f.default is MISSING and key not in tree]
    if missing:
        them = "it" if len(missing) == 1 else "them"
        raise UserError(
            f"{where}: missing {', '.join(missing)}; add {them} as the shipped vessels have {them}"
        )
    return {key: _value(hints[key], known[key], tree[key], where, prefix + key) for key in tree}


def _value(hint: Any, about: "Field[Any]", value: object, where: str, key: str) -> object:
    if hint is str:
        return _text(value, about.metadata.get("choices"), where, key)
    if not isinstance(value, dict):
        raise UserError(f"{where}: {key} = {_shown(value)}, expected a table")
    if hint is float:
        return _number(value, about.metadata, where, key)
    choices = [c for c in get_args(hint) or (hint,) if c is not type(None)]
    if isinstance(hint, UnionType) and len(choices) > 1:
        choices, value = _of_kind(choices, value, where, key)
    return choices[0](**_table(choices[0], value, where, f"{key}."))


def _of_kind(choices: list[Any], tree: Tree, where: str, key: str) -> tuple[list[Any], Tree]:
    """The one class that the table's `kind` names, and the table without it."""
    kind = _text(tree.get("kind", ""), tuple(_KINDS), where, f"{key}.kind")
    rest = {name: value for name, value in tree.items() if name != "kind"}
    return [c for c in choices if c.__name__ == _KINDS[kind]], rest


def _text(value: object, choices: tuple[str, ...] | None, where: str, key: str) -> str:
    if not isinstance(value, str):
        raise UserError(f"{where}: {key} = {_shown(value)}, expected text")
    if choices is not None and value not in choices:
        raise UserError(f"{where}: {key} = {_shown(value)}; choose {', '.join(choices)}")
    return value


def _number(entry: Tree, about: Mapping[str, Any], where: str, key: str) -> float:
    if sorted(entry) != sorted(_ENTRY):
        raise UserError(f"{where}: {key} has {', '.join(entry)}; give value, unit and source")
    value, unit, source = (entry[name] for name in _ENTRY)
    if unit != about["unit"]:
        raise UserError(f'{where}: {key} has unit {_shown(unit)}, expected "{about["unit"]}"')
    if not isinstance(source, str) or not source.strip():
        raise UserError(f"{where}: {key} has no source; say where {_shown(value)} is from")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UserError(f"{where}: {key} = {_shown(value)}, expected a number")
    low, high = about["low"], about["high"]
    if not low <= value <= high:
        raise UserError(
            f"{where}: {key} = {_shown(value)} is out of range; give {range_words(about)}"
        )
    return float(value)


def _shown(value: object) -> str:
    """A value as a message shows it, also numbers that Python refuses to print."""
    try:
        text = repr(value)
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:60]}..."
