"""A study: named variants of a scenario, each an ordinary run folder, in one folder.

`study.json` comes first and `summary.json` last; `variants/NAME/` are run folders, computed all
together, so that workers pass from one to the next without a break.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mjforage.base.atomic_files import write_json
from mjforage.base.errors import UserError
from mjforage.graph_planner.policies.registry import policy_label
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import THIS_PROCESS, Progress, Run, run_all
from mjforage.runs.fingerprint import commit
from mjforage.runs.foreign import check_files, check_names
from mjforage.runs.identity import provenance
from mjforage.runs.lock import folder_lock
from mjforage.runs.resuming import Resume, archive, found_in, open_folder
from mjforage.runs.run_info import REMEDY, read_json
from mjforage.runs.selection import FIRST, USUAL
from mjforage.runs.workers import Workers
from mjforage.scenario.maps import GridMap
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import scenario_to_tree
from mjforage.scenario.schema import OPEN, check

IDENTITY = ("kind", "scenario", "worlds", "seed", "options", "episodes", "variants")


@dataclass(frozen=True)
class Variant:
    """One scenario of a study, its policies, and map or worlds where they are not the study's."""

    name: str  # of its run folder
    title: str  # in tables
    scenario: Scenario
    policies: tuple[str, ...]
    grid: GridMap | None = None  # None: the study's
    worlds: tuple[str, ...] = ()  # none: the study's

    @property
    def info(self) -> dict[str, Any]:
        """Entry of the variant in `study.json`."""
        entry = {"title": self.title, "policies": [policy_label(one) for one in self.policies]}
        return entry | ({"worlds": list(self.worlds)} if self.worlds else {})


@dataclass(frozen=True)
class LeftOut:
    """A policy that does not play a variant."""

    policy: str
    """Its name."""
    variant: str
    """Name of the variant."""
    reason: str
    """Reason why the policy cannot play it."""


@dataclass(frozen=True)
class Study:
    """Definition of a study.

    Attributes
    ----------
    kind : names its report: parts, ablation, corruption, paper, communication, sensing or board
    setup : scenario and map that the variants vary
    variants : in the order in which they are computed, the scenario as it is first
    worlds : of the variants that name none
    episodes, seed : the same for all variants, so that episodes can be paired
    options : what the report must know besides
    metrics : `package.module:Class` of metrics to take beside those that are known
    left_out : policies that cannot play a variant; no part of the identity
    """

    kind: str
    setup: Setup
    variants: tuple[Variant, ...]
    worlds: tuple[str, ...] = ("graph",)
    episodes: int = 100
    seed: int = 0
    options: Mapping[str, Any] = field(default_factory=dict)
    metrics: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()

    @property
    def info(self) -> dict[str, Any]:
        """Content of `study.json`."""
        return provenance() | {
            "kind": self.kind,
            "scenario": scenario_to_tree(self.setup.scenario),
            "variants": {variant.name: variant.info for variant in self.variants},
            "worlds": list(self.worlds),
            "episodes": self.episodes,
            "seed": self.seed,
            "options": dict(self.options),
            "commit": commit(),
            "left_out": [asdict(one) for one in self.left_out],
        }


@dataclass(frozen=True)
class VariantInfo:
    """One variant, as `study.json` has it."""

    title: str
    """Name in tables."""
    policies: tuple[str, ...]
    """Policies that play it."""
    worlds: tuple[str, ...] = ()
    """Worlds in which it is played; none: those of the study."""


@dataclass(frozen=True)
class StudyInfo:
    """Content of `study.json`."""

    __pydantic_config__ = OPEN

    command: str
    """The command that made the folder, or words on the call in Python."""
    started: str
    """Time of the command, ISO 8601."""
    kind: str
    """Kind of study: parts, ablation, corruption, paper, communication, sensing or board."""
    scenario: Mapping[str, Any]
    """The whole scenario of the first variant, defaults included."""
    variants: Mapping[str, VariantInfo]
    """Variants by the names of their folders."""
    worlds: tuple[str, ...]
    """Worlds of the variants that name none."""
    episodes: int
    """Episodes per variant, world and policy."""
    seed: int
    """Seed of every variant."""
    options: Mapping[str, Any]
    """Further options of the study."""
    commit: str = ""
    """Commit of the source, with `-dirty` if it was changed; empty where it is in no repository."""
    left_out: tuple[LeftOut, ...] = ()
    """Policies that were to play a variant and cannot."""


@dataclass(frozen=True)
class _CorruptionOptions:
    """Options of the studies that corrupt a team."""

    __pydantic_config__ = OPEN

    step: float
    whole_team: bool


def load_study_info(file: Path) -> StudyInfo:
    """Read `study.json`.

    Raises
    ------
    UserError
        If the file or one of its keys is missing or malformed, a name in it could be a path, or a
        link is in its folder.
    """
    check_files(file)
    info = check(StudyInfo, read_json(file), str(file), remedy=REMEDY)
    own = [world for variant in info.variants.values() for world in variant.worlds]
    check_names(str(file), {"variants": info.variants, "worlds": [*info.worlds, *own]})
    if info.kind in ("corruption", "paper"):
        check(_CorruptionOptions, info.options, f"{file}: options", remedy=REMEDY)
    return info


def variant_folder(folder: Path, name: str) -> Path:
    """Run folder of a variant of the study in `folder`."""
    return folder / "variants" / name


def run_study(
    study: Study,
    folder: Path,
    *,
    workers: Workers = THIS_PROCESS,
    progress: Progress = lambda done, total: None,
    begin: Callable[[], None] = lambda: None,
    resume: Resume = "same",
) -> dict[str, Any]:
    """Compute the missing runs of a study.

    Parameters
    ----------
    folder : study folder; an unfinished study of the same settings in it is resumed
    workers : processes or cluster that compute
    progress : called with (episodes done, episodes in all)
    begin : called once all is checked, before the first episode
    resume : treatment of a study that the folder holds

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
    invocation = workers.invocation({p for run in runs for p in run.policies}, study.metrics)
    if resume == "fresh":
        archive(folder, "study")
    found_in(folder, "study", study.info, IDENTITY)
    for run in runs:  # before anything is written: a study that is refused stays as it was
        run.folder.check(run.info, resume == "accept-code-change")
    open_folder(folder, "study", study.info, IDENTITY)
    with ExitStack() as stack:
        stack.enter_context(folder_lock(folder))
        for run in runs:
            run.open(accept=resume == "accept-code-change")
            stack.enter_context(run.folder.lock())
        begin()
        summaries: Sequence[Any] = run_all(runs, workers, invocation, progress)
        names = [variant.name for variant in study.variants]
        summary = dict(zip(names, summaries, strict=True))
        write_json(folder / "summary.json", summary)
    return summary


def _plan(study: Study, variant: Variant, folder: Path) -> Run:
    setup = Setup(variant.scenario, variant.grid or study.setup.grid)
    try:
        return Run.plan(
            setup,
            variant.policies,
            variant_folder(folder, variant.name),
            episodes=study.episodes,
            seed=study.seed,
            worlds=variant.worlds or study.worlds,
            metrics=study.metrics,
            kept=USUAL if variant is study.variants[0] else FIRST,
        )
    except UserError as error:
        if variant is study.variants[0]:  # the scenario as it is
            raise
        raise UserError(f"{study.kind} study, {variant.title}: {error}") from error
