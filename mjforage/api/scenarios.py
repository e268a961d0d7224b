"""Scenarios as a user of Python has them: names, files and objects."""

import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, get_args

import numpy as np
import tomli_w
from numpy.typing import ArrayLike

from mjforage.api import checks
from mjforage.api.checks import Named
from mjforage.api.maps import Map
from mjforage.api.vessels import vessel_file, vessel_folder
from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.mission.setup import Setup
from mjforage.physics.vessel_moves import with_moves
from mjforage.physics.vessels import Vessel
from mjforage.scenario import scenario_file
from mjforage.scenario.harbours import is_harbour
from mjforage.scenario.map_files import is_shipped_map
from mjforage.scenario.maps import PITCH_M, GridMap, load_map
from mjforage.scenario.place import is_place
from mjforage.scenario.scenario import Device
from mjforage.scenario.scenario import Scenario as Settings

VAR_KEYWORD = Parameter.VAR_KEYWORD


@dataclass(frozen=True, eq=False, repr=False)
class Scenario(Setup):
    """A scenario with its map, checked; immutable.

    Made by `load_scenario` and `Scenario.replace`. Its keys are those of a scenario file, see
    docs/reference/scenario.md.

    Examples
    --------
    >>> import mjforage as mf
    >>> mf.load_scenario("comb-port", horizon=60)
    Scenario(comb-port, 62 x 46 at 4 m, 2 scouts + 2 foragers, 60 decisions of 10 s)
    """

    @property
    def name(self) -> str:
        """Name, which tables and folders have."""
        return self.scenario.name

    @property
    def map(self) -> Map:
        """The map with its pitch and starts."""
        how: dict[str, Any] = {"pitch_m": self.scenario.map.pitch_m, "starts": self.start_cells}
        return Map.of(self.grid, **how)

    def replace(
        self,
        *,
        map: "Map | Named | ArrayLike | Mapping[str, Any] | None" = None,
        **changes: Any,
    ) -> "Scenario":
        """The scenario with other values of some keys; tables as dicts, of which the rest stays.

        Parameters
        ----------
        map : another grid: a `Map`, a name, a file, or an array (rows, columns), True for water. It
            brings its own starts; the command line's `--map` keeps those of the scenario, as does
            ``map={"file": ...}``, a dict of the table's keys
        changes : keys of a scenario file, such as ``horizon=60`` or
            ``weather={"wind_speed_mps": 5.0}``; vessels of teams are
            ``physics={"vessels": {"scouts": "otter"}}``, by name, file or `Vessel`

        Raises
        ------
        UserError
            For an unknown key, a wrong type, or a value out of range.
        """
        return _changed(self.asked, self.grid, map, changes)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Setup):
            return NotImplemented
        same = np.array_equal(self.grid.navigable, other.grid.navigable)
        return same and self.to_dict() == scenario_file.scenario_to_tree(other.scenario)

    def __hash__(self) -> int:
        return hash((self.name, self.grid.navigable.tobytes()))

    def __deepcopy__(self, memo: object) -> "Scenario":
        return self  # nothing changes it

    def __reduce__(self) -> Any:
        return _rebuilt, (self.to_dict(), self.grid, self.following)

    def to_dict(self) -> dict[str, Any]:
        """All keys with their values, defaults included; tables as dicts. A copy."""
        return scenario_file.scenario_to_tree(self.scenario)

    def to_file(self, path: Named) -> Path:
        """Write a scenario file, with the map beside it unless it ships or can be generated.

        Raises
        ------
        UserError
            If a file cannot be written.
        """
        target = checks.path("path", path)
        tree = _present(self.to_dict())
        file = self.scenario.map.file
        if not (is_shipped_map(file) or is_harbour(file)) or not reads_as(self):
            end = "place" if self.grid.place else "map.csv"
            table = self.map.to_file(target.with_name(f"{target.stem}.{end}"))
            tree["map"] |= {"file": table.name, "water": "light"}
        tree["map"]["starts"] = [list(cell) for cell in self.start_cells]
        vessels = tree["physics"].get("vessels", {})
        tree["physics"]["vessels"] = {team: _beside(target, one) for team, one in vessels.items()}
        with atomic_write(target) as beside:
            beside.write_text(tomli_w.dumps(tree), encoding="utf-8")
        return target

    def export(self, folder: Named, to: str, *, seed: int = 0, episode: int = 0) -> Path:
        """Write the start of an episode in a format of other programs.

        Parameters
        ----------
        folder : empty or not there yet
        to : "csv", "geojson", "gpx", "mcap" (ROS 2), "mjcf" (a scene for MuJoCo), "netcdf", or
            "qgc" (mission files of ArduPilot)
        seed, episode : as of `Mission.reset`

        Raises
        ------
        UserError
            If there is no such format, the folder holds something, or a vessel does not fit.
        """
        from mjforage.runs.exporting import write_export
        from mjforage.runs.recording import record

        which = (
            checks.whole("seed", seed, 0, 2**64 - 1),
            checks.whole("episode", episode, 0, 2**63 - 1),
        )
        where = checks.path("folder", folder), checks.text("to", to)
        return write_export(self, lambda: record(self, "graph", None, *which), *where)

    def __repr__(self) -> str:
        rows, columns = self.grid.navigable.shape
        settings = self.scenario
        return (
            f"Scenario({self.name}, {rows} x {columns} at {settings.map.pitch_m:g} m, "
            f"{' + '.join(f'{role.count} {team}' for team, role in settings.team.items())}, "
            f"{settings.horizon} decisions of {settings.period_s:g} s)"
        )


def _rebuilt(tree: dict[str, Any], grid: GridMap, following: tuple[str, ...]) -> Scenario:
    """The scenario that another process had."""
    return Scenario(scenario_file.scenario_from_tree(tree, "scenario"), grid, following)


def load_scenario(
    reference: Named = "comb-port",
    *,
    map: Map | Named | ArrayLike | Mapping[str, Any] | None = None,
    **changes: Any,
) -> Scenario:
    """Read a scenario that ships, or a file, and change some of its keys.

    Parameters
    ----------
    reference : name of a shipped scenario (`mf.names("scenarios")`), or a TOML file
    map, changes : as of `Scenario.replace`

    Raises
    ------
    UserError
        If there is none of that name, or it is not valid.

    Examples
    --------
    >>> import mjforage as mf
    >>> windy = mf.load_scenario("open-bay", weather={"wind_speed_mps": 5.0})
    >>> windy.to_dict()["weather"]["wind_speed_mps"]
    5.0
    """
    if not isinstance(reference, str | os.PathLike):
        raise TypeError(f"scenario is {type(reference).__name__}; give a name or a TOML file")
    return _changed(scenario_file.load_scenario(os.fspath(reference)), None, map, changes)


def reads_as(setup: Setup) -> bool:
    """True if the name or file of a scenario's map reads as the map that it has."""
    choice = setup.scenario.map
    try:
        found = load_map(
            choice.file,
            water=choice.water,
            corner_cutting=choice.corner_cutting,
            largest_component=choice.largest_component,
        )
    except UserError:
        return False
    same = np.array_equal(found.charted, setup.grid.charted)
    return same and found.place == setup.grid.place


def scenario_of(
    given: "Setup | Named", changes: Mapping[str, Any], call: Callable[..., Any] | None = None
) -> Setup:
    """A scenario given as an object, a name or a file, with some keys changed.

    Raises `UserError` as `load_scenario`; of a call's arguments, the nearest option is offered too.
    """
    if call is not None:
        _check_options(changes, call)
    if isinstance(given, Setup):
        found = Scenario(given.scenario, given.grid, given.following)
        return found.replace(**changes) if changes else found
    return load_scenario(given, **changes)


def on_device(setup: Setup, device: Device | None, worlds: Collection[str]) -> Setup:
    """A scenario with its hulls on a device, that of the scenario by default.

    Raises `UserError` if there is no such device, or no hulls in any of the worlds.
    """
    if device is None:
        return setup
    checks.one_of("device", device, get_args(Device))
    if device != "cpu" and set(worlds) <= {"graph"}:
        raise UserError(f"device {device}: the graph world has no hulls; give world=physics")
    return scenario_of(setup, {"physics.device": device})


def _check_options(changes: Mapping[str, Any], call: Callable[..., Any]) -> None:
    """Refuse arguments that are neither options of a call nor keys of a scenario."""
    keys = [each.name for each in fields(Settings)]
    options = [one.name for one in signature(call).parameters.values() if one.kind != VAR_KEYWORD]
    for name in changes:
        if name.partition(".")[0] not in keys:
            close = nearest(name, [*options, *keys])
            raise UserError(f"{call.__name__}: no option or key of a scenario is {name}; {close}")


def _changed(
    scenario: Settings,
    grid: GridMap | None,
    chosen: Any,
    changes: Mapping[str, Any],
) -> Scenario:
    if isinstance(chosen, Mapping):
        changes, chosen = {"map": chosen, **changes}, None
    values = dict(_flat("", changes))
    if isinstance(chosen, str | os.PathLike):
        file, grid = os.fspath(chosen), None
        values = {"map.file": file, "map.water": "light"} | values
        values.setdefault("map.starts", [] if is_harbour(file) else None)
        if is_place(file):
            values.setdefault("map.pitch_m", PITCH_M)
    elif chosen is not None:
        pitch_m = values.get("map.pitch_m", scenario.map.pitch_m)
        found = chosen if isinstance(chosen, Map) else Map(chosen, pitch_m=pitch_m)
        grid = found.grid
        own = {"map.file": found.name, "map.pitch_m": found.pitch_m}
        own["map.starts"] = [list(cell) for cell in found.starts]
        values = own | values
    elif "map.file" in values:
        grid = None
    changed = scenario_file.with_values(scenario, values, f"scenario {scenario.name}")
    if grid is None:
        return Scenario.of(changed, derive=with_moves)
    about = grid.charted, grid.name, grid.place, grid.depth_m
    return Scenario.of(changed, *about, derive=with_moves)


def _flat(start: str, changes: Mapping[str, Any]) -> "list[tuple[str, Any]]":
    """Keys with dots, and their values as a file has them."""
    found: list[tuple[str, Any]] = []
    for key, value in changes.items():
        if isinstance(value, Mapping):
            found += _flat(f"{start}{key}.", value)
        else:
            found.append((f"{start}{key}", _plain(value)))
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Vessel):
        return str(vessel_file(value))
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else value


def _present(tree: Any) -> Any:
    """The tree without keys that are absent."""
    if isinstance(tree, dict):
        return {key: _present(value) for key, value in tree.items() if value is not None}
    return tree


def _beside(scenario: Path, vessel: str) -> str:
    """Name of a vessel as a scenario's file has it; one that is an object is written beside it."""
    if not vessel.endswith(".toml"):
        return vessel
    file = Path(vessel).resolve()
    if not file.is_relative_to(vessel_folder().resolve()):
        return str(file)
    with atomic_write(scenario.with_name(f"{scenario.stem}.{file.name}")) as beside:
        beside.write_bytes(file.read_bytes())
    return f"{scenario.stem}.{file.name}"
