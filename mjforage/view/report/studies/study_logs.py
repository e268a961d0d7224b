"""A study folder as its report reads it: the settings, and every variant's metrics per episode."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.costs import Cost, load_costs
from mjforage.runs.run_info import RunInfo, again, load_run, read_json
from mjforage.runs.study import StudyInfo, load_study_info, variant_folder
from mjforage.view.report.run_logs import (
    RunLogs,
    Summaries,
    Summary,
    load_episodes,
    load_logs,
    parse_summary,
    scalar,
)
from mjforage.view.report.text_tables import entry_of


@dataclass(frozen=True)
class Player:
    """One row of a study's tables: who plays which variant in which world."""

    variant: str
    world: str
    policy: str


@dataclass(frozen=True)
class StudyLogs:
    """Everything a study's report is made from."""

    folder: Path
    info: StudyInfo
    runs: Mapping[str, RunInfo]  # of every variant
    summaries: Mapping[str, Summaries]
    episodes: Mapping[str, pl.DataFrame]
    costs: Mapping[str, tuple[Cost, ...]]  # of every variant

    @property
    def kind(self) -> str:
        """Which study."""
        return self.info.kind

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds in which any variant is played."""
        own = (world for one in self.info.variants.values() for world in one.worlds)
        return tuple(dict.fromkeys((*self.info.worlds, *own)))

    @property
    def options(self) -> Mapping[str, Any]:
        """What the study was told besides."""
        return self.info.options

    @property
    def bounds(self) -> frozenset[str]:
        """Policies that were shown the truth, in any variant."""
        return frozenset(policy for run in self.runs.values() for policy in run.bounds)

    @property
    def first(self) -> str:
        """The variant that is the scenario as it is."""
        return next(iter(self.info.variants))

    @property
    def base(self) -> RunInfo:
        """The run of the scenario as it is."""
        return self.runs[self.first]

    @cached_property
    def whole(self) -> RunLogs:
        """All logs of that run."""
        return load_logs(variant_folder(self.folder, self.first))

    def title(self, variant: str) -> str:
        """Variant in words."""
        return self.info.variants[variant].title

    def values(self, player: Player, key: str) -> NDArray[np.float64]:
        """Return one metric per episode, NaN where undefined: (episode,)."""
        rows = self.episodes[player.variant].filter(
            (pl.col("world") == player.world) & (pl.col("policy") == player.policy)
        )
        return scalar(rows, key)

    def entry(self, player: Player, key: str) -> Summary:
        """Summary of one metric."""
        return entry_of(self.summaries[player.variant], (player.world, player.policy), key)

    def suffix(self, world: str) -> str:
        """The world, where there are several."""
        return f" · {world}" if len(self.worlds) > 1 else ""


def load_study(folder: Path) -> StudyLogs:
    """Load a study folder.

    Raises
    ------
    UserError
        If a file of the study or of one of its runs is missing, truncated or foreign.
    """
    file = folder / "study.json"
    info, remedy = load_study_info(file), f"{again(folder, file.name)}, it completes the folder"
    if not (folder / "summary.json").is_file():
        raise UserError(f"{folder}: the study is not finished; {remedy}")
    summary = read_json(folder / "summary.json")
    runs, summaries, episodes, costs = {}, {}, {}, {}
    for name in info.variants:
        place = variant_folder(folder, name)
        runs[name] = load_run(place / "run.json")
        if name not in summary:
            raise UserError(f"{folder / 'summary.json'}: {name} is missing; {remedy}")
        summaries[name] = parse_summary(summary[name], str(folder / "summary.json"))
        episodes[name] = load_episodes(place, runs[name])
        costs[name] = load_costs(place / "costs.json")
    return StudyLogs(folder, info, runs, summaries, episodes, costs)
