"""Content of `run.json`, checked: policies, map, fleet, code and time of a run."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from annotated_types import MaxLen, MinLen
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.fields import Note, Within
from mjforage.mission.scoring import Description
from mjforage.runs.foreign import check_files, check_length, check_names
from mjforage.scenario.maps import GridMap
from mjforage.scenario.place import Place
from mjforage.scenario.schema import OPEN, check

AGAIN = "run what made this folder again"
REMEDY = f"{AGAIN}, or name a folder that evaluate, compare or study wrote"

Names = Annotated[tuple[str, ...], MinLen(1)]
MOST_AGENTS = 255  # of a scenario


@dataclass(frozen=True)
class Agent:
    """One vessel of the fleet; its index is its place in the list."""

    name: str
    """Team and number, as in `scouts_0`."""
    team: str
    """Name of its team."""
    collects: bool
    """True if it removes items."""


@dataclass(frozen=True)
class MapInfo:
    """The map that was run on."""

    name: str
    """Name of the map."""
    rows: int
    """Rows of the grid."""
    columns: int
    """Columns of the grid."""
    nodes: int
    """Navigable cells."""
    pitch_m: Annotated[float, Note("unit", "m")]
    """Distance between the centres of neighbouring nodes."""
    navigable: tuple[str, ...]
    """A text per row, with a 1 for each cell of water and a 0 for land."""

    place: Place | None = None
    """Place on the globe; absent of a map that is no place."""
    record: str = ""
    """SHA-256 of the file of `weather.file`; absent without one."""

    @property
    def grid(self) -> GridMap:
        """The map as a scenario has it."""
        return GridMap(self.name, self.cells, self.place)

    @cached_property
    def cells(self) -> NDArray[np.bool_]:
        """(row, column) whether a cell is water."""
        cells = [[cell == "1" for cell in line] for line in self.navigable]
        return np.array(cells, dtype=np.bool_).reshape(self.rows, self.columns)


@dataclass(frozen=True)
class HullFacts:
    """Parameters of a vessel as it ran."""

    length_m: Annotated[float, Note("unit", "m")]
    """Length of the hull."""


@dataclass(frozen=True)
class Hulls:
    """Vessels and items of the physics worlds; empty for the paper's rules on the graph."""

    vessels: Mapping[str, HullFacts] = field(default_factory=dict)
    """Vessels by name, with all their parameters."""
    debris: tuple[Mapping[str, Any], ...] = ()
    """Classes of items, with all their parameters."""
    captures: Mapping[str, Any] = field(default_factory=dict)
    """Capture models by vessel, where items can be missed; without its own the forager's."""


@dataclass(frozen=True)
class RunInfo:
    """Content of `run.json`; `scenario` stays as it is, to be shown and to be checked anew."""

    __pydantic_config__ = OPEN

    command: str
    """The command that made the folder, or words on the call in Python."""
    scenario: Mapping[str, Any]
    """The whole scenario, defaults included."""
    map: MapInfo
    versions: Mapping[str, str]
    """Versions of what decides the numbers."""
    seed: int
    """Seed of the run."""
    episodes: int
    """Episodes per world and policy."""
    worlds: Names
    """Worlds that were run."""
    policies: Names
    """Policies that were run."""
    agents: Annotated[tuple[Agent, ...], MaxLen(MOST_AGENTS)]
    """The fleet."""
    hulls: Hulls
    started: str
    """Time of the command, ISO 8601."""
    timings: Mapping[str, float]
    """Computing time: processor and wall-clock seconds, and decisions; empty before the end."""
    hash: str
    """Hash of scenario, map, hulls and code, that workers must agree with."""
    bounds: tuple[str, ...] = ()
    """Policies that see the truth (oracle bounds)."""
    told: Mapping[str, str] = field(default_factory=dict)
    """Policy -> what it is told of the items before an episode, of those that are."""
    classes: Mapping[str, str] = field(default_factory=dict)
    """Policy -> package.module:Class, of those that are not ours."""
    weights: Mapping[str, str] = field(default_factory=dict)
    """Policy -> hash of the files that its moves depend on."""
    metrics: tuple[Description, ...] = ()
    """Display of each metric; none in a run made before metrics were listed."""

    @property
    def horizon(self) -> int:
        """Steps T by which times are normalised."""
        return int(self.scenario["horizon"])

    @property
    def period_s(self) -> float:
        """Seconds of a step."""
        return float(self.scenario["period_s"])

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return str(self.scenario["name"])

    @property
    def hull_lengths(self) -> dict[str, float]:
        """Name of a vessel -> [m]; empty at graph level."""
        return {name: facts.length_m for name, facts in self.hulls.vessels.items()}


@dataclass(frozen=True)
class _ScenarioFacts:
    """Facts of a scenario that a run's reader needs; the scenario may be of an older version."""

    __pydantic_config__ = OPEN

    name: str
    horizon: Annotated[int, Within(1, 30_000)]
    period_s: Annotated[float, Within(1e-3, 1e6, "s")]


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON object.

    Raises `UserError` if the file is missing, not readable, truncated or not an object.
    """
    check_length(path, REMEDY)
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise UserError(f"{path}: file is missing; {REMEDY}") from error
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{path}: cannot be read as JSON ({error}); {REMEDY}") from error
    if not isinstance(value, dict):
        raise UserError(f"{path}: holds a {type(value).__name__}, expected an object; {REMEDY}")
    return value


def load_run(path: Path) -> RunInfo:
    """Read `run.json`.

    Raises `UserError` if the file or one of its keys is missing or malformed, a name in it could be
    a path, or a link is in its folder.
    """
    where = str(path)
    check_files(path)
    run = check(RunInfo, read_json(path), where, remedy=REMEDY)
    check(_ScenarioFacts, run.scenario, f"{where}: scenario", remedy=REMEDY)
    teams = run.scenario.get("team", {})
    check_names(
        where,
        {
            "worlds": run.worlds,
            "agents": [name for agent in run.agents for name in (agent.name, agent.team)],
            "scenario.team": teams if isinstance(teams, Mapping) else [teams],
        },
    )
    shape, lines = (run.map.rows, run.map.columns), run.map.navigable
    if len(lines) != shape[0] or any(len(one) != shape[1] or set(one) - set("01") for one in lines):
        raise UserError(
            f"{where}: map.navigable is not {shape[0]} strings of {shape[1]} zeros and ones; "
            f"{REMEDY}"
        )
    return run
