"""`evaluate`, `compare` and `load_run`: runs of policies on the same episodes."""

import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal, get_args

from mjforage.api.calls import call
from mjforage.api.players import Players
from mjforage.api.progress import bar
from mjforage.api.run import Run
from mjforage.api.scenarios import Named, scenario_of
from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import WORLDS, ladder_of
from mjforage.runs.evaluate import evaluate as run_evaluate
from mjforage.runs.resuming import Resume
from mjforage.runs.selection import USUAL
from mjforage.runs.workers import Workers

World = Literal["graph", "hulls", "calibrated", "debris", "intake", "physics"]


def evaluate(
    scenario: Setup | Named,
    policies: object,
    *,
    episodes: int = 100,
    seed: int = 0,
    world: World | Sequence[str] = "graph",
    jobs: int = 1,
    folder: Named | None = None,
    metrics: Sequence[str] = (),
    record: Sequence[str | int] = USUAL,
    resume: Resume = "same",
    workers: Workers | None = None,
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
    jobs : processes
    folder : run folder, as the command line writes it; what it holds of the same run is resumed.
        None: nothing is left on disk
    metrics : ``package.module:Class`` of metrics besides ours
    record : episodes to record for reports and films: numbers, first, median, worst, best
    resume : what to do with a run that the folder holds: "same" resumes only the same run, "fresh"
        keeps it aside as NAME.before-TIME, "accept-code-change" resumes it although code differs
    workers : a dask cluster instead of `jobs`
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
    check_whole(episodes=episodes, seed=seed, jobs=jobs)
    check_kinds(folder, resume, progress)
    worlds = worlds_of(world)
    players = Players.of(policies)
    temporary = Path(tempfile.mkdtemp(prefix="mjforage-")) if folder is None else None
    target = Path(folder) if folder is not None else temporary / "run"  # type: ignore[operator]
    options: dict[str, Any] = {"episodes": episodes, "seed": seed, "worlds": worlds}
    options |= {"metrics": tuple(metrics), "kept": tuple(record), "resume": resume}
    warnings: Sequence[str] = ()
    try:
        with (
            call("evaluate") as warnings,
            players.known() as names,
            bar("evaluate", "episodes", progress) as shown,
        ):
            run_evaluate(
                scenario_of(scenario, changes),
                names,
                target,
                workers=workers or Workers(jobs),
                progress=shown,
                **options,
            )
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
    policies: object,
    *,
    episodes: int = 20,
    ladder: bool = False,
    **options: Any,
) -> Run:
    """Play policies on the same episodes at graph level and in MuJoCo.

    Parameters
    ----------
    scenario, policies : as of `evaluate`
    episodes : for each policy and world
    ladder : also the fidelity levels between, each with one effect more
    options : all others of `evaluate` but `world`

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
    if "world" in options:
        raise UserError("compare takes no world; give evaluate(..., world=[...]) those you want")
    names = {"jobs", "seed", "folder", "metrics", "record", "resume", "workers", "progress"}
    changes = {key: options.pop(key) for key in list(options) if key not in names}
    setup = scenario_of(scenario, changes)
    worlds = ladder_of(setup.scenario) if ladder else ("graph", "physics")
    with call("compare"):
        return evaluate(setup, policies, episodes=episodes, world=worlds, **options)


def load_run(folder: Named, *, policies: object = ()) -> Run:
    """Open a run folder, of this package or its command line.

    Parameters
    ----------
    policies : those of the run that were objects of the process that made it, for its films

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
    check_kinds(folder)
    return Run(Path(folder), players=Players.of(policies))


def _remove(folder: Path | None) -> None:
    if folder is not None:
        shutil.rmtree(folder, ignore_errors=True)


def worlds_of(world: object) -> tuple[str, ...]:
    """Names of worlds, of one or several; raises `UserError` for anything else."""
    several = (world,) if isinstance(world, str) else world
    if not isinstance(several, Sequence) or not several:
        raise UserError(f"world {world!r}: give one of {', '.join(WORLDS)}, or several in a list")
    return tuple(str(one) for one in several)


def check_kinds(folder: object, resume: object = "same", progress: object = None) -> None:
    """Refuse options of a wrong kind; raises `TypeError` or `UserError`."""
    if folder is not None and not isinstance(folder, str | os.PathLike):
        raise TypeError(f"folder is {type(folder).__name__}; give a path")
    if resume not in get_args(Resume):
        raise UserError(f"resume {resume!r}: choose {', '.join(get_args(Resume))}")
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(f"progress is {type(progress).__name__}; give True, False or a function")


def check_whole(**numbers: object) -> None:
    """Refuse what is no whole number; raises `TypeError`."""
    for name, value in numbers.items():
        if isinstance(value, bool) or not hasattr(value, "__index__"):
            raise TypeError(f"{name} is {type(value).__name__}; give a whole number")
