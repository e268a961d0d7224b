"""Identity of a run: the content of `run.json`, whose hash every worker must agree with."""

import hashlib
import platform
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import reduce
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mjforage.base.called import what_was_called
from mjforage.base.registry import ImportSpec
from mjforage.forcing.record_files import read_record
from mjforage.graph_planner.policies.registry import (
    is_upper_bound,
    outside_class,
    policy_class,
    policy_files,
    policy_parts,
    policy_told,
)
from mjforage.mission.scoring import chosen_metrics, description
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import WORLDS
from mjforage.runs.fingerprint import Code, our_code, outside_code
from mjforage.runs.resuming import UNCOMPARED
from mjforage.scenario.capture import load_capture, usual_capture
from mjforage.scenario.map_files import is_shipped_map
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import canonical_json, scenario_to_tree
from mjforage.scenario.sensors import Sensors
from mjforage.scenario.vessel_files import hull_names, vessel_path

WARP = "mujoco-warp", "warp-lang"  # libraries that move hulls on a device


def pinned(setup: Setup) -> Setup:
    """The same setup with the starts beside its map and `whole_paths` in its scenario.

    So that `run.json` alone says what was run, whatever becomes of the map's files, and wherever
    it is read.
    """
    scenario = whole_paths(setup.scenario)
    choice = replace(scenario.map, starts=setup.start_cells)
    return replace(setup, scenario=replace(scenario, map=choice))


def whole_paths(scenario: Scenario) -> Scenario:
    """The scenario with the whole paths of its map, its record and its vessels; names stay.

    Raises
    ------
    UserError
        If the record or a vessel cannot be read.
    """
    choice, weather, physics = scenario.map, scenario.weather, scenario.physics
    if not is_shipped_map(choice.file) and Path(choice.file).exists():
        choice = replace(choice, file=str(Path(choice.file).resolve()))
    if weather.file is not None:
        read_record(weather.file)  # which tells what is no path
        weather = replace(weather, file=str(Path(weather.file).resolve()))
    vessels = {
        team: str(vessel_path(name).resolve()) if name.endswith(".toml") else name
        for team, name in physics.vessels.items()
    }
    physics = replace(physics, vessels=vessels)
    return replace(scenario, map=choice, weather=weather, physics=physics)


def outside_code_of(policies: Iterable[str], classes: Iterable[Callable[..., Any]] = ()) -> Code:
    """Code of policies with their parts, and of classes, as far as it is not ours."""
    parts = [part for name in policies for part in (policy_class(name), *policy_parts(name))]
    return reduce(Code.joined, map(outside_code, [*parts, *classes]), Code({}, {}))


def scenario_parts(scenario: Scenario) -> tuple[Callable[..., Any], ...]:
    """Classes that a scenario names; raises `UserError` for one that the user does not trust."""
    if scenario.sensors.positioning == Sensors.positioning:
        return ()
    from mjforage.physics.positioning import positioning_class  # kernels where they are wanted

    return (positioning_class(scenario.sensors),)


def run_code(
    policies: Iterable[str],
    worlds: Iterable[str],
    classes: Iterable[Callable[..., Any]],
    device: str,
) -> Code:
    """All code that decides a run's numbers, and the libraries that it computes with."""
    names = list(policies)
    libraries = ["mujoco"] if any(world != "graph" for world in worlds) else []
    libraries += WARP if libraries and device != "cpu" else ()
    libraries += [one for name in names for one in policy_libraries(name)]
    return our_code(libraries).joined(outside_code_of(names, classes))


def policy_libraries(name: str) -> tuple[str, ...]:
    """Libraries that a policy computes with, beside those that every run uses."""
    weights = any(file.suffix == ".safetensors" for file in policy_files(name))
    return (*getattr(policy_class(name), "libraries", ()), *(("torch",) if weights else ()))


def versions(code: Code) -> dict[str, str]:
    """Versions in this process: of mjforage, of the computing libraries, and of Python."""
    own = {"mjforage": version("mjforage"), "python": platform.python_version()}
    return own | code.versions


def run_hash(info: Mapping[str, Any]) -> str:
    """Hash of scenario, map, vessels, code and versions: 16 hexadecimal digits."""
    compared = {k: v for k, v in info["versions"].items() if k not in UNCOMPARED}
    own = [info["scenario"], info["map"], compared, info["code"], info.get("hulls")]
    return text_hash(canonical_json(own))


def text_hash(text: str) -> str:
    """Hash of a text: 16 hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def files_hash(paths: Iterable[Path]) -> str:
    """Hash of the contents of files, one after the other: 16 hexadecimal digits."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]


def provenance() -> dict[str, str]:
    """Command, or words on a call in Python; and time of its start."""
    return {
        "command": what_was_called(),
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def hull_facts(setup: Setup, worlds: Sequence[str]) -> dict[str, Any]:
    """Parameters of every vessel and class of debris that the run needs; none at graph level.

    Where items can be missed, the capture models too.
    """
    captures = _captures(setup, worlds)
    if set(worlds) <= {"graph"}:
        return captures
    from mjforage.physics.dynamics.fleet_scene import fleet_vessels  # MuJoCo where it is wanted
    from mjforage.scenario.debris import load_debris

    choice = setup.scenario.physics
    names, vessels = hull_names(setup.fleet, choice), fleet_vessels(setup.fleet, choice)
    return {
        "vessels": {name: asdict(vessel) for name, vessel in zip(names, vessels, strict=True)},
        "debris": [asdict(kind) for kind in load_debris() if kind.name in choice.item_classes],
        **captures,
    }


def _captures(setup: Setup, worlds: Sequence[str]) -> dict[str, Any]:
    """Capture models of the vessels that collect, if items or a planner go by them."""
    adapted = {world: WORLDS[world].adapt(setup.scenario) for world in worlds}
    by_chance = any(scenario.rules.capture == "calibrated" for scenario in adapted.values())
    hulls = adapted.keys() - {"graph"}
    by_mouth = any(adapted[world].physics.capture == "intake" for world in hulls)
    if not by_chance and not by_mouth:
        return {}
    model = load_capture if by_chance else usual_capture
    names = hull_names(setup.fleet, setup.scenario.physics)
    collecting = {names[agent] for agent in setup.fleet.collectors}
    return {"captures": {name: asdict(model(name)) for name in sorted(collecting)}}


def weather_hashes(setup: Setup) -> dict[str, str]:
    """Hash of the record that a scenario plays, as `record`, if it plays one."""
    file = setup.scenario.weather.file
    return {} if file is None else {"record": read_record(file).sha256}


def weight_hashes(policies: Sequence[str]) -> dict[str, str]:
    """Hash of the files that every policy's moves depend on: they change under the same name."""
    found = {name: policy_files(name) for name in policies}
    return {name: files_hash(paths) for name, paths in found.items() if paths}


def run_info(
    setup: Setup,
    policies: Sequence[str],
    worlds: Sequence[str],
    episodes: int,
    seed: int,
    metrics: Iterable[str | ImportSpec] = (),
) -> dict[str, Any]:
    """Content of `run.json` before the run: identity and provenance.

    `metrics`: references, as for `chosen_metrics`.
    """
    navigable = setup.grid.navigable
    metric_classes = chosen_metrics(metrics)
    parts: list[Callable[..., Any]] = [*metric_classes, *scenario_parts(setup.scenario)]
    origin, code = provenance(), run_code(policies, worlds, parts, setup.scenario.physics.device)
    info: dict[str, Any] = {
        "command": origin["command"],
        "scenario": scenario_to_tree(setup.scenario),
        "map": {
            "name": setup.grid.name,
            "rows": navigable.shape[0],
            "columns": navigable.shape[1],
            "nodes": len(setup.graph),
            "pitch_m": setup.scenario.map.pitch_m,
            "navigable": ["".join("01"[int(cell)] for cell in row) for row in navigable],
            **({"place": asdict(setup.grid.place)} if setup.grid.place else {}),
            **weather_hashes(setup),
        },
        "versions": versions(code),
        "code": code.hashes,
        "seed": seed,
        "episodes": episodes,
        "worlds": list(worlds),
        "policies": list(policies),
        "bounds": [name for name in policies if is_upper_bound(name)],
        "told": {name: told for name in policies if (told := policy_told(name))},
        "classes": {
            policy: reference for policy in policies if (reference := outside_class(policy))
        },
        "weights": weight_hashes(policies),
        "metrics": [asdict(description(one)) for one in metric_classes],
        "agents": [
            {"name": name, "team": setup.fleet.team_names[team], "collects": bool(collects)}
            for name, team, collects in zip(
                setup.fleet.names, setup.fleet.team, setup.fleet.collects, strict=True
            )
        ],
        "hulls": hull_facts(setup, worlds),
        "started": origin["started"],
        "timings": {},
    }
    return info | {"hash": run_hash(info)}
