"""Studies made up: run folders by chance under one roof, with metrics that a test chooses."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.runs.studies.study import variant_folder
from mjforage.view.report.studies.study_logs import StudyLogs, load_study
from tests.mjforage.view.report.known_data import summary_of
from tests.mjforage.view.report.made_up_episodes import Plan
from tests.mjforage.view.report.made_up_runs import build

Values = Mapping[tuple[str, str, str], NDArray[np.float64]]
"""Variant, policy and metric -> (episode,)."""


def made_up_study(
    folder: Path,
    variants: Mapping[str, Sequence[str]],
    episodes: int,
    kind: str = "communication",
    **more: object,
) -> StudyLogs:
    """A study at graph level: name of a variant -> who plays it. All variants are alike.

    Parameters
    ----------
    more : other keys of `study.json`
    """
    for name, policies in variants.items():
        variant_folder(folder, name).parent.mkdir(parents=True, exist_ok=True)
        build(variant_folder(folder, name), Plan(tuple(policies), episodes=episodes))
    info = {
        "command": "mjforage study",
        "started": "2025-01-01T12:00:00+00:00",
        "kind": kind,
        "scenario": {"name": "comb-port"},
        "variants": {n: {"title": f"is {n}", "policies": list(p)} for n, p in variants.items()},
        "worlds": ["graph"],
        "episodes": episodes,
        "seed": 0,
        "options": {},
    } | more
    (folder / "study.json").write_text(json.dumps(info))
    summaries = {
        name: json.loads((variant_folder(folder, name) / "summary.json").read_text())
        for name in variants
    }
    (folder / "summary.json").write_text(json.dumps(summaries))
    return load_study(folder)


def with_values(logs: StudyLogs, values: Values) -> StudyLogs:
    """The study with other values of some metrics, and their summaries."""
    runs = dict(logs.runs)
    for (variant, policy, key), numbers in values.items():
        run = runs[variant]
        table = run.episodes.sort("policy", "episode")
        if key not in table.columns:
            table = table.with_columns(pl.lit(None, pl.Float64).alias(key))
        changed = table[key].to_numpy().copy()
        changed[(table["policy"] == policy).to_numpy()] = numbers
        one = {key: summary_of(numbers, key)}
        own = run.summary["graph"]
        runs[variant] = replace(
            run,
            episodes=table.with_columns(pl.Series(key, changed).fill_nan(None)),
            summary={"graph": own | {policy: own[policy] | one}},
        )
    return replace(logs, runs=runs)


def without(logs: StudyLogs, key: str) -> StudyLogs:
    """The study as if it had been made without a metric."""
    runs = {n: replace(run, episodes=run.episodes.drop(key)) for n, run in logs.runs.items()}
    return replace(logs, runs=runs)
