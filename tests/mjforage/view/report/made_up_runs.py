"""A run folder made up by chance, with the files and columns that evaluate writes."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.base.atomic_files import write_bytes
from mjforage.runs.selection import recording_file
from tests.mjforage.view.report.made_up_episodes import FLOATS, Plan, made_up_episode, port


def _summarise(values: NDArray[np.float64]) -> dict[str, Any]:
    values = values[np.isfinite(values)]
    if not len(values):
        return {"mean": None, "sem": None, "ci95": [None, None], "iqm": None, "n": 0}
    sem = float(values.std(ddof=1) / math.sqrt(len(values))) if len(values) > 1 else None
    mean, wide = float(values.mean()), 1.9 * (sem or 0.0)
    middle = np.sort(values)[len(values) // 4 : len(values) - len(values) // 4]
    return {
        "mean": mean,
        "sem": sem,
        "ci95": [mean - wide, mean + wide],
        "iqm": float(middle.mean()),
        "n": len(values),
    }


def _run_json(plan: Plan) -> dict[str, Any]:
    mask = port(plan.shape)
    agents = [
        {"name": f"{team}_{i}", "team": team, "collects": team == "foragers"}
        for team, count in (("scouts", plan.scouts), ("foragers", plan.foragers))
        for i in range(count)
    ]
    teams = {
        "scouts": {
            "count": plan.scouts,
            "moves": 2,
            "radius": 4.0,
            "collects": False,
            "energy": None,
        },
        "foragers": {
            "count": plan.foragers,
            "moves": 1,
            "radius": 1.0,
            "collects": True,
            "energy": None,
        },
    }
    return {
        "command": f"mjforage evaluate {plan.name} --episodes {plan.episodes}",
        "scenario": {
            "name": plan.name,
            "map": {
                "file": "comb-port.csv",
                "pitch_m": 4.0,
                "corner_cutting": False,
                "starts": [[2, 2]],
            },
            "teams": teams,
            "items": {"mean": 75.0, "std": 10.0},
            "horizon": plan.horizon,
            "period_s": 10.0,
        },
        "hash": "5f2c" * 16,
        "versions": {"mjforage": "0.1.0", "mujoco": "3.17.0", "numpy": "2.4.6", "python": "3.11.7"},
        "seed": 0,
        "episodes": plan.episodes,
        "worlds": list(plan.worlds),
        "policies": list(plan.policies),
        "bounds": [policy for policy in plan.policies if policy == "oracle"],
        "told": {policy: "the items" for policy in plan.policies if policy == "oracle"},
        "agents": agents,
        "map": {
            "name": "comb-port",
            "rows": plan.shape[0],
            "columns": plan.shape[1],
            "nodes": int(mask.sum()),
            "pitch_m": 4.0,
            "navigable": ["".join(str(int(cell)) for cell in row) for row in mask],
        },
        "started": "2025-01-01T12:00:00+00:00",
        "hulls": {},
        "timings": {"wall_s": 12.5, "cpu_s": 20.25},
    }


NULLABLE = dict.fromkeys(("t_discovered", "discovered_by", "t_collected", "collected_by"), pl.Int64)


def build(folder: Path, plan: Plan) -> Path:
    """Write a whole run folder and return it."""
    tables: dict[str, list[dict[str, Any]]] = {
        n: [] for n in ("episodes", "steps", "items", "agents")
    }
    (folder / "replay").mkdir(parents=True)
    for world in plan.worlds:
        for rank, policy in enumerate(plan.policies):
            for episode in range(plan.episodes):
                made = made_up_episode(plan, world, policy, episode, 1.6 / (1 + 0.3 * rank))
                for name, rows in made.tables.items():
                    tables[name] += rows
                if episode in plan.kept and policy in (plan.replays or plan.policies):
                    write_bytes(
                        recording_file(folder, world, policy, episode), made.replay.content()
                    )
    frames = {
        name: pl.DataFrame(
            rows, infer_schema_length=None, schema_overrides=NULLABLE if name == "items" else None
        )
        for name, rows in tables.items()
        if rows
    }
    whole, number = (
        ("episode", "step", "agent", "direction", "collisions"),
        ("x_m", "y_m", "speed_mps"),
    )
    empty: dict[str, type[pl.DataType]] = dict.fromkeys(("world", "policy"), pl.String)
    empty |= dict.fromkeys(whole, pl.Int64)
    empty |= dict.fromkeys((*number, "impact_mps", "work_j"), pl.Float64)
    frames.setdefault("agents", pl.DataFrame(schema=empty))
    for name, frame in frames.items():
        frame.write_parquet(folder / f"{name}.parquet")
    summary = {
        world: {
            policy: {
                key: _summarise(
                    frames["episodes"]
                    .filter((pl.col("world") == world) & (pl.col("policy") == policy))[key]
                    .to_numpy()
                )
                for key in FLOATS
            }
            for policy in plan.policies
        }
        for world in plan.worlds
    }
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "run.json").write_text(json.dumps(_run_json(plan)))
    return folder
