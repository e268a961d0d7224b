"""`mjforage evaluate`: policies on the same episodes of a scenario, into a run folder."""

import math
import platform
import shlex
import sys
import time
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import polars as pl

import metrics
from graph_planner.policies.registry import create_policy
from mjforage.dynamics.fleet_scene import item_choices
from mjforage.dynamics.worlds import WORLDS
from mjforage.errors import UserError
from mjforage.mission import Mission, Setting
from mjforage.recording import record
from mjforage.scenario_file import scenario_to_tree
from mjforage.storage import Chunk, RunFolder, run_hash, write_json, writing
from mjforage.studies.workers import run_chunks
from mjforage.tables import SCALARS

CHUNK = 25  # episodes per unit of work at graph level
PHYSICS_CHUNK = 10  # the same with hulls, which take a second each
BOOTSTRAP_SEED = 0

Progress = Callable[[int, int], None]
Summary = dict[str, dict[str, dict[str, dict[str, Any]]]]


def check_policies(policies: Sequence[str]) -> None:
    """Refuse unknown or repeated names.

    Raises
    ------
    UserError
        Naming the policy and the nearest known one.
    """
    if not policies:
        raise UserError("no policy given; add --policy greedy")
    for name in policies:
        try:
            create_policy(name)
        except KeyError as error:
            raise UserError(str(error.args[0])) from error
        if list(policies).count(name) > 1:
            raise UserError(f"policy {name}: given twice")


def pinned(setting: Setting) -> Setting:
    """The same setting with the starts beside its map written into its scenario.

    So that `run.json` alone says what was run, whatever becomes of the map's files.
    """
    choice = replace(setting.scenario.map, starts=setting.start_cells)
    return replace(setting, scenario=replace(setting.scenario, map=choice))


def hull_facts(setting: Setting, worlds: Sequence[str]) -> dict[str, Any]:
    """Parameters of every vessel and class of debris that the run needs; none at graph level."""
    if set(worlds) <= {"graph"}:
        return {}
    from mjforage.dynamics.fleet_scene import fleet_vessels, hull_names  # MuJoCo where it is wanted
    from mjforage.scene import load_debris

    choice = setting.scenario.physics
    names, vessels = hull_names(setting.fleet, choice), fleet_vessels(setting.fleet, choice)
    return {
        "vessels": {name: asdict(vessel) for name, vessel in zip(names, vessels, strict=True)},
        "debris": [asdict(kind) for kind in load_debris() if kind.name in choice.item_classes],
    }


def run_info(
    setting: Setting, policies: Sequence[str], worlds: Sequence[str], episodes: int, seed: int
) -> dict[str, Any]:
    """Content of `run.json` before the run: what it is and where it comes from."""
    navigable = setting.grid.navigable
    info: dict[str, Any] = {
        "command": shlex.join(["mjforage", *sys.argv[1:]]),
        "scenario": scenario_to_tree(setting.scenario),
        "map": {
            "name": setting.grid.name,
            "rows": navigable.shape[0],
            "columns": navigable.shape[1],
            "nodes": len(setting.graph),
            "pitch_m": setting.scenario.map.pitch_m,
            "navigable": ["".join("01"[int(cell)] for cell in row) for row in navigable],
        },
        "versions": {name: version(name) for name in ("mjforage", "mujoco", "numpy", "numba")}
        | {"python": platform.python_version()},
        "seed": seed,
        "episodes": episodes,
        "worlds": list(worlds),
        "policies": list(policies),
        "agents": [
            {"name": name, "team": setting.fleet.team_names[team], "collects": bool(collects)}
            for name, team, collects in zip(
                setting.fleet.names, setting.fleet.team, setting.fleet.collects, strict=True
            )
        ],
        "hulls": hull_facts(setting, worlds),
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "timings": {},
    }
    return info | {"hash": run_hash(info)}


def plan(policies: Sequence[str], worlds: Sequence[str], episodes: int) -> list[Chunk]:
    """All chunks of a run, in the order of its tables."""
    size = {world: CHUNK if world == "graph" else PHYSICS_CHUNK for world in worlds}
    return [
        Chunk(world, policy, first, min(size[world], episodes - first))
        for world in worlds
        for policy in policies
        for first in range(0, episodes, size[world])
    ]


def summarise(table: pl.DataFrame) -> Summary:
    """`summary.json` of an episodes table: world, policy, metric -> mean, sem, ci95, iqm, n.

    Undefined numbers are None; `ci95` is a bootstrap percentile interval of the mean.
    """
    summary: Summary = {}
    for (world, policy), rows in table.group_by("world", "policy", maintain_order=True):
        values = rows.sort("episode").select(SCALARS).to_numpy().T
        found = metrics.summarise(values, BOOTSTRAP_SEED)
        mean, sem, low, high, iqm = (
            [number if math.isfinite(number) else None for number in column.tolist()]
            for column in (found.mean, found.sem, found.low, found.high, found.iqm)
        )
        summary.setdefault(str(world), {})[str(policy)] = {
            key: {
                "mean": mean[i],
                "sem": sem[i],
                "ci95": [low[i], high[i]],
                "iqm": iqm[i],
                "n": int(found.n[i]),
            }
            for i, key in enumerate(SCALARS)
        }
    return summary


def evaluate(
    setting: Setting,
    policies: Sequence[str],
    folder: Path,
    *,
    episodes: int = 100,
    seed: int = 0,
    jobs: int = 1,
    worlds: Sequence[str] = ("graph",),
    progress: Progress = lambda done, total: None,
) -> Summary:
    """Run policies on the same episodes and leave a complete run folder.

    Parameters
    ----------
    setting : scenario and map
    policies, worlds : names
    folder : run folder; an unfinished run of the same settings in it is resumed
    episodes : episodes per policy and world, 1 or more
    seed : of the run
    jobs : worker processes
    progress : called with (episodes done, episodes in all)

    Returns
    -------
    The content of `summary.json`.

    Raises
    ------
    UserError
        For unknown names, a folder that holds something else, or a failure to write.
    """
    check_policies(policies)
    for world in worlds:
        if world not in WORLDS:
            raise UserError(f"world {world}: unknown; choose {', '.join(WORLDS)}")
        Mission(setting, world)  # what cannot be run says so before anything is written
    if episodes < 1 or jobs < 1 or not 0 <= seed < 1 << 64:
        raise UserError(
            f"episodes {episodes}, jobs {jobs}, seed {seed}: give at least 1, 1 and 0 (below 2**64)"
        )
    item_choices(setting.scenario.physics)  # which replays need, also at graph level
    started, setting = time.perf_counter(), pinned(setting)
    info = run_info(setting, policies, worlds, episodes, seed)
    run = RunFolder(folder)
    run.open(info)
    chunks = plan(policies, worlds, episodes)
    with run.claimed():
        if not run.complete:
            _compute(run, setting, chunks, seed, jobs, progress)
            run.merge(chunks)
            timings = run.timings(chunks)
            info["timings"] = timings | {"wall_s": time.perf_counter() - started}
            write_json(folder / "run.json", info)
        summary = summarise(run.episodes(chunks))
        _record(run, setting, policies, worlds, seed)
        write_json(folder / "summary.json", summary)
        run.finish(chunks)
    return summary


def _compute(
    run: RunFolder,
    setting: Setting,
    chunks: list[Chunk],
    seed: int,
    jobs: int,
    progress: Progress,
) -> None:
    missing = [chunk for chunk in chunks if not run.has(chunk)]
    total = sum(chunk.count for chunk in chunks)
    done = total - sum(chunk.count for chunk in missing)
    progress(done, total)
    for count in run_chunks(setting, seed, missing, run.path, jobs):
        done += count
        progress(done, total)


def _record(
    run: RunFolder, setting: Setting, policies: Sequence[str], worlds: Sequence[str], seed: int
) -> None:
    """Keep the first episode of every policy and world for the report and the web replay."""
    folder = run.path / "replay"
    for world in worlds:
        for policy in policies:
            path = folder / f"{world}-{policy}-0.npz"
            with writing(path):
                folder.mkdir(exist_ok=True)
                if not zipfile.is_zipfile(path):  # missing or truncated
                    record(setting, world, policy, seed, 0).save(path)
