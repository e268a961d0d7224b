"""`study` and `board`: many variants of a scenario, or many tasks, on the same episodes."""

from collections.abc import Callable, Mapping, Sequence
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
from mjforage.runs.storage import RunFolder
from mjforage.runs.studies import variants
from mjforage.runs.studies.benchmark_tasks import benchmark_tasks
from mjforage.runs.studies.board import board as board_plan
from mjforage.runs.studies.communication import communication
from mjforage.runs.studies.kinds import KINDS
from mjforage.runs.studies.sensing import sensing
from mjforage.runs.studies.study import Study as Plan
from mjforage.runs.studies.study import Variant, load_study_info, run_study, variant_folder
from mjforage.runs.workers import Workers

_VARIED: Mapping[str, Callable[..., tuple[Variant, ...]]] = {
    "ablation": variants.ablation,
    "corruption": variants.corruption,
    "paper": variants.paper,
    "communication": communication,
    "sensing": sensing,
}
"""Kind of study -> its variants, of scenario, policies and options."""


class Study:
    """A study in its folder, finished or not; `Study(folder)` opens one.

    Attributes
    ----------
    folder : study folder
    warnings : of the call that made it, each a line

    Examples
    --------
    >>> import mjforage as mf
    >>> lesser = mf.study("ablation", "open-bay", "levy", episodes=1, horizon=5, folder="study")
    >>> lesser.variants
    ('complete', 'scouts-less', 'foragers-less')
    >>> lesser.run("scouts-less").policies
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
    def complete(self) -> bool:
        """False for a study that was ended early; the same call completes it."""
        return (self.folder / "summary.json").is_file()

    @property
    def summary(self) -> pl.DataFrame:
        """As `Run.summary`, of all variants that have finished episodes.

        Raises
        ------
        UserError
            If none has.
        """
        found = self.variants if self.complete else tuple(filter(self._has_episodes, self.variants))
        if not found:
            raise UserError(
                f"{self.folder}: the study was ended before any episode was finished; run it again"
            )
        return pl.concat(
            self.run(one).summary.select(pl.lit(one).alias("variant"), pl.all()) for one in found
        )

    def _has_episodes(self, variant: str) -> bool:
        run = RunFolder(variant_folder(self.folder, variant))
        return run.finished("episodes") is not None

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
        partly = "" if self.complete else ", not complete"
        return f"Study({self._info.kind}, {len(self.variants)} variants, {self.folder}{partly})"


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

    Ctrl-C ends it within a second and returns what is finished; `Study.complete` is then False.

    Parameters
    ----------
    kind : ablation, corruption, paper, communication or sensing; see docs/studies.md
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
    checks.function("begin", begin)
    target, worlds = checks.path("folder", folder), checks.check_worlds(world)
    usual, given = KINDS[kind], _options(kind, options)
    players = Players.of(usual.policies if policies is None else policies)
    setup = pinned(scenario_of(usual.scenario if scenario is None else scenario, changes))
    words = f"{kind} study of {setup.scenario.name} on map {setup.grid.name}"
    with players.known() as names:
        varied = _VARIED[kind](setup.scenario, names, *given.values())
        about = episodes, seed, given, checks.texts("metrics", metrics)
        plan = Plan(kind, setup, varied, worlds, *about)
        how = Workers(jobs, scheduler), progress, resume, words, begin
        return _played(plan, target, players, *how)


def _options(kind: str, given: object) -> dict[str, Any]:
    """Options of a study in the order of its kind; raises `TypeError` or `UserError`."""
    usual, changed = KINDS[kind].options, checks.values("options", given)
    for name, value in changed.items():
        if name not in usual:
            raise UserError(f"option {name!r} of study {kind}: {nearest(name, usual)}")
        if not isinstance(usual[name], bool):
            checks.real(name, value, above=0.0)
        elif not isinstance(value, bool):
            raise TypeError(f"{name} is {type(value).__name__}; give True or False")
    return {**usual, **changed}


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

    Ctrl-C ends it within a second and returns what is finished; `Study.complete` is then False.

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
    checks.function("begin", begin)
    target, metrics = checks.path("folder", folder), checks.texts("metrics", metrics)
    players = Players.of(policies)
    given = {"tasks": tasks, "maps": maps, "overrides": overrides}
    found = benchmark_tasks(*(checks.texts(name, value) for name, value in given.items()))
    with players.known() as names:
        plan = board_plan(found, names, episodes=episodes, seed=seed, metrics=metrics)
        count = len({one for each in plan.variants for one in each.policies})
        how = Workers(jobs, scheduler), progress, resume, f"board of {count} policies", begin
        return _played(plan, target, players, *how)


def _played(
    plan: Plan,
    folder: Path,
    players: Players,
    workers: Workers,
    progress: bool | Callable[[int, int], None] | None,
    resume: Resume,
    words: str,
    begin: Callable[[str, Plan], None],
) -> Study:
    name, begun = "board" if plan.kind == "board" else "study", False
    warnings: Sequence[str] = ()

    def start() -> None:
        nonlocal begun
        begun = True  # the folder is that of this study
        begin(words, plan)

    try:
        with call(name) as warnings, bar(f"study {plan.kind}", "episodes", progress) as shown:
            how: dict[str, Any] = {"progress": shown, "resume": resume, "begin": start}
            run_study(plan, folder, workers=workers, **how)
    except KeyboardInterrupt:
        if not begun:
            raise
    return Study(folder, players, warnings)
