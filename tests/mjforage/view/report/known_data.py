"""Runs and studies whose every number is known, so that what a report says is known too.

Episodes go up and down about their mean in turn. Of ten, those a step of `3 * SEM` above and below
it have just that SEM; players of one metric share the pattern, so that differences on the same
episodes are equal in all of them: their interval is a point, and their p is `P`, about 2^-9, the
least of ten pairs, whatever their number.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray
from polars import selectors

from mjforage.metrics import compared
from mjforage.mission.scoring import describe
from mjforage.mission.setup import Setup
from mjforage.runs.costs import Cost
from mjforage.runs.evaluate import summary_entry
from mjforage.runs.run_info import Agent, Hulls, MapInfo, RunInfo
from mjforage.runs.studies.study import StudyInfo, VariantInfo
from mjforage.scenario.scenario_file import load_scenario, scenario_to_tree
from mjforage.view.page.table import Row, Table
from mjforage.view.report.cells import is_rough, mean_cell
from mjforage.view.report.run_logs import RunLogs, Summaries, Summary, parse_summary
from mjforage.view.report.studies.study_logs import StudyLogs

EPISODES = 10
SEM = {"pta_c": 1.0, "pta_d": 0.5, "nt90": 0.03125, "rmse": 0.0, "rmse_columns": 0.0}
"""Of every player; 0 where a metric is not named, every episode then being its mean."""

P = f"{compared([np.ones(EPISODES)]).p[0]:.3f}"

Means = Mapping[tuple[str, str], Mapping[str, float | list[float]]]
"""World and policy -> metric -> mean of the episodes, or every episode."""


def episodes_of(key: str, mean: float | list[float]) -> NDArray[np.float64]:
    """(episode,) values of a metric with this mean and its SEM."""
    if isinstance(mean, list):
        return np.array(mean, dtype=np.float64)
    return mean + 3.0 * SEM.get(key, 0.0) * np.resize([1.0, -1.0], EPISODES)


@cache
def _facts(scenario: str) -> dict[str, Any]:
    """What `run.json` says of a scenario as it is shipped."""
    setup = Setup.of(load_scenario(scenario))
    grid, team = setup.grid, setup.scenario.team
    cells = tuple("".join(str(int(one)) for one in row) for row in grid.navigable)
    (rows, columns), nodes = grid.navigable.shape, int(grid.navigable.sum())
    fleet = [(name, role.collects, i) for name, role in team.items() for i in range(role.count)]
    return {
        "scenario": scenario_to_tree(setup.scenario),
        "map": MapInfo("comb-port", rows, columns, nodes, setup.scenario.map.pitch_m, cells),
        "agents": tuple(Agent(f"{name}_{i}", name, collects) for name, collects, i in fleet),
    }


def _run(means: Means, scenario: str, bounds: tuple[str, ...]) -> RunInfo:
    worlds = tuple(dict.fromkeys(world for world, _ in means))
    policies = tuple(dict.fromkeys(policy for _, policy in means))
    count = len(next(iter(_values(means).values())))
    known: dict[str, Any] = {
        "command": "",
        "versions": {},
        "seed": 0,
        "episodes": count,
        "worlds": worlds,
    }
    known |= {"policies": policies, "hulls": Hulls(), "started": "", "timings": {}, "hash": ""}
    return RunInfo(**known, **_facts(scenario), bounds=bounds)


def _values(means: Means) -> dict[tuple[str, str, str], NDArray[np.float64]]:
    return {
        (world, policy, key): episodes_of(key, mean)
        for (world, policy), metrics in means.items()
        for key, mean in metrics.items()
    }


def _episodes(means: Means) -> pl.DataFrame:
    """Rows in another order than that of the episodes, as a file may hold them."""
    frames = []
    for (world, policy), metrics in means.items():
        columns = {key: episodes_of(key, mean) for key, mean in metrics.items()}
        count = len(next(iter(columns.values())))
        head = {"world": [world] * count, "policy": [policy] * count, "episode": range(count)}
        frames.append(pl.DataFrame(head | columns).with_columns(selectors.float().fill_nan(None)))
    return pl.concat(frames, how="diagonal").sort("episode", descending=True)


def summary_of(values: NDArray[np.float64], key: str) -> Summary:
    """Summary of (episode,) values of a metric, as a run of 150 steps has it."""
    entry = summary_entry(values, describe(key), 150)
    return parse_summary({"graph": {"greedy": {key: entry}}})["graph"]["greedy"][key]


def told(key: str, mean: float | list[float], part: float = 1.0) -> str:
    """Cell of a mean and its interval, of ten episodes or of a part of each."""
    metric, found = describe(key), summary_of(part * episodes_of(key, mean), key)
    return mean_cell(found.number, metric.digits, is_rough(metric, found.n)).text


def _summary(means: Means) -> Summaries:
    found: Summaries = {}
    for (world, policy, key), values in _values(means).items():
        here = found.setdefault(world, {}).setdefault(policy, {})
        here[key] = summary_of(values, key)
    return found


def known_run(means: Means, scenario: str = "comb-port", bounds: tuple[str, ...] = ()) -> RunLogs:
    """The logs of a run, as if loaded from its folder; there is none."""
    return RunLogs(
        Path("made-up"), _run(means, scenario, bounds), _summary(means), _episodes(means)
    )


def known_study(
    variants: Mapping[str, Means],
    kind: str = "paper",
    scenario: str = "comb-port",
    bounds: tuple[str, ...] = (),
    costs: Mapping[str, tuple[Cost, ...]] | None = None,
    **options: object,
) -> StudyLogs:
    """The logs of a study, as if loaded from its folder; there is none."""
    runs = {name: known_run(means, scenario, bounds) for name, means in variants.items()}
    told = {n: VariantInfo(f"is {n}", logs.run.policies) for n, logs in runs.items()}
    worlds = tuple(dict.fromkeys(world for one in runs.values() for world in one.run.worlds))
    tree = _facts(scenario)["scenario"]
    info = StudyInfo("", "", kind, tree, told, worlds, EPISODES, 0, options)
    return StudyLogs(Path("made-up"), info, runs, costs or dict.fromkeys(variants, ()))


def cells(table: Table | None) -> dict[tuple[str, str], tuple[str, ...]]:
    """Group and head of every row -> its cells, bold ones between stars."""
    assert table is not None
    return {(row.group, row.head): starred(row) for row in table.rows}


def starred(row: Row) -> tuple[str, ...]:
    """Cells of a row, bold ones between stars."""
    return tuple(f"*{one}*" if i in row.best else one for i, one in enumerate(row.cells))


@cache
def three_worlds() -> RunLogs:
    """Two policies in three worlds: ranks that differ between metrics and between worlds.

    Greedy collects more but with physics; it is sooner in the graph alone.
    """
    return known_run(
        {
            ("graph", "greedy"): {"pta_c": 80.0, "nt90": 0.5},
            ("graph", "levy"): {"pta_c": 60.0, "nt90": 0.75},
            ("hulls", "greedy"): {"pta_c": 60.0, "nt90": 0.625},
            ("hulls", "levy"): {"pta_c": 50.0, "nt90": 0.5},
            ("physics", "greedy"): {"pta_c": 50.0, "nt90": 1.0},
            ("physics", "levy"): {"pta_c": 56.0, "nt90": 0.875},
        }
    )
