"""The scenario and the map of an environment, as a user of Python hands them over."""

import json
import reprlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeGuard, cast

import numpy as np

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.mission.setup import Setup
from mjforage.physics.vessel_moves import open_setup
from mjforage.scenario.harbours import family, is_family, is_harbour
from mjforage.scenario.maps import PITCH_M, water_of_array
from mjforage.scenario.place import is_place
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario, with_overrides, with_values


class UnknownArgumentError(UserError, TypeError):
    """An argument that no environment takes; a `TypeError` too, in the words that TorchRL's
    `GymEnv`, which tries arguments of its own, looks for.
    """


BATCHES = (
    "num_envs",
    "autoreset_mode",
    "copy",
    "threads",
    "device",
)  # arguments of `ForagingVectorEnv` alone


def check_known(arguments: Mapping[str, object], known: Sequence[str]) -> None:
    """Refuse an argument that is not known.

    Raises `UnknownArgumentError` naming the first of them, and the nearest that is known.
    """
    for name, value in arguments.items():
        if name in BATCHES:
            raise UnknownArgumentError(
                f"{name} = {value!r}: is of batches, not of one environment; leave it out, or give "
                "it to make_vec(...) without vectorization_mode, of an environment with batches"
            )
        if name not in known:
            raise UnknownArgumentError(
                f"an environment got an unexpected keyword argument {name!r}; "
                f"{nearest(name, known)}"
            )


Overrides = Sequence[str] | Mapping[str, Any]


def scenarios_of(scenario: Scenario) -> list[Scenario]:
    """A scenario on each harbour of its family, or as it is if its map is no family.

    Raises `UserError` if the family's name is not well formed.
    """
    if not is_family(scenario.map.file):
        return [scenario]
    return [
        replace(scenario, map=replace(scenario.map, file=name))
        for name in family(scenario.map.file)
    ]


def on_each_map(scenario: object, grid: object, overrides: object) -> list[dict[str, object]]:
    """Arguments `scenario`, `map` and `set` of one map each, where these name several.

    Raises `UserError` as `chosen_setup`.

    Parameters
    ----------
    grid : also names of maps, or a family of harbours, which the scenario's map may be as well
    """
    about, given = {"scenario": scenario, "set": overrides}, list(override_texts(overrides))
    names = [grid] if isinstance(grid, str | Path) else grid
    if is_names(names):
        one_each = [family(str(name)) if is_family(str(name)) else [name] for name in names]
        return [about | {"map": name} for each in one_each for name in each]
    if grid is None and (_names_map(given) or not isinstance(scenario, Setup)):
        asked = scenario.asked if isinstance(scenario, Setup) else scenario
        chosen = _chosen_scenario(asked, None, given)
        if is_family(chosen.map.file):
            return [{"scenario": each} for each in scenarios_of(chosen)]
    return [about | {"map": grid}]


def is_names(grid: object) -> TypeGuard[Sequence[str | Path]]:
    """True if it is a list of names or paths, of one map each.

    Raises `UserError` if it is empty, or there is something else in it.
    """
    if not isinstance(grid, list | tuple):
        return False
    named = [isinstance(each, str | Path) for each in cast(Sequence[object], grid)]
    if any(named) != all(named) or not named:
        raise UserError(
            f"map = {reprlib.repr(grid)}: is neither a list of names nor an array; give names and "
            "paths alone, or rows of 0 and 1"
        )
    return all(named)


def _names_map(given: Sequence[str]) -> bool:
    """True if one of the overrides is of the map's file."""
    return any(text.partition("=")[0].strip() == "map.file" for text in given)


def chosen_setup(scenario: object, grid: object, overrides: object) -> Setup:
    """The setup from the arguments `scenario=`, `map=` and `set=`.

    Raises `UserError` if one of them is of another type, or the scenario is not a valid one.
    """
    given, place, depth_m = list(override_texts(overrides)), None, None
    if isinstance(scenario, Setup):
        if grid is None and not given:
            return scenario
        if grid is None and not _names_map(given):
            grid, place = scenario.grid.charted, scenario.grid.place
            depth_m = scenario.grid.depth_m
        scenario = scenario.asked
    if is_names(grid):
        if len(grid) > 1:
            raise UserError(
                f"map = {reprlib.repr(grid)}: several maps, which only batches of Foraging-v0 take "
                "(make_vec without vectorization_mode); give one"
            )
        grid = grid[0]
    cells = water_of_array(grid) if isinstance(grid, np.ndarray | list) else None
    changed = _chosen_scenario(scenario, grid, given)
    return open_setup(changed, cells, place=place, depth_m=depth_m)


def _chosen_scenario(scenario: object, grid: object, given: list[str]) -> Scenario:
    """The scenario with map and overrides; raises as `chosen_setup`."""
    if not isinstance(scenario, str | Path | Scenario):
        raise _unknown("scenario", scenario, "a preset's name, a TOML file or a Scenario")
    found = scenario if isinstance(scenario, Scenario) else load_scenario(str(scenario))
    if grid is not None and _names_map(given):
        raise UserError(
            f"map = {reprlib.repr(grid)}: set names another, map.file; give one of both"
        )
    if isinstance(grid, np.ndarray | list):
        found = with_values(found, {"map.starts": []}, "map")
    elif grid == "":
        raise UserError("map = '': names nothing; give a name, a file or an array")
    elif isinstance(grid, str | Path):
        starts: dict[str, object] = {"map.starts": []} if is_harbour(str(grid)) else {}
        if is_place(str(grid)):
            starts = {"map.starts": None, "map.pitch_m": PITCH_M}
        found = with_values(
            found, {"map.file": str(grid), "map.water": "light", **starts}, f"map {grid}"
        )
    elif grid is not None:
        raise _unknown("map", grid, "a name, a file or an array (row, column) of booleans")
    return with_overrides(found, given) if given else found


def override_texts(overrides: object) -> Iterator[str]:
    """KEY=VALUE of each override; raises `UserError` if it is neither a mapping nor a list."""
    remedy = 'a mapping such as {"horizon": 20}, or a list such as ["horizon=20"]'
    if isinstance(overrides, Mapping):
        for key, value in overrides.items():
            if isinstance(value, Mapping):
                yield from override_texts({f"{key}.{inner}": one for inner, one in value.items()})
            else:
                yield f"{key}={_written(f'set[{key!r}]', value)}"
    elif isinstance(overrides, Sequence) and not isinstance(overrides, str):
        for override in overrides:
            if not isinstance(override, str):
                raise _unknown("set", overrides, remedy)
            yield override
    else:
        raise _unknown("set", overrides, remedy)


def _written(name: str, value: object) -> str:
    """A value as TOML has it, which is JSON's way for all that a key can be."""
    plain = value.tolist() if isinstance(value, np.generic | np.ndarray) else value
    try:
        if plain is None:
            raise TypeError("None")
        return json.dumps(plain, default=_path)
    except (TypeError, ValueError) as error:
        raise _unknown(name, value, "a number, a boolean, a text, or a list of these") from error


def _path(value: object) -> str:
    if isinstance(value, Path):
        return str(value)
    raise TypeError(type(value).__name__)


def _unknown(name: str, value: object, remedy: str) -> UserError:
    return UserError(f"{name} = {reprlib.repr(value)}: is {type(value).__name__}; give {remedy}")
