"""A run folder's logs, loaded strictly: errors name a missing, truncated or foreign file."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.mission.scoring import Description, chosen_metrics, describe, description
from mjforage.runs.episode_recording import Recording
from mjforage.runs.parquet import collected, count_rows, read_schema, scan_parquet
from mjforage.runs.run_info import AGAIN, REMEDY, RunInfo, load_run, read_json
from mjforage.runs.selection import recording_files
from mjforage.runs.tables import WITH_A_RECORD
from mjforage.view.page import style
from mjforage.view.page.table import Number
from mjforage.view.report.step_means import KEYS, metrics_in, numbers, read_means

FloatArray = NDArray[np.float64]
ITEM_COLUMNS = ("item", "t_discovered", "discovered_by", "t_collected", "collected_by")
AGENT_COLUMNS = ("step", "agent", "x_m", "y_m")
SPEEDS = tuple(
    Description(key, label, unit="m/s", series=key, series_label=label)
    for key, label in (("wind_speed_mps", "wind"), ("current_speed_mps", "current"))
)
"""Wind and current of every step, which are drawn like metrics."""
TRACK_STEPS = 1000  # of an episode whose tracks are drawn
MOST_ITEMS = 40_000  # of an episode: no scenario has room for more


@dataclass(frozen=True)
class Summary:
    """One metric of one world and policy over the episodes where it is defined; NaN = undefined."""

    mean: float
    sem: float  # standard error of the mean, not multiplied
    low: float  # 95 % interval
    high: float
    iqm: float  # interquartile mean
    worst: float  # mean of the worst 5 % of the episodes
    n: int  # episodes where the metric is defined

    @property
    def number(self) -> Number:
        """Mean and interval."""
        return Number(self.mean, self.low, self.high)


UNDEFINED = Summary(math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, 0)

Summaries = dict[str, dict[str, dict[str, Summary]]]
"""World, policy, metric key."""


@dataclass(frozen=True, eq=False)
class RunLogs:
    """Logs of a run. Undefined numbers in the frames are null.

    The larger tables stay on disk, and are read when they are asked for.
    """

    folder: Path
    run: RunInfo
    summary: Summaries
    episodes: pl.DataFrame  # a row per world, policy, episode

    @property
    def policies(self) -> tuple[str, ...]:
        """Policies in the fixed order of `style.ordered`."""
        return style.ordered(self.run.policies)

    @property
    def cases(self) -> tuple["Case", ...]:
        """Every world and policy, worlds outermost."""
        return tuple(Case(self, world, one) for world in self.run.worlds for one in self.policies)

    @property
    def by_policy(self) -> tuple["Case", ...]:
        """Every world and policy, policies outermost."""
        return tuple(Case(self, world, one) for one in self.policies for world in self.run.worlds)

    @cached_property
    def metrics(self) -> dict[str, Description]:
        """Metrics by key: ours, also where the run was made without one, then others.

        The run's own words come first, as a metric may be of a package that is not here.
        """
        theirs = {one.key: one for one in self.run.metrics}
        here = {one.key: description(one) for one in chosen_metrics()}
        found = {key for case in self.cases for key in self.summary[case.world][case.policy]}
        keys = [*here, *sorted(found - set(here))]
        return {key: theirs.get(key) or here.get(key) or describe(key) for key in keys}

    def has(self, key: str) -> bool:
        """True if the run was made with a metric."""
        return key in self.episodes.columns

    def defined(self, key: str) -> bool:
        """True if a metric is defined in some episode of the run."""
        return any(case.summary(key).n for case in self.cases)

    @cached_property
    def series(self) -> dict[str, Description]:
        """Metrics that have a time series, by its column of `steps.parquet`; unknown ones last."""
        known = {one.series: one for one in (*SPEEDS, *self.metrics.values()) if one.series}
        others = {
            key: replace(describe(key), series=key, series_label=key)
            for key in self.columns_of_steps
            if key not in known
        }
        return known | others

    @cached_property
    def columns_of_steps(self) -> tuple[str, ...]:
        """Metrics that have a time series in this run."""
        return metrics_in(self.folder / "steps.parquet")

    @cached_property
    def means(self) -> pl.DataFrame:
        """Time series of every world and policy at the steps that are drawn, see `read_means`."""
        return read_means(self.folder / "steps.parquet", self.run)

    @cached_property
    def tracks(self) -> pl.DataFrame:
        """`AGENT_COLUMNS` of the lowest episode of every world and policy, as long as is drawn."""
        path = self.folder / "agents.parquet"
        mine = pl.col("policy").is_in(self.run.policies)
        keys = scan_parquet(path, KEYS, REMEDY).filter(mine)
        lowest = keys.group_by("world", "policy").agg(pl.col("episode").min())
        found = collected(path, lowest, REMEDY)
        rows = scan_parquet(path, (*KEYS, *AGENT_COLUMNS), REMEDY).filter(
            mine,
            pl.col("episode").is_in(found["episode"].unique().to_list()),
            pl.col("step") <= TRACK_STEPS,
        )
        return collected(path, rows, REMEDY).join(found, on=KEYS, how="semi", nulls_equal=True)

    def collects(self) -> list[bool]:
        """True for each agent that collects: (agent,)."""
        return [agent.collects for agent in self.run.agents]


@dataclass(frozen=True)
class Case:
    """One policy in one world of a run."""

    logs: RunLogs
    world: str
    policy: str

    @property
    def head(self) -> str:
        """Policy, marked as a bound where it is one, with its world where there are several."""
        return case_name(self.world, self.policy, self.logs.run.worlds, self.logs.run.bounds)

    @property
    def look(self) -> style.PolicyStyle:
        """Colour and marker of its policy."""
        return style.policy_styles(self.logs.policies)[self.policy]

    def select(self, frame: pl.DataFrame) -> pl.DataFrame:
        """Its rows."""
        return frame.filter(world=self.world, policy=self.policy)

    def values(self, key: str) -> FloatArray:
        """Return one metric per episode, in episode order; NaN where undefined: (episode,)."""
        return scalar(self.select(self.logs.episodes), key)

    def summary(self, key: str) -> Summary:
        """Summary of one metric; all undefined with n = 0 where the run has none."""
        return self.logs.summary[self.world][self.policy].get(key, UNDEFINED)

    def items(self, columns: tuple[str, ...] = ITEM_COLUMNS) -> pl.DataFrame:
        """Episode and other columns of its items, read anew: there are many."""
        path = self.logs.folder / "items.parquet"
        rows = scan_parquet(path, (*KEYS, *columns), REMEDY)
        mine = rows.filter(world=self.world, policy=self.policy)
        return collected(path, mine.drop("world", "policy"), REMEDY)


def policy_name(policy: str, bounds: Any) -> str:
    """Policy, marked where it is one of those that see the truth: bounds, as the run says."""
    return f"{policy} (bound)" if policy in bounds else policy


def case_name(world: str, policy: str, worlds: Any, bounds: Any) -> str:
    """Policy, with its world where there are several."""
    name = policy_name(policy, bounds)
    return name if len(worlds) == 1 else f"{name} · {world}"


def scalar(rows: pl.DataFrame, key: str) -> FloatArray:
    """One metric of one world and policy, in episode order: (episode,).

    NaN where it is undefined, and everywhere if the run was made without it.
    """
    if key not in rows.columns:
        return np.full(rows.height, np.nan)
    return rows.sort("episode")[key].cast(pl.Float64).fill_null(math.nan).to_numpy()


def _check_rows(path: Path, run: RunInfo, rows: int) -> None:
    """Every world and policy of the run must have its rows, and no other may be there."""
    lengths = scan_parquet(path, KEYS, REMEDY).group_by("world", "policy").len()
    counts = {
        (str(world), str(policy)): int(count)
        for world, policy, count in collected(path, lengths, REMEDY).iter_rows()
    }
    wanted = {(world, policy) for world in run.worlds for policy in run.policies}
    for world, policy in sorted(set(counts) - wanted):
        raise UserError(f"{path}: holds {world}/{policy}, which run.json does not name; {REMEDY}")
    for world, policy in sorted(wanted):
        if (found := counts.get((world, policy), 0)) != rows:
            raise UserError(
                f"{path}: {world}/{policy} has {found} rows, expected {rows}; "
                f"{AGAIN}, it completes the folder"
            )


def _check_most(path: Path, run: RunInfo, of_an_episode: int) -> None:
    """A table that packs well could unpack to any size: it has no more rows than a run makes."""
    most = of_an_episode * run.episodes * len(run.worlds) * len(run.policies)
    if (rows := count_rows(path, REMEDY)) > most:
        raise UserError(f"{path}: has {rows:,} rows, at most {most:,} are of this run; {REMEDY}")


def _load_summary(path: Path, run: RunInfo) -> Summaries:
    summaries = parse_summary(read_json(path), str(path))
    for world in run.worlds:
        for policy in run.policies:
            if policy not in summaries.get(world, {}):
                raise UserError(f"{path}: {world}/{policy} is missing; {REMEDY}")
    return summaries


def _entry(value: Mapping[str, Any]) -> Summary:
    low, high = value["ci95"]
    told = (value["mean"], value["sem"], low, high, value["iqm"], value.get("worst5"))
    mean, sem, low, high, iqm, worst = (math.nan if one is None else float(one) for one in told)
    return Summary(mean, sem, low, high, iqm, worst, int(value["n"]))


def parse_summary(data: Mapping[str, Any], where: str = "summary") -> Summaries:
    """Convert the nested dict of `summary.json`, where null is undefined.

    Raises `UserError` if an entry lacks a key or holds something that is not a number or null.
    """
    try:
        return {
            world: {
                policy: {key: _entry(value) for key, value in metrics.items()}
                for policy, metrics in policies.items()
            }
            for world, policies in data.items()
        }
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise UserError(f"{where}: incomplete or malformed ({error!r}); {REMEDY}") from error


def load_episodes(folder: Path, run: RunInfo) -> pl.DataFrame:
    """Load the scalar metrics of every episode; undefined ones are null.

    Raises `UserError` if the table is missing, truncated, foreign or incomplete.
    """
    path = folder / "episodes.parquet"
    known = dict.fromkeys((*KEYS, "items", *read_schema(path, REMEDY)))
    columns = tuple(name for name in known if name not in WITH_A_RECORD["episodes"])
    episodes = numbers(path, scan_parquet(path, columns, REMEDY))
    _check_rows(path, run, run.episodes)
    return collected(path, episodes, REMEDY)


def load_logs(folder: Path) -> RunLogs:
    """Load a run folder.

    Raises `UserError` if the folder or a file of it is missing, truncated, foreign or does not
    agree with `run.json`.
    """
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder; name one that evaluate, compare or study wrote")
    run = load_run(folder / "run.json")
    summary = _load_summary(folder / "summary.json", run)
    episodes = load_episodes(folder, run)
    metrics_in(path := folder / "steps.parquet")
    _check_rows(path, run, run.episodes * (run.horizon + 1))
    scan_parquet(items := folder / "items.parquet", (*KEYS, *ITEM_COLUMNS), REMEDY)
    scan_parquet(agents := folder / "agents.parquet", (*KEYS, *AGENT_COLUMNS), REMEDY)
    _check_most(items, run, MOST_ITEMS)
    _check_most(agents, run, (run.horizon + 1) * len(run.agents))
    return RunLogs(folder, run, summary, episodes)


def pick_replay(logs: RunLogs) -> Recording | None:
    """Load the replay of the scenario figure: first world and policy, lowest episode.

    None if the run keeps none. Raises `UserError` if the chosen one cannot be read.
    """
    for case in logs.cases:
        for path in recording_files(logs.folder, case.world, case.policy).values():
            return Recording.load(path)
    return None
