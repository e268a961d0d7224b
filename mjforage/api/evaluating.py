"""`evaluate`, `compare` and `load_run`: runs of policies on the same episodes."""

import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from mjforage.api import checks
from mjforage.api.calls import call
from mjforage.api.checks import Named
from mjforage.api.players import Players, Policies
from mjforage.api.progress import bar
from mjforage.api.run import Run
from mjforage.api.scenarios import on_device, scenario_of
from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import World, ladder_of
from mjforage.runs.evaluate import evaluate as run_evaluate
from mjforage.runs.resuming import Resume
from mjforage.runs.selection import USUAL
from mjforage.runs.workers import Workers
from mjforage.scenario.scenario import Device


def evaluate(
    scenario: Setup | Named,
    policies: Policies,
    *,
    episodes: int = 100,
    seed: int = 0,
    world: World | Sequence[World] = "graph",
    device: Device | None = None,
    jobs: int = 1,
    folder: Named | None = None,
    metrics: Sequence[str] = (),
    record: Sequence[str | int] = USUAL,
    resume: Resume = "same",
    scheduler: str = "",
    progress: bool | Callable[[int, int], None] | None = None,
    **changes: Any,
) -> Run:
    """Play policies on the same episodes of a scenario.

    The numbers depend on scenario, policies and seed alone, not on `jobs` or `folder`. Ctrl-C ends
    it within a second and returns what is finished; `Run.complete` is then False.

    Parameters
    ----------
    scenario : of `load_scenario`, a shipped name, or a TOML file
    policies : one, a list, or a dict of name -> policy; each a name with options such as
        ``"greedy(distance=2)"``, a class or object with `reset` and `act`, a function of a `View`,
        a file of weights (``.safetensors``), or a loaded model of Stable-Baselines3
    episodes : for each policy and world
    seed : 0 to 2**64 - 1; episode i is the same for every policy and world
    world : one world or several; see `mf.names("worlds")`
    device : engine of the hulls, that of the scenario by default: "cpu", or MuJoCo Warp on this
        processor ("warp-cpu", slow) or on a GPU ("cuda"); another device is another run
    jobs : processes
    folder : run folder, as the command line writes it; what it holds of the same run is resumed.
        None: nothing is left on disk
    metrics : names besides those of every run, such as ``mse_33`` or ``package.module:Class``
    record : episodes to record for reports and films: numbers, first, median, worst, best
    resume : what to do with a run that the folder holds: "same" resumes only the same run, "fresh"
        keeps it aside as NAME.before-TIME, "accept-code-change" resumes it although code differs
    scheduler : address of a dask scheduler, whose workers compute instead of `jobs`
    progress : True shows a bar, a function is called with (done, total); None: a bar where a
        person is watching
    changes : as of `Scenario.replace`

    Raises
    ------
    UserError
        For names, values and files that cannot be used, each in a line.

    Examples
    --------
    >>> import mjforage as mf
    >>> run = mf.evaluate("open-bay", ["greedy", "levy"], episodes=2, horizon=20)
    >>> run.episodes.height
    4
    """
    checks.check_play(episodes, seed, jobs, scheduler, resume, progress)
    options: dict[str, Any] = {"episodes": int(episodes), "seed": int(seed), "resume": resume}
    options |= {"worlds": checks.check_worlds(world), "metrics": checks.texts("metrics", metrics)}
    options |= {"kept": _recorded(record), "workers": Workers(int(jobs), scheduler)}
    given = None if folder is None else checks.path("folder", folder)
    players = Players.of(policies)
    temporary = Path(tempfile.mkdtemp(prefix="mjforage-")) if given is None else None
    target = given or temporary / "run"  # type: ignore[operator]
    warnings: Sequence[str] = ()
    try:
        with (
            call("evaluate") as warnings,
            players.known() as names,
            bar("evaluate", "episodes", progress) as shown,
        ):
            setup = scenario_of(scenario, changes, evaluate)
            setup = on_device(setup, device, options["worlds"])
            run_evaluate(setup, names, target, progress=shown, **options)
    except KeyboardInterrupt:
        if not (target / "run.json").is_file():
            _remove(temporary)
            raise
    except BaseException:
        _remove(temporary)
        raise
    return Run(target, temporary, players, warnings)


def compare(
    scenario: Setup | Named,
    policies: Policies,
    *,
    episodes: int = 20,
    ladder: bool = False,
    device: Device | None = None,
    seed: int = 0,
    jobs: int = 1,
    folder: Named | None = None,
    metrics: Sequence[str] = (),
    record: Sequence[str | int] = USUAL,
    resume: Resume = "same",
    scheduler: str = "",
    progress: bool | Callable[[int, int], None] | None = None,
    **changes: Any,
) -> Run:
    """Play policies on the same episodes at graph level and in MuJoCo.

    Parameters
    ----------
    scenario, policies : as of `evaluate`
    episodes : for each policy and world
    ladder : also the fidelity levels between, each with one effect more
    device, seed, jobs, folder, metrics, record, resume, scheduler, progress, changes : as of
        `evaluate`

    Raises
    ------
    UserError
        As `evaluate`.

    Examples
    --------
    >>> import mjforage as mf
    >>> gap = mf.compare("open-bay", "greedy", episodes=1, horizon=5)
    >>> gap.differences(world=("graph", "physics"), metrics=["pta_d"])["world"].to_list()
    ['physics - graph']
    """
    if "world" in changes:
        raise UserError("compare takes no world; give evaluate(..., world=[...]) those you want")
    setup = scenario_of(scenario, changes, compare)
    with call("compare"):
        return evaluate(
            setup,
            policies,
            episodes=episodes,
            seed=seed,
            world=ladder_of(setup.scenario) if ladder else ("graph", "physics"),
            device=device,
            jobs=jobs,
            folder=folder,
            metrics=metrics,
            record=record,
            resume=resume,
            scheduler=scheduler,
            progress=progress,
        )


def load_run(folder: Named, *, policies: Policies = ()) -> Run:
    """Open a run folder, of this package or its command line.

    Parameters
    ----------
    policies : policies of the run that were objects of the process that made it, or are your own
        ``package.module:Class``: its films may simulate their episodes again. An object is known by
        its name, or by that of a dict of name -> policy

    Raises
    ------
    UserError
        If it is no run folder, or a file in it is damaged.

    Examples
    --------
    >>> import mjforage as mf
    >>> run = mf.evaluate("open-bay", "greedy", episodes=1, horizon=5, folder="runs/first")
    >>> mf.load_run("runs/first")
    Run(open-bay, graph, greedy, 1 episode, seed 0)
    """
    return Run(checks.path("folder", folder), players=Players.of(policies))


def _recorded(record: object) -> tuple[str | int, ...]:
    """Episodes to record; raises `TypeError` for what is neither a list nor a name."""
    several = [record] if isinstance(record, str) else record
    if not isinstance(several, Sequence):
        raise TypeError(f"record is {type(record).__name__}; give a list such as [0, 'worst']")
    return tuple(one if isinstance(one, str) else checks.whole("record", one, 0) for one in several)


def _remove(folder: Path | None) -> None:
    if folder is not None:
        shutil.rmtree(folder, ignore_errors=True)
