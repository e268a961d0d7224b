"""Two runs on the same episodes on one page: their replays, and paired differences."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from mjforage.base.atomic_files import write_bytes, write_errors
from mjforage.base.errors import UserError
from mjforage.mission.scoring import Description
from mjforage.runs.run_info import load_run, read_json
from mjforage.view.page import Row, Table
from mjforage.view.page.table_files import write_table
from mjforage.view.report.contrasts import Contrast, differences_table, every_metric_table
from mjforage.view.report.differences import too_few
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.report_page import counted
from mjforage.view.report.run_logs import Case, FloatArray, RunLogs, case_name, load_logs
from mjforage.view.report.sections import Page, Section
from mjforage.view.report.shown import PAIRS, only, shown_policies
from mjforage.view.report.text_tables import HEADLINE
from mjforage.view.report.web_replay import web_replay

SETTINGS = ("scenario", "episodes", "worlds", "policies", "weights", "hulls", "versions", "code")
"""Keys of `run.json` in which two runs on the same episodes may differ."""
_REMEDY = "name two runs of the same seed, map and items"
_LONGEST = 40  # characters of a setting
_NAMED = 6  # files of code

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
        raise UserError(f"--out {out}: holds a run or study, whose report stays; choose another")
    runs = _shown(load_logs(first)), _shown(load_logs(second))
    page = pair_page(runs, labels, shared_episodes(*runs))
    folders = dict(zip(labels, (first, second), strict=True))
    policies = [policy for logs in runs for policy in logs.policies]
    text = page.text(out, lambda room: web_replay(folders, room, policies))
    with write_errors(out):
        out.mkdir(parents=True, exist_ok=True)
    for table in (table for section in page.sections for table in section.numbers):
        write_table(table, out / "tables", ("csv",))
    write_bytes(out / "report.html", text.encode("utf-8"))
    return out / "report.html"


def _shown(logs: RunLogs) -> RunLogs:
    """The run, or of one with very many policies what a page has room for."""
    return only(logs, shown_policies(logs))


def _labels(first: Path, second: Path) -> tuple[str, str]:
    """Names of the folders, with as much of their paths as tells them apart."""
    paths = first.resolve(), second.resolve()
    if paths[0] == paths[1]:
        raise UserError(f"{second}: is the same folder as {first}; name two")
    for parts in range(1, 1 + max(len(path.parts) for path in paths)):
        names = ["/".join(path.parts[-parts:]) for path in paths]
        if names[0] != names[1]:
            break
    return names[0], names[1]


def pair_page(runs: Pair, labels: tuple[str, str], count: int) -> Page:
    """The page of two runs that share so many episodes."""
    first = runs[0].run
    said = [
        f"Of {label} {len(logs.policies)} policies are shown, the best and the worst by PTA_C."
        for label, logs in zip(labels, runs, strict=True)
        if len(logs.policies) < len(load_run(logs.folder / "run.json").policies)
    ]
    brief, full = difference_tables(runs, labels, count)
    hulls = hulls_table(dict(zip(labels, runs, strict=True)), count)
    settings = _settings(runs, labels)
    sections = [
        Section("result", brief.title, " ".join(filter(None, (*said, too_few(count)))), [brief]),
        Section("all", full.title, folded=[full]),
        *([Section("hulls", hulls.title, folded=[hulls])] if hulls else []),
        Section("differing", settings.title, folded=[settings]),
        *(
            Section(
                f"run-{place}",
                label,
                facts=[
                    ("Scenario", logs.run.name),
                    ("Worlds", ", ".join(logs.run.worlds)),
                    ("Policies", ", ".join(logs.run.policies)),
                    ("Episodes", str(logs.run.episodes)),
                    ("Started", logs.run.started),
                ],
                texts={"Command": logs.run.command},
            )
            for place, (label, logs) in enumerate(zip(labels, runs, strict=True), 1)
        ),
    ]
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
    here, there = first.run, second.run
    if not np.array_equal(here.map.cells, there.map.cells) or here.map.pitch_m != there.map.pitch_m:
        mine, theirs = (
            f"{one.name}, {one.rows} x {one.columns} nodes {one.pitch_m:g} m apart,"
            for one in (here.map, there.map)
        )
        words = f"the map is {theirs} there and {mine} here"
        raise UserError(_unshared(first, second, words))
    facts = ({"seed": run.seed, "items": run.scenario.get("items")} for run in (here, there))
    for key, mine, theirs in _differing(*facts):
        raise UserError(_unshared(first, second, f"{key} is {theirs} there and {mine} here"))
    count = min(here.episodes, there.episodes)
    starts = zip(_starts(first, count), _starts(second, count), strict=True)
    for episode, (own, others) in enumerate(starts):
        if own.shape != others.shape or not np.allclose(own, others):
            words = f"the items of episode {episode} lie elsewhere, by other code perhaps"
            raise UserError(_unshared(first, second, words))
    return count


def _unshared(first: RunLogs, second: RunLogs, words: str) -> str:
    return f"{second.folder}: shares no episodes with {first.folder}: {words}; {_REMEDY}"


def _starts(logs: RunLogs, count: int) -> list[FloatArray]:
    """Initial positions of the items of each episode, (item, 2) [node]; alike for every policy."""
    own = logs.cases[0].items(("item", "row_start", "col_start")).sort("episode", "item")
    first = np.searchsorted(own["episode"].to_numpy(), np.arange(1, count + 1))
    places = own.select("row_start", "col_start").to_numpy().astype(np.float64)
    return np.split(places, first)[:count]


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
    runs = _until(runs[0], count), _until(runs[1], count)
    worlds = {world for logs in runs for world in logs.run.worlds}
    contrasts = []
    for pair in paired_cases(*runs)[:PAIRS]:
        one, other = (case_name(x.world, x.policy, worlds, x.logs.run.bounds) for x in pair)
        head = one if one == other else f"{one} − {other}"
        contrasts.append(Contrast(head, *pair))
    metrics = _metrics(runs)
    words = (
        f"{labels[0]} minus {labels[1]}, mean over the {count} shared episodes where both are "
        "defined, with the bootstrap 95 % interval of itself alone"
    )
    headline = [metric for metric in metrics if metric.key in HEADLINE]
    title = f"{labels[0]} minus {labels[1]} in brief"
    brief = differences_table("pair-brief", title, headline, contrasts, words, "policy")
    title = f"Every metric, {labels[0]} minus {labels[1]}"
    grouped = [replace(one, group=one.head) for one in contrasts]
    return brief, every_metric_table("pair", title, metrics, grouped, words, labels)


def _until(logs: RunLogs, count: int) -> RunLogs:
    """The run with its first episodes alone."""
    return replace(logs, episodes=logs.episodes.filter(pl.col("episode") < count))


def _metrics(runs: Pair) -> list[Description]:
    first, second = runs
    known = first.metrics.values()
    return [one for one in known if first.defined(one.key) and second.defined(one.key)]


def _settings(runs: Pair, labels: tuple[str, str]) -> Table:
    """Settings, versions and code that differ between the runs."""
    facts = [read_json(logs.folder / "run.json") for logs in runs]
    chosen = [{key: one.get(key) for key in SETTINGS} for one in facts]
    a, b = (one.pop("code") or {} for one in chosen)
    changed = sorted(name for name in {**a, **b} if a.get(name) != b.get(name))
    rows = tuple(Row(key, (x, y)) for key, x, y in _differing(*chosen))
    notes = [] if rows or changed else ["Nothing: the same settings, versions and code."]
    if changed:
        more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
        notes = [f"Files of code that differ: {', '.join(changed[:_NAMED])}{more}."]
    title = "Differences in settings"
    return Table("pair-settings", title, labels, rows, tuple(notes), head="setting")


def _differing(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Keys of two trees whose values differ, and both values, short."""
    for key in {**a, **b}:
        one, other = a.get(key), b.get(key)
        if isinstance(one, dict) and isinstance(other, dict):
            yield from ((f"{key}.{below}", x, y) for below, x, y in _differing(one, other))
        elif one != other:
            yield key, _short(one), _short(other)


def _short(value: object) -> str:
    if value is None:
        return "–"
    text = value if isinstance(value, str) else json.dumps(value)
    if isinstance(value, list) and all(isinstance(one, str) for one in value):
        text = ", ".join(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
