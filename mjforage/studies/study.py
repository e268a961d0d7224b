"""A study: named variants of a scenario, each an ordinary run folder, under one roof.

`study.json` comes first and `summary.json` last; `variants/NAME/` are run folders, computed all
together, so that workers pass from one to the next without a break. `sessions.json` keeps what
every call computed and how fast.
"""

import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from mjforage.errors import UserError
from mjforage.mission import Setting
from mjforage.run_info import read_json
from mjforage.scenario import Scenario
from mjforage.scenario_file import scenario_to_tree
from mjforage.storage import Chunk, claimed, open_folder, write_json
from mjforage.studies.evaluate import HERE, Progress, Run, carry_out
from mjforage.studies.identity import provenance, versions
from mjforage.studies.workers import Workers

IDENTITY = ("kind", "scenario", "variants", "worlds", "episodes", "seed", "options", "versions")


@dataclass(frozen=True)
class Variant:
    """One scenario of a study and who plays it."""

    name: str  # of its run folder
    title: str  # in tables
    scenario: Scenario
    policies: tuple[str, ...]


@dataclass(frozen=True)
class Study:
    """What a study is.

    Attributes
    ----------
    kind : names its report: parts, ablation, corruption or paper
    setting : scenario and map that the variants vary; all share the map
    variants : in the order in which they are computed
    worlds, episodes, seed : the same for all variants, so that episodes can be paired
    options : what the report must know besides
    """

    kind: str
    setting: Setting
    variants: tuple[Variant, ...]
    worlds: tuple[str, ...] = ("graph",)
    episodes: int = 100
    seed: int = 0
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def info(self) -> dict[str, Any]:
        """Content of `study.json`."""
        return provenance() | {
            "kind": self.kind,
            "scenario": scenario_to_tree(self.setting.scenario),
            "variants": {
                variant.name: {"title": variant.title, "policies": list(variant.policies)}
                for variant in self.variants
            },
            "worlds": list(self.worlds),
            "episodes": self.episodes,
            "seed": self.seed,
            "options": dict(self.options),
            "versions": versions(),
        }


def variant_folder(folder: Path, name: str) -> Path:
    """Run folder of a variant of the study in `folder`."""
    return folder / "variants" / name


class _Session:
    """What this call computes, for `sessions.json`."""

    def __init__(self, folder: Path, workers: Workers) -> None:
        self._file, self._began = folder / "sessions.json", time.perf_counter()
        self._started = datetime.now(UTC).isoformat(timespec="seconds")
        self._how, self._workers = workers.how, workers.count()
        self._episodes = 0
        self._spent = {"cpu_s": 0.0, "steps": 0.0}

    def add(self, run: Run, chunk: Chunk) -> None:
        """Count a chunk that was computed."""
        self._episodes += chunk.count
        for key, value in run.folder.timings([chunk]).items():
            self._spent[key] = self._spent.get(key, 0.0) + value

    def write(self) -> None:
        """Append to the file, unless nothing was computed."""
        if not self._episodes:
            return
        before = read_json(self._file)["sessions"] if self._file.is_file() else []
        entry = {
            "started": self._started,
            "how": self._how,
            "workers": self._workers,
            "episodes": self._episodes,
            "wall_s": time.perf_counter() - self._began,
        } | self._spent
        write_json(self._file, {"sessions": [*before, entry]})


def run_study(
    study: Study,
    folder: Path,
    *,
    workers: Workers = HERE,
    progress: Progress = lambda done, total: None,
) -> dict[str, Any]:
    """Compute what is missing of a study.

    Parameters
    ----------
    folder : study folder; an unfinished study of the same settings in it is resumed
    workers : who computes
    progress : called with (episodes done, episodes in all)

    Returns
    -------
    Content of `summary.json`: variant -> summary of its run

    Raises
    ------
    UserError
        For settings that cannot be run, a folder that holds something else, a failure to write, or
        workers that are lost. Nothing computed is lost.
    """
    runs = [_plan(study, variant, folder) for variant in study.variants]
    session = _Session(folder, workers)
    open_folder(folder, "study", study.info, IDENTITY)
    with ExitStack() as stack:
        stack.enter_context(claimed(folder))
        for run in runs:
            run.open()
            stack.enter_context(run.folder.claimed())
        stack.callback(session.write)
        summaries: Sequence[Any] = carry_out(runs, workers, progress, session.add)
        names = [variant.name for variant in study.variants]
        summary = dict(zip(names, summaries, strict=True))
        write_json(folder / "summary.json", summary)
    return summary


def _plan(study: Study, variant: Variant, folder: Path) -> Run:
    setting = Setting(variant.scenario, study.setting.grid)
    try:
        return Run.plan(
            setting,
            variant.policies,
            variant_folder(folder, variant.name),
            episodes=study.episodes,
            seed=study.seed,
            worlds=study.worlds,
        )
    except UserError as error:
        if variant is study.variants[0]:  # the scenario as it is
            raise
        raise UserError(f"{study.kind} study, {variant.title}: {error}") from error
