"""`mjforage evaluate`: policies on the same episodes of a scenario, into a run folder."""

import logging
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.atomic_files import write_json
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.graph_planner.policies.registry import check_policies
from mjforage.mission.scoring import Description, chosen_metrics, description
from mjforage.mission.scoring.known import series_metrics
from mjforage.mission.setup import Setup
from mjforage.physics.run_warnings import run_warnings
from mjforage.physics.worlds import WORLDS, create_mission
from mjforage.runs.costs import Invocation, costs_content
from mjforage.runs.distributing import carried_out
from mjforage.runs.identity import pinned, run_info
from mjforage.runs.jobs import Episode, Job, is_recorded, record_episode, run_chunk
from mjforage.runs.layout import chunk_size, plan, take_apart
from mjforage.runs.resuming import Resume, archive
from mjforage.runs.selection import FIRST, USUAL, check_selection, ranks_of, selected
from mjforage.runs.storage import Chunk, RunFolder
from mjforage.runs.tables import metric_columns
from mjforage.runs.workers import Workers
from mjforage.scenario.debris import item_choices
from mjforage.scenario.sizes import check_memory, table_bytes

_logger = logging.getLogger(__name__)

THIS_PROCESS = Workers()

Progress = Callable[[int, int], None]
Summary = dict[str, dict[str, dict[str, dict[str, Any]]]]


def summarise(table: pl.DataFrame, described: Iterable[Description], horizon: int) -> Summary:
    """`summary.json` of an episodes table: world, policy, metric -> mean and its spread.

    `ci95` is the interval of `metrics.mean_interval`, `worst5` the mean of the worst 5 % of the
    episodes. Undefined numbers are None.

    Parameters
    ----------
    described : of the metrics; one that is not there has no known ends
    """
    summary: Summary = {}
    known = {one.key: one for one in described}
    for (world, policy), rows in table.group_by("world", "policy", maintain_order=True):
        ordered = rows.sort("episode")
        summary.setdefault(str(world), {})[str(policy)] = {
            key: summary_entry(
                ordered[key].to_numpy(), known.get(key, Description(key, key)), horizon
            )
            for key in metric_columns(table)
        }
    return summary


def summary_entry(values: NDArray[np.float64], metric: Description, horizon: int) -> dict[str, Any]:
    """Entry of `summary.json` of (episode,) values of a metric."""
    found = metrics.mean_interval(values, *metric.ends(horizon))
    entry = {
        "mean": found.value,
        "sem": metrics.sem(values),
        "ci95": [found.low, found.high],
        "iqm": metrics.iqm(values),
        "worst5": metrics.worst_mean(values, metric.better),
    }
    return {key: _told(value) for key, value in entry.items()} | {"n": int(found.n)}


def _told(value: Any) -> Any:
    """A number, or numbers in a list, None where undefined."""
    if isinstance(value, list):
        return [_told(one) for one in value]
    return float(value) if math.isfinite(value) else None


def check_numbers(episodes: int, seed: int) -> None:
    """Refuse numbers of no episodes; raises `UserError`."""
    if episodes < 1 or not 0 <= seed < 1 << 64:
        raise UserError(f"episodes {episodes}, seed {seed}: give at least 1 and 0 (below 2**64)")


@dataclass(frozen=True)
class Run:
    """A run of policies in its folder: one of evaluate, many of a study."""

    setup: Setup
    policies: tuple[str, ...]
    worlds: tuple[str, ...]
    seed: int
    info: dict[str, Any]  # content of run.json
    folder: RunFolder
    metrics: tuple[str, ...]  # references, beside ours
    kept: tuple[str | int, ...]  # episodes to record, as of `parse_selection`
    chunks: list[Chunk] = field(default_factory=list)  # of `lay_out`

    @classmethod
    def plan(
        cls,
        setup: Setup,
        policies: Sequence[str],
        folder: Path,
        *,
        episodes: int = 100,
        seed: int = 0,
        worlds: Sequence[str] = ("graph",),
        metrics: Sequence[str] = (),
        kept: Sequence[str | int] = FIRST,
    ) -> "Run":
        """Check everything, and write nothing yet.

        Parameters
        ----------
        metrics : references to metrics, beside ours
        kept : episodes of every world and policy to record; no part of what a run is

        Raises
        ------
        UserError
            For unknown names and numbers out of range.
        """
        policies = check_policies(policies)
        series_metrics(chosen_metrics(metrics))
        for world in worlds:
            if world not in WORLDS:
                raise UserError(f"world {world}: unknown; {nearest(world, WORLDS)}")
            if list(worlds).count(world) > 1:
                raise UserError(f"world {world}: given twice")
            create_mission(setup, world)  # what cannot be run says so before anything is written
        check_numbers(episodes, seed)
        kept = check_selection(kept, episodes)
        item_choices(setup.scenario.physics)  # recordings need them, also at graph level
        in_all = episodes * len(policies) * len(worlds)
        check_memory(
            f"episodes {episodes}: the report of {in_all} in all",
            table_bytes(in_all, setup.scenario.horizon),
            "give fewer",
        )
        device = setup.scenario.physics.device
        largest = max(chunk_size(world, device) for world in worlds)
        setup.check_memory(min(episodes, largest), recorded=True)
        setup = pinned(setup)
        info = run_info(setup, policies, worlds, episodes, seed, metrics)
        names = tuple(policies), tuple(worlds)
        return cls(setup, *names, seed, info, RunFolder(folder), tuple(metrics), kept)

    def open(self, accept: bool = False) -> None:
        """Create the folder, or find the same run in it.

        Parameters
        ----------
        accept : go on although code or versions differ, and note it in `run.json`

        Raises
        ------
        UserError
            If it holds something else or cannot be written.
        """
        self.info.update(self.folder.open(self.info, accept))

    def lay_out(self) -> None:
        """Divide the run into chunks, including those in its folder.

        The folder must be claimed: merged tables of fewer episodes become chunks again.

        Raises
        ------
        UserError
            If a table cannot be read or a chunk not be written.
        """
        if not self.folder.complete:
            take_apart(self.folder)
        stored = self.folder.stored(self.worlds, self.policies)
        device = self.setup.scenario.physics.device
        self.chunks[:] = plan(self.policies, self.worlds, self.info["episodes"], stored, device)

    def merge(self, wall_s: float) -> None:
        """Merge the chunks into tables, and write their computing time to `run.json`.

        Parameters
        ----------
        wall_s : time that the run took

        Raises
        ------
        UserError
            If a chunk is missing or damaged, or a file cannot be written.
        """
        path = self.folder.path
        self.folder.merge(self.chunks)
        costs = self.folder.costs(self.chunks)
        write_json(path / "costs.json", costs_content(costs))
        cpu_s, steps = (sum(getattr(one, key) for one in costs) for key in ("cpu_s", "steps"))
        timings = {"cpu_s": cpu_s, "steps": steps, "wall_s": wall_s}
        write_json(path / "run.json", self.info | {"timings": timings})

    def not_recorded(self) -> list[Episode]:
        """Selected episodes without a recording, of a run whose tables are merged.

        Raises
        ------
        UserError
            If the table of episodes is missing or damaged.
        """
        table = self.folder.episodes(self.chunks)
        found = []
        for (world, policy), rows in table.group_by("world", "policy", maintain_order=True):
            pta_c, length = rows.sort("episode").select("pta_c", "length").to_numpy().T
            numbers = selected(self.kept, ranks_of(pta_c, length))
            found += [Episode(str(world), str(policy), number) for number in numbers]
        return [one for one in found if not is_recorded(self.folder.path, one)]

    def close(self) -> Summary:
        """Write the summary of a run whose tables are merged.

        Raises
        ------
        UserError
            If a table is missing or damaged, or a file cannot be written.
        """
        described = map(description, chosen_metrics(self.metrics))
        episodes = self.folder.episodes(self.chunks)
        summary = summarise(episodes, described, self.setup.scenario.horizon)
        write_json(self.folder.path / "summary.json", summary)
        self.folder.finish({*self.chunks, *self.folder.stored(self.worlds, self.policies)})
        return summary


def run_all(
    runs: Sequence[Run], workers: Workers, invocation: Invocation, progress: Progress
) -> list[Summary]:
    """Compute the missing chunks of all runs at once, and close each complete run.

    Parameters
    ----------
    invocation : of these workers, as of `Workers.invocation`
    progress : called with (episodes done, episodes in all)

    Raises
    ------
    UserError
        As `carried_out` and `Run.close`. Finished chunks stay.
    """
    started = time.perf_counter()
    for run in runs:
        run.lay_out()
    jobs = [
        Job.of(run.setup, run.folder.path, run.info, run.metrics, invocation, workers)
        for run in runs
    ]
    begun = [place for place, run in enumerate(runs) if not run.folder.complete]
    _foretell([runs[place] for place in begun])
    work = [
        (place, chunk)
        for place in begun
        for chunk in runs[place].chunks
        if not runs[place].folder.has(chunk)
    ]
    total = sum(chunk.count for run in runs for chunk in run.chunks)
    done = total - sum(chunk.count for _, chunk in work)
    progress(done, total)
    left = Counter(place for place, _ in work)
    tasks = [(jobs[place], chunk) for place, chunk in work]
    summaries: list[Summary] = []
    with closing(carried_out(run_chunk, tasks, workers)) as results:
        for place, run in enumerate(runs):  # runs are computed in their order
            while left[place]:
                owner, chunk = work[next(results)]
                left[owner] -= 1
                done += chunk.count
                progress(done, total)
            if place in begun:
                run.merge(time.perf_counter() - started)
            summaries.append(run.close())
        for _ in results:  # none is left, but workers end by themselves
            pass
    _record(runs, jobs, workers)
    return summaries


def _record(runs: Sequence[Run], jobs: Sequence[Job], workers: Workers) -> None:
    """Record the selected episodes, and say which do not come out as logged."""
    tasks = [(job, one) for run, job in zip(runs, jobs, strict=True) for one in run.not_recorded()]
    for _ in carried_out(record_episode, tasks, workers):
        pass
    for job, one in tasks:
        if not is_recorded(job.folder, one):
            _logger.warning(
                "%s: episode %d of %s in world %s does not come out as logged, so it is not "
                "recorded; it was made with other versions or code, or the policy draws numbers "
                "that hang on no seed",
                job.folder,
                one.number,
                one.policy,
                one.world,
            )


def _foretell(runs: Sequence[Run]) -> None:
    """Warn of the limits of the worlds and vessels of runs that begin, each in a line, once."""
    lines = (line for run in runs for line in run_warnings(run.setup, run.worlds))
    for line in dict.fromkeys(lines):
        _logger.warning("%s", line)


def evaluate(
    setup: Setup,
    policies: Sequence[str],
    folder: Path,
    *,
    episodes: int = 100,
    seed: int = 0,
    workers: Workers = THIS_PROCESS,
    worlds: Sequence[str] = ("graph",),
    metrics: Sequence[str] = (),
    kept: Sequence[str | int] = USUAL,
    progress: Progress = lambda done, total: None,
    resume: Resume = "same",
) -> Summary:
    """Run policies on the same episodes and leave a complete run folder.

    Parameters
    ----------
    setup : scenario and map
    policies : references, see `create_policy`
    worlds : names
    metrics : `package.module:Class` of metrics to take beside ours
    kept : episodes to record, as of `parse_selection`; a finished run is added to
    folder : run folder; an unfinished run of the same settings in it is resumed
    episodes : episodes per policy and world, 1 or more
    seed : seed of the run
    workers : processes or cluster that compute
    progress : called with (episodes done, episodes in all)
    resume : treatment of a run that the folder holds

    Returns
    -------
    The content of `summary.json`.

    Raises
    ------
    UserError
        For unknown names, a folder that holds something else, a failure to write, or workers that
        are lost.
    """
    run = Run.plan(
        setup,
        policies,
        folder,
        episodes=episodes,
        seed=seed,
        worlds=worlds,
        metrics=metrics,
        kept=kept,
    )
    invocation = workers.invocation(run.policies, run.metrics)
    if resume == "fresh":
        archive(folder, "run")
    run.open(accept=resume == "accept-code-change")
    with run.folder.lock():
        return run_all([run], workers, invocation, progress)[0]
