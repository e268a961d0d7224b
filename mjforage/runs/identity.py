"""What a run is: the content of `run.json`, whose hash every worker must agree with."""

import hashlib
import platform
import shlex
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import controllers
import graph_planner
import metrics
from graph_planner.policies.registry import is_bound, policy_files
from mjforage.core.assets import models_folder
from mjforage.core.mission import Setup
from mjforage.core.mission_metrics import chosen_metrics, description
from mjforage.core.scenario_file import scenario_to_tree
from mjforage.runs.storage import run_hash


def pinned(setup: Setup) -> Setup:
    """The same setup with the starts beside its map written into its scenario.

    So that `run.json` alone says what was run, whatever becomes of the map's files.
    """
    choice = replace(setup.scenario.map, starts=setup.start_cells)
    return replace(setup, scenario=replace(setup.scenario, map=choice))


@lru_cache(maxsize=1)
def fingerprint() -> str:
    """Hash of the installed code, maps and weights, which versions alone do not tell apart."""
    digest = hashlib.sha256()
    packages = (metrics, controllers, graph_planner)
    folders = [Path(str(package.__file__)).parent for package in packages]
    folders.append(Path(__file__).parents[1])
    for root in (*folders, models_folder()):
        pattern = "*" if root == models_folder() else "*.py"
        for path in sorted(root.rglob(pattern)):
            if path.is_file():
                digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def versions() -> dict[str, str]:
    """Versions of what decides a run's numbers, in this process; `code` is `fingerprint`."""
    return {name: version(name) for name in ("mjforage", "mujoco", "numpy", "numba")} | {
        "python": platform.python_version(),
        "code": fingerprint(),
    }


def provenance() -> dict[str, str]:
    """Command, and time of its start."""
    return {
        "command": shlex.join(["mjforage", *sys.argv[1:]]),
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def hull_facts(setup: Setup, worlds: Sequence[str]) -> dict[str, Any]:
    """Parameters of every vessel and class of debris that the run needs; none at graph level."""
    if set(worlds) <= {"graph"}:
        return {}
    from mjforage.physics.dynamics.fleet_scene import (  # MuJoCo where it is wanted
        fleet_vessels,
        hull_names,
    )
    from mjforage.physics.scene import load_debris

    choice = setup.scenario.physics
    names, vessels = hull_names(setup.fleet, choice), fleet_vessels(setup.fleet, choice)
    return {
        "vessels": {name: asdict(vessel) for name, vessel in zip(names, vessels, strict=True)},
        "debris": [asdict(kind) for kind in load_debris() if kind.name in choice.item_classes],
    }


def weight_hashes(policies: Sequence[str]) -> dict[str, str]:
    """Hash of the files that every policy's moves hang on: they change under the same name."""
    found = {name: policy_files(name) for name in policies}
    return {
        name: hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]
        for name, paths in found.items()
        if paths
    }


def run_info(
    setup: Setup, policies: Sequence[str], worlds: Sequence[str], episodes: int, seed: int
) -> dict[str, Any]:
    """Content of `run.json` before the run: what it is and where it comes from."""
    navigable = setup.grid.navigable
    origin = provenance()
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
        },
        "versions": versions(),
        "seed": seed,
        "episodes": episodes,
        "worlds": list(worlds),
        "policies": list(policies),
        "bounds": [name for name in policies if is_bound(name)],
        "weights": weight_hashes(policies),
        "metrics": [asdict(description(one)) for one in chosen_metrics()],
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
