"""`run.json`, strictly: what was run, on which map, with which fleet."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mjforage.core.errors import UserError

REMEDY = (
    "run the command that made this folder again, or name a folder that evaluate, compare or study "
    "wrote"
)

_T = TypeVar("_T")


@dataclass(frozen=True)
class Agent:
    """One vessel of the fleet; its index is its place in `RunInfo.agents`."""

    name: str
    team: str
    collects: bool  # True for foragers


@dataclass(frozen=True)
class MapInfo:
    """The map that was run on."""

    name: str
    nodes: int
    pitch_m: float
    navigable: NDArray[np.bool_]  # (row, column)


@dataclass(frozen=True)
class RunInfo:
    """Content of `run.json`; `scenario` stays a plain nested dict, to be shown as it is."""

    command: str
    scenario: Mapping[str, Any]
    hash: str
    versions: Mapping[str, str]
    seed: int
    episodes: int  # per world and policy
    worlds: tuple[str, ...]
    policies: tuple[str, ...]
    bounds: tuple[str, ...]  # those policies that are shown the truth
    classes: Mapping[str, str]  # policy -> package.module:Class, of those that are not ours
    agents: tuple[Agent, ...]
    map: MapInfo
    hull_lengths: Mapping[str, float]  # name of a vessel -> [m]; empty at graph level
    started: str
    timings: Mapping[str, float]  # [s]

    @property
    def horizon(self) -> int:
        """Steps T by which times are normalised."""
        return int(self.scenario["horizon"])

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return str(self.scenario["name"])


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON object.

    Raises
    ------
    UserError
        If the file is missing, not readable, truncated or not an object.
    """
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise UserError(f"{path}: file is missing; {REMEDY}") from error
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read as JSON ({error}); {REMEDY}") from error
    if not isinstance(value, dict):
        raise UserError(f"{path}: holds a {type(value).__name__}, expected an object; {REMEDY}")
    return value


def again(folder: Path, file: str = "run.json") -> str:
    """Words that ask for the command that made a folder, as its `run.json` or `study.json` says."""
    try:
        return f"run `{field(read_json(folder / file), 'command', str, file)}` again"
    except UserError:
        return "run the command that made this folder again"


def field(mapping: Mapping[str, Any], key: str, kind: type[_T], where: str) -> _T:
    """Value of a key, which must be there and of the kind (an integer passes for a float).

    Raises
    ------
    UserError
        If the key is missing or its value is of another type.
    """
    if key not in mapping:
        raise UserError(f"{where}: key '{key}' is missing; {REMEDY}")
    value = mapping[key]
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        found = type(value).__name__
        raise UserError(f"{where}: '{key}' is a {found}, expected {kind.__name__}; {REMEDY}")
    return value


def _names(data: Mapping[str, Any], key: str, where: str) -> tuple[str, ...]:
    values = field(data, key, list, where)
    if not values or not all(isinstance(value, str) for value in values):
        raise UserError(f"{where}: '{key}' must list at least one name, is {values}; {REMEDY}")
    return tuple(values)


def _map(data: Mapping[str, Any], where: str) -> MapInfo:
    shape = (field(data, "rows", int, where), field(data, "columns", int, where))
    rows = field(data, "navigable", list, where)
    lines = [str(row) for row in rows]
    if len(lines) != shape[0] or any(
        len(line) != shape[1] or set(line) - set("01") for line in lines
    ):
        raise UserError(
            f"{where}: 'navigable' is not {shape[0]} strings of {shape[1]} zeros and ones; {REMEDY}"
        )
    cells = np.array([[cell == "1" for cell in line] for line in lines], dtype=np.bool_)
    return MapInfo(
        field(data, "name", str, where),
        field(data, "nodes", int, where),
        field(data, "pitch_m", float, where),
        cells.reshape(shape),
    )


def _agents(data: Mapping[str, Any], where: str) -> tuple[Agent, ...]:
    return tuple(
        Agent(
            field(entry, "name", str, where),
            field(entry, "team", str, where),
            field(entry, "collects", bool, where),
        )
        for entry in field(data, "agents", list, where)
    )


def _classes(data: Mapping[str, Any], where: str) -> dict[str, str]:
    return {name: field(data, name, str, f"{where}: classes") for name in data}


def _hull_lengths(data: Mapping[str, Any], where: str) -> dict[str, float]:
    vessels = field(data, "vessels", dict, where) if data else {}
    return {name: field(facts, "length_m", float, where) for name, facts in vessels.items()}


def load_run(path: Path) -> RunInfo:
    """Read `run.json`.

    Raises
    ------
    UserError
        If the file or one of its keys is missing or malformed.
    """
    data, where = read_json(path), str(path)
    scenario = field(data, "scenario", dict, where)
    field(scenario, "name", str, f"{where}: scenario")
    if field(scenario, "horizon", int, f"{where}: scenario") < 1:
        raise UserError(
            f"{where}: scenario horizon is {scenario['horizon']}, must be positive; {REMEDY}"
        )
    return RunInfo(
        command=field(data, "command", str, where),
        scenario=scenario,
        hash=field(data, "hash", str, where),
        versions=field(data, "versions", dict, where),
        seed=field(data, "seed", int, where),
        episodes=field(data, "episodes", int, where),
        worlds=_names(data, "worlds", where),
        policies=_names(data, "policies", where),
        bounds=tuple(map(str, field({"bounds": [], **data}, "bounds", list, where))),
        classes=_classes(field({"classes": {}, **data}, "classes", dict, where), where),
        agents=_agents(data, where),
        map=_map(field(data, "map", dict, where), f"{where}: map"),
        hull_lengths=_hull_lengths(field(data, "hulls", dict, where), f"{where}: hulls"),
        started=field(data, "started", str, where),
        timings=field(data, "timings", dict, where),
    )
