"""Studies made up: run folders by chance under one roof, with metrics that a test chooses."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.metrics import summarise
from mjforage.runs.study import variant_folder
from mjforage.view.report.run_logs import Summary
from mjforage.view.report.studies.study_logs import StudyLogs, load_study
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
    tables, summaries = dict(logs.episodes), dict(logs.summaries)
    for (variant, policy, key), numbers in values.items():
        table = tables[variant].sort("policy", "episode")
        if key not in table.columns:
            table = table.with_columns(pl.lit(None, pl.Float64).alias(key))
        changed = table[key].to_numpy().copy()
        changed[(table["policy"] == policy).to_numpy()] = numbers
        tables[variant] = table.with_columns(pl.Series(key, changed).fill_nan(None))
        found = summarise(numbers, 0)
        mean, sem, low, high, iqm = (
            float(one) for one in (found.mean, found.sem, found.low, found.high, found.iqm)
        )
        one = Summary(mean, sem, low, high, iqm, int(found.n))
        metrics = summaries[variant]["graph"][policy] | {key: one}
        summaries[variant] = {"graph": summaries[variant]["graph"] | {policy: metrics}}
    return replace(logs, episodes=tables, summaries=summaries)


def without(logs: StudyLogs, key: str) -> StudyLogs:
    """The study as if it had been made without a metric."""
    return replace(logs, episodes={n: table.drop(key) for n, table in logs.episodes.items()})
