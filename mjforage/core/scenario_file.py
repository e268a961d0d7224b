"""Scenario files: strict TOML to `Scenario`, overrides, and the canonical form that is hashed.

Strict means: an unknown key, a wrong type, a missing key or a number out of range is one error that
names the file, the key, the value and what was expected.
"""

import dataclasses
import difflib
import json
import math
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import Any, cast, get_args, get_origin, get_type_hints

from mjforage.core.assets import models_folder
from mjforage.core.errors import UserError
from mjforage.core.scenario import Scenario

Tree = dict[str, Any]

_LONGEST = 60  # characters of a value in a message


def preset_names() -> list[str]:
    """Names of the scenarios that ship with the package."""
    return sorted(path.stem for path in (models_folder() / "scenarios").glob("*.toml"))


def scenario_path(reference: str) -> Path:
    """File of a preset's name or of a path.

    Raises
    ------
    UserError
        If there is no such preset or file.
    """
    name = reference.replace("_", "-")
    if name in preset_names():
        return models_folder() / "scenarios" / f"{name}.toml"
    path = Path(reference)
    try:
        if path.suffix == ".toml" and path.is_file():
            return path
    except (OSError, ValueError) as error:
        raise UserError(f"scenario {reference}: cannot be opened ({error})") from error
    close = difflib.get_close_matches(name, preset_names(), n=1)
    hint = f"did you mean {close[0]}?" if close else f"choose {', '.join(preset_names())}"
    raise UserError(f"scenario {reference}: neither a preset nor a TOML file; {hint}")


def load_scenario(
    reference: str, overrides: Iterable[str] = (), map_file: str | None = None
) -> Scenario:
    """Read a preset or a file, replace the grid, then apply `KEY=VALUE` overrides in order.

    Parameters
    ----------
    reference : name of a preset, or path of a TOML file
    overrides : for example `team.scouts.count=3`; values in TOML syntax, bare words are strings
    map_file : replaces `map.file` only; starts and everything else stay

    Raises
    ------
    UserError
        For anything that is not a valid scenario.
    """
    path = scenario_path(reference)
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"scenario {path.name}: not readable as TOML ({error})") from error
    if map_file is not None:
        _put(tree, ["map", "file"], map_file, f"--map {map_file}")
    for override in overrides:
        _apply(tree, override)
    return scenario_from_tree(tree, f"scenario {path.stem}")


def _apply(tree: Tree, override: str) -> None:
    key, separator, text = override.partition("=")
    parts = key.strip().split(".")
    if not separator or not all(parts):
        raise UserError(f"--set {override}: expected KEY=VALUE, for example team.scouts.count=3")
    if any("\ud800" <= letter <= "\udfff" for letter in override):
        raise UserError(f"--set {override!r}: is not UTF-8")
    try:
        document = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):  # a bare word
        document = {"value": text.strip()}
    if len(document) > 1:
        raise UserError(f"--set {override!r}: expected one value")
    _put(tree, parts, document["value"], f"--set {override}")


def _put(tree: Tree, parts: list[str], value: object, where: str) -> None:
    table = tree
    for part in parts[:-1]:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise UserError(f"{where}: {part} is a value, not a table")
    table[parts[-1]] = value


def scenario_from_tree(tree: Tree, where: str) -> Scenario:
    """Check a nested dict against the schema.

    Parameters
    ----------
    tree : as read from TOML or from the canonical JSON
    where : what errors name first

    Raises
    ------
    UserError
        For an unknown or missing key, a wrong type, a value out of range, or tables that contradict
        each other.
    """
    scenario = cast(Scenario, _table(Scenario, tree, where, ""))
    name = scenario.name
    if not name.isprintable() or not name.strip(" .") or set(name) & set("/\\"):
        raise UserError(
            f"{where}: name = {_shown(name)} names the run folder; give letters, digits and dashes"
        )
    counts = {name: role.count for name, role in scenario.team.items()}
    if not 1 <= sum(counts.values()) <= 255:
        raise UserError(f"{where}: {sum(counts.values())} agents in all; give 1 to 255")
    for team in counts:
        if not team.replace("-", "").replace("_", "").isalnum():
            raise UserError(
                f"{where}: team.{_shown(team)} names files; give letters, digits and dashes"
            )
    order = scenario.rules.order
    if order and sorted(order) != sorted(counts):
        raise UserError(
            f"{where}: rules.order = {_shown(list(order))}; give every team once: "
            f"{', '.join(counts)}"
        )
    choice = scenario.corruption
    if choice.team not in counts and (choice.team or choice.epsilon):
        teams = ", ".join(counts)
        raise UserError(f"{where}: corruption.team = {choice.team!r}; choose {teams}")
    for name in scenario.physics.vessels:
        if name not in counts:
            teams = ", ".join(counts)
            raise UserError(f"{where}: physics.vessels.{name}: no such team; known: {teams}")
    return scenario


def _shown(value: object) -> str:
    """A value as a message shows it, also numbers that Python refuses to print."""
    try:
        text = repr(value)
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _table(schema: type[Any], tree: object, where: str, prefix: str) -> object:
    if not isinstance(tree, dict):
        raise UserError(f"{where}: {prefix.rstrip('.')} = {_shown(tree)}, expected a table")
    fields = {f.name: f for f in dataclasses.fields(schema)}
    hints = get_type_hints(schema)
    for key in tree:
        if key not in fields:
            close = difflib.get_close_matches(key, fields, n=1, cutoff=0.5)
            hint = f"did you mean {prefix}{close[0]}?" if close else f"known: {', '.join(fields)}"
            raise UserError(f"{where}: unknown key {prefix}{key}; {hint}")
    missing = [
        name
        for name, f in fields.items()
        if f.default is dataclasses.MISSING
        and f.default_factory is dataclasses.MISSING
        and name not in tree
    ]
    if missing:
        keys = ", ".join(prefix + name for name in missing)
        raise UserError(f"{where}: missing {keys}")
    values = {
        key: _value(hints[key], fields[key].metadata, value, where, prefix + key)
        for key, value in tree.items()
    }
    return schema(**values)


def _value(hint: Any, metadata: Mapping[str, Any], value: object, where: str, key: str) -> object:
    if isinstance(hint, UnionType):
        if value is None:
            return None
        hint = get_args(hint)[0]
    if dataclasses.is_dataclass(hint):
        return _table(cast(type[Any], hint), value, where, key + ".")
    if get_origin(hint) is tuple:
        return _list(hint, value, where, key)
    if get_origin(hint) is Mapping:
        if not isinstance(value, dict):
            raise UserError(f"{where}: {key} = {_shown(value)}, expected a table of teams")
        kind = get_args(hint)[-1]
        entries = {n: _value(kind, {}, entry, where, f"{key}.{n}") for n, entry in value.items()}
        return MappingProxyType(entries)
    return _scalar(hint, metadata, value, where, key)


def _list(hint: Any, value: object, where: str, key: str) -> object:
    if not isinstance(value, list | tuple):
        raise UserError(f"{where}: {key} = {_shown(value)}, expected a list")
    arguments = get_args(hint)
    if arguments[-1] is Ellipsis:
        return tuple(_value(arguments[0], {}, v, where, f"{key}[{i}]") for i, v in enumerate(value))
    if len(value) != len(arguments):
        raise UserError(f"{where}: {key} = {_shown(value)}, expected {len(arguments)} values")
    return tuple(_value(a, {}, v, where, key) for a, v in zip(arguments, value, strict=True))


def _scalar(hint: Any, metadata: Mapping[str, Any], value: object, where: str, key: str) -> object:
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        value = _float(value)
    if type(value) is not hint:
        expected = {int: "an integer", float: "a number", bool: "true or false", str: "text"}[hint]
        raise UserError(f"{where}: {key} = {_shown(value)}, expected {expected}")
    if isinstance(value, int | float) and not isinstance(value, bool):
        widest = 2.0**63 if hint is int else math.inf  # TOML's integers
        low, high = metadata.get("low", -widest), metadata.get("high", widest)
        if not low <= value <= high or (isinstance(value, float) and not math.isfinite(value)):
            raise UserError(
                f"{where}: {key} = {_shown(value)} is out of range; give {low:g} to {high:g}"
            )
    if value not in metadata.get("choices", (value,)):
        raise UserError(
            f"{where}: {key} = {_shown(value)}; choose {', '.join(metadata['choices'])}"
        )
    return value


def _float(value: int) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def scenario_to_tree(scenario: Scenario) -> Tree:
    """The scenario as nested dicts and lists, every key present; `scenario_from_tree` undoes it."""

    def plain(value: object) -> object:
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
        if isinstance(value, Mapping):
            return {name: plain(entry) for name, entry in value.items()}
        if isinstance(value, tuple):
            return [plain(entry) for entry in value]
        return value

    return cast(Tree, plain(scenario))


def canonical_json(tree: object) -> str:
    """JSON without blanks. Keys keep their order, because the order of teams numbers the agents."""
    return json.dumps(tree, separators=(",", ":"), allow_nan=False)
