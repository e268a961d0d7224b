"""Two runs on the same episodes on one page: their replays, and paired differences."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.atomic_files import write_bytes, write_errors
from mjforage.base.errors import UserError
from mjforage.mission.mission_metrics import Description
from mjforage.runs.run_info import load_run, read_json
from mjforage.view.page import Row, Table, render_page, style
from mjforage.view.page.table import Number
from mjforage.view.page.table_files import write_table
from mjforage.view.report.differences import (
    Difference,
    corrected,
    family_note,
    p_text,
    set_apart,
    too_few,
)
from mjforage.view.report.hull_tables import hulls_table
from mjforage.view.report.run_logs import RunLogs, Series, load_logs
from mjforage.view.report.shown import PAIRS, only, shown_policies
from mjforage.view.report.text_tables import HEADLINE, number, row_name
from mjforage.view.report.web_replay import web_replay

SETTINGS = ("scenario", "episodes", "worlds", "policies", "weights", "hulls", "versions", "code")
"""Keys of `run.json` in which two runs on the same episodes may differ."""
_REMEDY = "name two runs of the same seed, map and items"
_LONGEST = 40  # characters of a setting
_NAMED = 6  # files of code

Pair = tuple[Series, Series]
"""A world and policy of the first run, and one of the second."""


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
    count = shared_episodes(*runs)
    several = paired_series(*runs)[:PAIRS]
    brief, full = _brief(runs, labels, several, count), _full(runs, labels, several, count)
    settings = _settings(runs, labels)
    hulls = hulls_table(dict(zip(labels, runs, strict=True)), count)
    content = {
        "labels": labels,
        "runs": [logs.run for logs in runs],
        "count": count,
        "few": too_few(count),
        "brief": brief,
        "full": full,
        "hulls": hulls,
        "settings": settings,
        "left_out": tuple(
            f"Of {label} {len(logs.policies)} policies are shown, the best and the worst by PTA_C."
            for label, logs in zip(labels, runs, strict=True)
            if len(logs.policies) < len(load_run(logs.folder / "run.json").policies)
        ),
        "replay": web_replay(
            dict(zip(labels, (first, second), strict=True)),
            policies=[policy for logs in runs for policy in logs.policies],
        ),
    }
    text = render_page("pair.html.j2", runs[0].run.versions.get("mjforage", ""), content)
    with write_errors(out):
        out.mkdir(parents=True, exist_ok=True)
    for table in filter(None, (brief, full, hulls, settings)):
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


def shared_episodes(first: RunLogs, second: RunLogs) -> int:
    """How many episodes two runs share: those with numbers below it.

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


def _starts(logs: RunLogs, count: int) -> list[NDArray[np.float64]]:
    """Where the items of each episode lie at first, (item, 2) [node]; alike for every policy."""
    own = logs.items_of(logs.series[0], ("item", "row_start", "col_start")).sort("episode", "item")
    first = np.searchsorted(own["episode"].to_numpy(), np.arange(1, count + 1))
    places = own.select("row_start", "col_start").to_numpy().astype(np.float64)
    return np.split(places, first)[:count]


def paired_series(first: RunLogs, second: RunLogs) -> list[Pair]:
    """What is compared: the same policy in the same world.

    Where there is none, all policies of one world; and with no world in common, each policy in both
    runs' worlds, or all with all.
    """
    every = [(one, other) for one in first.series for other in second.series]
    rules = (
        [pair for pair in every if pair[0] == pair[1]],
        [pair for pair in every if pair[0][0] == pair[1][0]],
        [pair for pair in every if pair[0][1] == pair[1][1]],
    )
    return next(filter(None, rules), every)


def _heads(runs: tuple[RunLogs, RunLogs], pair: Pair) -> list[str]:
    worlds = tuple({world for logs in runs for world in logs.run.worlds})
    return [row_name(one, worlds, logs.run.bounds) for one, logs in zip(pair, runs, strict=True)]


def _head(runs: tuple[RunLogs, RunLogs], pair: Pair) -> str:
    one, other = _heads(runs, pair)
    return one if one == other else f"{one} − {other}"


def _values(
    runs: tuple[RunLogs, RunLogs], pair: Pair, metric: Description, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One metric of both on the shared episodes: (episode,) each."""
    first, second = (
        logs.scalar(one, metric.key)[:count] for logs, one in zip(runs, pair, strict=True)
    )
    return first, second


def _metrics(runs: tuple[RunLogs, RunLogs]) -> list[Description]:
    first, second = runs
    known = first.metrics.values()
    return [one for one in known if first.defined(one.key) and second.defined(one.key)]


def _brief(
    runs: tuple[RunLogs, RunLogs], labels: tuple[str, str], several: list[Pair], count: int
) -> Table:
    """Differences in the headline metrics, a row for each pair."""
    metrics = [one for one in _metrics(runs) if one.key in HEADLINE]
    lines = [[Difference(*_values(runs, pair, m, count), m) for m in metrics] for pair in several]
    family = [one for line in lines for one in line]
    apart = iter(set_apart(family))
    rows = tuple(
        Row(
            _head(runs, pair),
            tuple(one.cell for one in line),
            style.policy_colour(pair[0][1]),
            best=frozenset(place for place in range(len(line)) if next(apart)),
            values=tuple(one.full for one in line),
        )
        for pair, line in zip(several, lines, strict=True)
    )
    notes = (
        f"{labels[0]} minus {labels[1]}, mean over the {count} shared episodes where both are "
        f"defined, with the bootstrap 95 % interval of itself alone; {family_note(family)}.",
    )
    columns, units = (m.label for m in metrics), (m.unit for m in metrics)
    better = tuple(m.better for m in metrics)
    title = f"{labels[0]} minus {labels[1]} in brief"
    return Table(
        "pair-brief", title, tuple(columns), rows, notes, tuple(units), stacked=True, better=better
    )


def _full(
    runs: tuple[RunLogs, RunLogs], labels: tuple[str, str], several: list[Pair], count: int
) -> Table:
    """Means and differences in every metric that both runs define."""
    lines = [
        (pair, metric, _values(runs, pair, metric, count))
        for pair in several
        for metric in _metrics(runs)
    ]
    lines = [line for line in lines if any(np.isfinite(values).any() for values in line[2])]
    gaps = [Difference(*values, metric) for _, metric, values in lines]
    rows = []
    for (pair, metric, values), gap, p, apart in zip(
        lines, gaps, corrected(gaps), set_apart(gaps), strict=True
    ):
        means = [float(np.nanmean(v)) if np.isfinite(v).any() else float("nan") for v in values]
        shown = (number(mean, metric.digits) for mean in means)
        rows.append(
            Row(
                metric.head,
                (*shown, gap.text, gap.interval, p_text(p), str(gap.n)),
                group=_head(runs, pair),
                best=frozenset({2} if apart else ()),
                better=metric.better,
                values=(*map(Number, means), *gap.split, Number(p), Number(gap.n)),
            )
        )
    notes = (
        f"The {count} episodes that both runs have: equal items. Difference: {labels[0]} minus "
        f"{labels[1]}, mean over the episodes where both are defined, with the bootstrap 95 % "
        f"interval of itself alone; {family_note(gaps)} (p).",
    )
    columns = (*labels, "difference", "95 % interval", "p", "n")
    title = f"Every metric, {labels[0]} minus {labels[1]}"
    return Table("pair", title, columns, tuple(rows), notes, head="metric")


def _settings(runs: tuple[RunLogs, RunLogs], labels: tuple[str, str]) -> Table:
    """What differs between the runs besides their numbers."""
    facts = [read_json(logs.folder / "run.json") for logs in runs]
    chosen = [{key: one.get(key) for key in SETTINGS} for one in facts]
    files = [one.pop("code") or {} for one in chosen]
    changed = sorted(name for name in {**files[0], **files[1]} if len({*_of(files, name)}) > 1)
    rows = [Row(key, (a, b)) for key, a, b in _differing(*chosen)]
    notes = []
    if changed:
        more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
        names = ", ".join(changed[:_NAMED])
        notes.append(f"Files of code that differ: {names}{more}.")
    elif not rows:
        notes.append("Nothing: the same settings, versions and code.")
    return Table(
        *("pair-settings", "What differs between the runs", labels, tuple(rows), tuple(notes)),
        head="setting",
    )


def _of(files: list[dict[str, str]], name: str) -> list[str | None]:
    return [one.get(name) for one in files]


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
