"""`study` and `board`: many variants of a scenario, or many tasks, on the same episodes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import polars as pl

from mjforage.api import checks
from mjforage.api.calls import call
from mjforage.api.checks import Named
from mjforage.api.players import Players
from mjforage.api.progress import bar
from mjforage.api.run import NOBODY, Run
from mjforage.api.scenarios import scenario_of
from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.mission.setup import Setup
from mjforage.runs.identity import pinned
from mjforage.runs.resuming import Resume
from mjforage.runs.studies import variants
from mjforage.runs.studies.benchmark_tasks import benchmark_tasks
from mjforage.runs.studies.board import board as board_plan
from mjforage.runs.studies.communication import communication
from mjforage.runs.studies.sensing import sensing
from mjforage.runs.studies.study import Study as Plan
from mjforage.runs.studies.study import Variant, load_study_info, run_study, variant_folder
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario import Scenario as Settings

PAPER = ("ddqn", "ddqn-reward", "greedy", "levy", "wanderer")
INFORMED = ("greedy", "belief", "ddqn")


@dataclass(frozen=True)
class Kind:
    """A kind of study: what it varies by default, and how."""

    scenario: str
    policies: tuple[str, ...]
    varied: Callable[..., tuple[Variant, ...]]  # of scenario, policies and the options
    options: Mapping[str, Any]


def _parts(scenario: Settings, policies: Sequence[str]) -> tuple[Variant, ...]:
    return variants.parts(scenario)


KINDS: dict[str, Kind] = {
    "parts": Kind("published", (), _parts, {}),
    "ablation": Kind("published", PAPER, variants.ablation, {}),
    "corruption": Kind(
        "published", PAPER, variants.corruption, {"step": 0.05, "whole_team": False}
    ),
    "paper": Kind("published", PAPER, variants.paper, {"step": 0.05, "whole_team": True}),
    "communication": Kind("comb-port", INFORMED, communication, {}),
    "sensing": Kind("comb-port", INFORMED, sensing, {}),
}
"""Name -> study."""


class Study:
    """A study in its folder, finished or not; `Study(folder)` opens one.

    Attributes
    ----------
    folder : study folder
    warnings : of the call that made it, each a line

    Examples
    --------
    >>> import mjforage as mf
    >>> parts = mf.study("ablation", "open-bay", "levy", episodes=1, horizon=5, folder="study")
    >>> parts.variants
    ('complete', 'scouts-less', 'foragers-less')
    >>> parts.run("scouts-less").policies
    ('levy',)
    """

    def __init__(
        self, folder: Named, players: Players = NOBODY, warnings: Sequence[str] = ()
    ) -> None:
        """Open a study folder."""
        self.folder, self._players = checks.path("folder", folder), players
        self.warnings = tuple(warnings)
        self._info = load_study_info(self.folder / "study.json")

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of the variants; the first is the scenario as it is."""
        return tuple(self._info.variants)

    def run(self, variant: str) -> Run:
        """Run of a variant.

        Raises
        ------
        UserError
            If there is no such variant, or it has not been started.
        """
        checks.one_of("variant", variant, self.variants)
        return Run(variant_folder(self.folder, variant), players=self._players)

    @property
    def summary(self) -> pl.DataFrame:
        """As `Run.summary`, of all variants."""
        return pl.concat(
            self.run(one).summary.select(pl.lit(one).alias("variant"), pl.all())
            for one in self.variants
        )

    def report(
        self, *, tables: str | Sequence[str] = (), figures: str | Sequence[str] = ()
    ) -> Path:
        """Write `report.html` with its tables and figures into the folder.

        Parameters
        ----------
        tables : formats of tables, besides csv: latex, markdown
        figures : formats of figures: pdf, png, svg

        Raises
        ------
        UserError
            If the study is not finished, or a file cannot be written.
        """
        from mjforage.view.report import Exports
        from mjforage.view.report.studies import write_study_report

        exports = Exports.of(checks.texts("tables", tables), checks.texts("figures", figures))
        return write_study_report(self.folder, exports)

    def board_page(self, path: Named) -> Path:
        """Write a board as one Markdown page, with its figures beside it.

        Raises
        ------
        UserError
            If the study is no finished board, or a file cannot be written.
        """
        from mjforage.view.report.studies.board_page import write_board_page

        return write_board_page(self.folder, checks.path("path", path))

    def __repr__(self) -> str:
        return f"Study({self._info.kind}, {len(self.variants)} variants, {self.folder})"


def study(
    kind: str,
    scenario: "Setup | Named | None" = None,
    policies: object = None,
    *,
    folder: Named,
    world: str | Sequence[str] = "graph",
    episodes: int = 100,
    seed: int = 0,
    jobs: int = 1,
    metrics: Sequence[str] = (),
    options: Mapping[str, Any] | None = None,
    resume: Resume = "same",
    scheduler: str = "",
    progress: bool | Callable[[int, int], None] | None = None,
    begin: Callable[[str, Plan], None] = lambda words, plan: None,
    **changes: Any,
) -> Study:
    """Play variants of a scenario on the same episodes, in a study folder.

    Parameters
    ----------
    kind : parts, ablation, corruption, paper, communication or sensing; see docs/studies.md
    scenario, policies, changes : as of `evaluate`; by default the kind's own
    folder : study folder; what it holds of the same study is resumed
    world, episodes, seed, jobs, metrics, resume, scheduler, progress : as of `evaluate`
    options : of corruption and paper: step (distance of levels), whole_team (one draw for a team)
    begin : called with words and the plan, before the first episode

    Raises
    ------
    UserError
        For names, values and files that cannot be used.

    Examples
    --------
    >>> import mjforage as mf
    >>> few = {"episodes": 1, "horizon": 5, "folder": "study"}
    >>> mf.study("communication", "open-bay", "levy", **few).summary.columns[:3]
    ['variant', 'world', 'policy']
    """
    checks.one_of("study", kind, KINDS)
    checks.check_play(episodes, seed, jobs, scheduler, resume, progress)
    target, worlds = checks.path("folder", folder), checks.check_worlds(world)
    chosen, given = KINDS[kind], dict(options or {})
    for name in given:
        if name not in chosen.options:
            raise UserError(f"option {name!r} of study {kind}: {nearest(name, chosen.options)}")
    given = {**chosen.options, **given}
    players = Players.of(chosen.policies if policies is None else policies)
    setup = pinned(scenario_of(chosen.scenario if scenario is None else scenario, changes))
    words = f"{kind} study of {setup.scenario.name} on map {setup.grid.name}"
    with players.known() as names:
        varied = chosen.varied(setup.scenario, names, *given.values())
        about = episodes, seed, given, checks.texts("metrics", metrics)
        plan = Plan(kind, setup, varied, worlds, *about)
        how = Workers(jobs, scheduler), progress, resume, partial(begin, words)
        return _played(plan, target, players, *how)


def board(
    tasks: Sequence[str] = (),
    policies: object = (),
    *,
    folder: Named,
    maps: Sequence[str] = (),
    overrides: Sequence[str] = (),
    episodes: int = 100,
    seed: int = 0,
    jobs: int = 1,
    metrics: Sequence[str] = (),
    resume: Resume = "same",
    scheduler: str = "",
    progress: bool | Callable[[int, int], None] | None = None,
    begin: Callable[[str, Plan], None] = lambda words, plan: None,
) -> Study:
    """Play every policy on the same episodes of several benchmark tasks, in a study folder.

    Parameters
    ----------
    tasks : SCENARIO or SCENARIO@WORLD each; none: those of docs/board.md
    policies : as of `evaluate`; none: all that have a name. One that cannot play a task is left
        out of it
    folder : study folder; what it holds of the same study is resumed
    maps : further tasks, the rules of comb-port on these maps
    overrides : KEY=VALUE of every scenario
    episodes, seed, jobs, metrics, resume, scheduler, progress, begin : as of `study`

    Raises
    ------
    UserError
        For names, values and files that cannot be used.

    Examples
    --------
    >>> import mjforage as mf
    >>> few = {"episodes": 1, "overrides": ["horizon=5"]}
    >>> found = mf.board(["open-bay"], ["levy"], folder="board", **few)
    >>> found.variants
    ('open-bay',)
    """
    checks.check_play(episodes, seed, jobs, scheduler, resume, progress)
    target, metrics = checks.path("folder", folder), checks.texts("metrics", metrics)
    players = Players.of(policies)
    given = {"tasks": tasks, "maps": maps, "overrides": overrides}
    found = benchmark_tasks(*(checks.texts(name, value) for name, value in given.items()))
    with players.known() as names:
        plan = board_plan(found, names, episodes=episodes, seed=seed, metrics=metrics)
        count = len({one for each in plan.variants for one in each.policies})
        words = partial(begin, f"board of {count} policies")
        return _played(plan, target, players, Workers(jobs, scheduler), progress, resume, words)


def _played(
    plan: Plan,
    folder: Path,
    players: Players,
    workers: Workers,
    progress: bool | Callable[[int, int], None] | None,
    resume: Resume,
    begin: Callable[[Plan], None],
) -> Study:
    name = "board" if plan.kind == "board" else "study"
    with call(name) as warnings, bar(f"study {plan.kind}", "episodes", progress) as shown:
        how: dict[str, Any] = {"progress": shown, "resume": resume}
        run_study(plan, folder, workers=workers, begin=lambda: begin(plan), **how)
    return Study(folder, players, warnings)
