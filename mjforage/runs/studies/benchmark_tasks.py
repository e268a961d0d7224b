"""Benchmark tasks: a scenario on a map in a world, in one word such as `comb-port@physics`."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mjforage.base.errors import UserError
from mjforage.base.references import file_label, nearest
from mjforage.mission.setup import Setup
from mjforage.physics.vessel_moves import open_setup
from mjforage.physics.worlds import WORLDS
from mjforage.runs.identity import pinned
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

USUAL = (
    *("comb-port", "published", "open-bay", "channels", "comb-port-weather", "comb-port-radio"),
    *("comb-port-few", "comb-port-clusters", "comb-port@physics", "comb-port-weather@physics"),
)
"""Tasks of the board unless others are named."""
RULES = "comb-port"  # of tasks on a map
USUAL_WORLD = "graph"


@dataclass(frozen=True)
class BenchmarkTask:
    """A scenario with its map, in one world.

    Attributes
    ----------
    name : of a folder, and how it is spelled in tables
    """

    name: str
    setup: Setup
    world: str


def _parted(text: str) -> tuple[str, str, str]:
    """Scenario of a task, its world, and the world's suffix after a name.

    Raises `UserError` if there is no such world.
    """
    start, sign, world = text.rpartition("@")
    if not sign:
        return text, USUAL_WORLD, ""
    if world not in WORLDS:
        raise UserError(f"course {text}: no world {world!r} after the @; {nearest(world, WORLDS)}")
    return start, world, "" if world == USUAL_WORLD else f"@{world}"


def task_of_scenario(text: str, overrides: Sequence[str] = ()) -> BenchmarkTask:
    """A benchmark task of a scenario.

    Raises `UserError` if the scenario or world is unknown or cannot be used.

    Parameters
    ----------
    text : SCENARIO or SCENARIO@WORLD: name of a preset or path of a TOML file, in the graph world
        unless another is named
    overrides : `KEY=VALUE`, as of `load_scenario`
    """
    reference, world, end = _parted(text)
    scenario = load_scenario(reference, overrides)
    return BenchmarkTask(file_label(scenario.name) + end, pinned(open_setup(scenario)), world)


def task_on_map(text: str, overrides: Sequence[str] = ()) -> BenchmarkTask:
    """A task by the rules of `RULES` on another map, with the starts beside it or random ones.

    Raises `UserError` if the map or world is unknown or cannot be used.

    `text`: MAP or MAP@WORLD: name, table, grid or image; `overrides`: as of `task_of_scenario`.
    """
    file, world, end = _parted(text)
    scenario = _without_starts(load_scenario(RULES, overrides, file))
    setup = pinned(open_setup(scenario))
    return BenchmarkTask(file_label(f"{RULES}-on-{setup.grid.name}") + end, setup, world)


def _without_starts(scenario: Scenario) -> Scenario:
    """Without the starts of `RULES`, which are of its own map; others were asked for and stay."""
    if scenario.map.starts != load_scenario(RULES).map.starts:
        return scenario
    return replace(scenario, map=replace(scenario.map, starts=None))


def benchmark_tasks(
    scenarios: Sequence[str], maps: Sequence[str], overrides: Sequence[str] = ()
) -> tuple[BenchmarkTask, ...]:
    """Benchmark tasks of scenarios, the usual ones if none is named, then of maps.

    Raises `UserError` as `task_of_scenario` and `task_on_map`, or if two are the same.
    """
    found = [task_of_scenario(one, overrides) for one in scenarios or USUAL]
    found += [task_on_map(one, overrides) for one in maps]
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise UserError(f"course {name}: given twice; give it once")
    return tuple(found)
