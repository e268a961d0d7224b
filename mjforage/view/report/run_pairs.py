"""Two runs on the same episodes on one page: their replays, and paired differences."""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from mjforage.base.errors import UserError
from mjforage.runs.run_info import RunInfo, read_json
from mjforage.view.page import Row, Table
from mjforage.view.report.contrasts import Contrast, differences_table, every_metric_table
from mjforage.view.report.differences import too_few
from mjforage.view.report.exports import write_page
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.report_page import counted, run_facts
from mjforage.view.report.run_logs import Case, RunLogs, case_name, load_logs
from mjforage.view.report.sections import Page, Section
from mjforage.view.report.shown import PAIRS, only, shown_policies
from mjforage.view.report.text_tables import HEADLINE

SETTINGS = ("scenario", "episodes", "worlds", "policies", "weights", "hulls", "versions", "code")
"""Keys of `run.json` in which two runs on the same episodes may differ."""
START = ("row_start", "col_start")
NEAR = 1e-4  # nodes by which starts of one item may differ
_REMEDY = "name two runs of the same seed, map and items"
_LONGEST = 40  # characters of a setting

Pair = tuple[RunLogs, RunLogs]


def write_pair(first: Path, second: Path, out: Path | None = None) -> Path:
    """Write a page on two runs that share episodes, and its tables.

    Nothing is simulated, and the same logs give the same bytes.

    Parameters
    ----------
    first, second : run folders
    out : folder for ``report.html`` and ``tables/*.csv``; default `compared-with-NAME` in the first

    Raises
    ------
    UserError
        If a log is missing, truncated, foreign or incomplete, the runs share no episodes, or the
        folder cannot be written.
    """
    labels = _labels(first, second)
    out = out or first / f"compared-with-{second.resolve().name}"
    if (out / "run.json").exists() or (out / "study.json").exists():
        raise UserError(f"folder {out}: holds a run or study, whose report stays; choose another")
    runs = load_logs(first), load_logs(second)
    shown = only(runs[0], shown_policies(runs[0])), only(runs[1], shown_policies(runs[1]))
    page = pair_page(runs, shown, labels, shared_episodes(*runs))
    return write_page(out, page, dict(zip(labels, shown, strict=True)))


def _labels(first: Path, second: Path) -> tuple[str, str]:
    """Names of the folders; their paths, where both have one name."""
    one, other = first.resolve(), second.resolve()
    if one == other:
        raise UserError(f"{second}: is the same folder as {first}; name two")
    return (one.name, other.name) if one.name != other.name else (str(first), str(second))


def pair_page(runs: Pair, shown: Pair, labels: tuple[str, str], count: int) -> Page:
    """The page of two runs that share so many episodes.

    Parameters
    ----------
    shown : the runs with the policies that the page has room for
    """
    notes = [
        f"Of {label} {len(few.policies)} policies are shown, the best by PTA_C."
        for label, logs, few in zip(labels, runs, shown, strict=True)
        if few is not logs
    ]
    brief, full = difference_tables(shown, labels, count)
    hulls = hulls_table(dict(zip(labels, shown, strict=True)), count)
    settings = _settings(runs, labels)
    sections = [
        Section("result", brief.title, " ".join(filter(None, (*notes, too_few(count)))), [brief]),
        Section("all", full.title, folded=[full]),
        Section("hulls", hulls.title, folded=[hulls]),
        Section("differing", settings.title, folded=[settings]),
        *(
            Section(f"run-{i}", label, facts=run_facts(logs), texts={"Command": logs.run.command})
            for i, (label, logs) in enumerate(zip(labels, runs, strict=True), 1)
        ),
    ]
    first = runs[0].run
    shared = counted(count, "shared episode")
    lead = f"{shared} with the same items, on map {first.map.name}, seed {first.seed}"
    version = first.versions.get("mjforage", "")
    return Page(" and ".join(labels), lead, sections, version, "report of two runs")


def shared_episodes(first: RunLogs, second: RunLogs) -> int:
    """Number of episodes that two runs share: those with numbers below it.

    Raises
    ------
    UserError
        If they share none, or what should be one episode is not: naming what differs.
    """
    runs = [logs.run for logs in (first, second)]
    facts = ({"map": _map(run), "seed": run.seed, "items": run.scenario["items"]} for run in runs)
    for key, mine, theirs in _differing(*facts):
        raise UserError(_unshared(first, second, f"{key} is {theirs} there and {mine} here"))
    if not np.array_equal(runs[0].map.cells, runs[1].map.cells):
        raise UserError(_unshared(first, second, "cells of the map differ"))
    count = min(run.episodes for run in runs)
    own, other = (logs.cases[0].items(("item", *START)) for logs in (first, second))
    both = own.join(other, on=["episode", "item"], how="full", coalesce=True)
    both = both.filter(pl.col("episode") < count)
    gap = pl.sum_horizontal(
        *((pl.col(key) - pl.col(f"{key}_right")).abs() for key in START), ignore_nulls=False
    )
    moved = both.filter(gap.fill_null(math.inf) > NEAR)
    if moved.height:
        episode = moved["episode"].sort()[0]
        words = f"the items of episode {episode} lie elsewhere, by other code perhaps"
        raise UserError(_unshared(first, second, words))
    return count


def _map(run: RunInfo) -> str:
    return f"{run.map.name}, {run.map.rows} x {run.map.columns}, {run.map.pitch_m:g} m"


def _unshared(first: RunLogs, second: RunLogs, words: str) -> str:
    return f"{second.folder}: shares no episodes with {first.folder}: {words}; {_REMEDY}"


def paired_cases(first: RunLogs, second: RunLogs) -> list[tuple[Case, Case]]:
    """Cases that are compared: the same policy in the same world.

    Where there is none, all policies of one world; and with no world in common, each policy in both
    runs' worlds, or all with all.
    """
    every = [(one, other) for one in first.cases for other in second.cases]
    rules = (
        [(a, b) for a, b in every if (a.world, a.policy) == (b.world, b.policy)],
        [(a, b) for a, b in every if a.world == b.world],
        [(a, b) for a, b in every if a.policy == b.policy],
    )
    return next(filter(None, rules), every)


def difference_tables(runs: Pair, labels: tuple[str, str], count: int) -> tuple[Table, Table]:
    """Differences in the headline metrics, a row for each pair, and in every metric."""
    shared = pl.col("episode") < count
    first, second = (replace(logs, episodes=logs.episodes.filter(shared)) for logs in runs)
    worlds = {world for logs in runs for world in logs.run.worlds}
    contrasts = []
    for pair in paired_cases(first, second)[:PAIRS]:
        one, other = (case_name(x.world, x.policy, worlds, x.logs.run.bounds) for x in pair)
        head = one if one == other else f"{one} − {other}"
        contrasts.append(Contrast(head, *pair, head))
    known = first.metrics.values()
    metrics = [one for one in known if first.defined(one.key) and second.defined(one.key)]
    words = (
        f"{labels[0]} minus {labels[1]}, mean over the {count} shared episodes where both are "
        "defined, with the bootstrap 95 % interval of itself alone"
    )
    headline = [metric for metric in metrics if metric.key in HEADLINE]
    title = f"{labels[0]} minus {labels[1]} in brief"
    ungrouped = [replace(one, group="") for one in contrasts]
    brief = differences_table("pair-brief", title, headline, ungrouped, words, "policy")
    title = f"Every metric, {labels[0]} minus {labels[1]}"
    return brief, every_metric_table("pair", title, metrics, contrasts, words, labels)


def _settings(runs: Pair, labels: tuple[str, str]) -> Table:
    """Settings, versions and hashes of code that differ between the runs."""
    facts = [read_json(logs.folder / "run.json") for logs in runs]
    compared = ({key: one.get(key) for key in SETTINGS} for one in facts)
    rows = tuple(Row(key, (x, y)) for key, x, y in _differing(*compared))
    notes = () if rows else ("Nothing: the same settings, versions and code.",)
    return Table("pair-settings", "Differences in settings", labels, rows, notes, head="setting")


def _differing(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Keys of two trees whose values differ, and both values, short."""
    for key in {**a, **b}:
        one, other = a.get(key), b.get(key)
        if isinstance(one, dict) and isinstance(other, dict):
            yield from ((f"{key}.{below}", x, y) for below, x, y in _differing(one, other))
        elif one != other:
            yield key, _short(one), _short(other)


def _short(value: object) -> str:
    """A value as JSON, its beginning where it is long."""
    text = "–" if value is None else value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
