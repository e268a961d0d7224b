"""`train`: a policy learned from a scenario, as weights."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import ceil
from pathlib import Path
from typing import Any

from mjforage.api import checks
from mjforage.api.calls import call
from mjforage.api.checks import Named
from mjforage.api.maps import Map
from mjforage.api.progress import bar
from mjforage.api.scenarios import reads_as, scenario_of
from mjforage.base.atomic_files import write_errors
from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.mission.setup import Setup
from mjforage.runs.resuming import Resume
from mjforage.scenario.scenario import Scenario as Settings
from mjforage.scenario.scenario_file import load_scenario


def train(
    algorithm: str,
    scenario: Setup | Named,
    *,
    folder: Named,
    updates: int | None = None,
    hours: float | None = None,
    seed: int = 0,
    settings: Mapping[str, Any] | None = None,
    also: "Setup | Settings | Named | Sequence[Setup | Settings | Named]" = (),
    evaluate: "Setup | Settings | Named | Sequence[Setup | Settings | Named]" = (),
    device: str = "auto",
    resume: Resume = "same",
    progress: bool | Callable[[int, int], None] | None = None,
    report: Callable[[str, dict[str, float]], None] = lambda table, row: None,
    **changes: Any,
) -> Path:
    """Train a policy; the same call resumes a training that was stopped.

    Ctrl-C ends it after the round that is played, with a checkpoint; a second one ends it at once.

    Parameters
    ----------
    algorithm : ddqn, mappo, a name that an installed package brings, or ``package.module:Class``
    scenario, changes : as of `evaluate`
    folder : of the training: logs, checkpoint, weights
    updates, hours : where to stop; at least one
    seed : 0 to 2**64 - 1
    settings : learning hyperparameters by name, such as ``{"num_envs": 32, "reward.removed": 2}``
    also : scenarios, or one, that rounds take in turn with the first; ``SCENARIO:MAP`` is one on
        another map, which may be a family of harbours
    evaluate : scenarios of the evaluations, as `also`; none: the first
    device : auto, cpu or cuda
    resume, progress : as of `evaluate`; updates are counted, or minutes where `hours` alone is
        given
    report : called with the name of a table and every row that is logged

    Returns
    -------
    Path
        The weights of the best evaluation, which `evaluate` plays; the latest before the first.

    Raises
    ------
    UserError
        For names, values and files that cannot be used, or without the extra ``learn``.

    Examples
    --------
    >>> import mjforage as mf
    >>> tiny = {"num_envs": 2, "capacity": 1000, "batch": 4, "warmup": 4, "evaluate_episodes": 1}
    >>> mf.train("ddqn", "open-bay", horizon=4, updates=1, settings=tiny, folder="learned").suffix
    '.safetensors'
    """
    require(f"train {algorithm}", "torch", "tensorboard")
    from mjforage.learning.training.algorithms import find_algorithm
    from mjforage.learning.training.hyperparameters import changed
    from mjforage.learning.training.run import train_with

    target = checks.path("folder", folder)
    checks.whole("seed", seed, 0, 2**64 - 1)
    checks.check_resume(resume)
    checks.check_progress(progress)
    checks.function("report", report)
    if updates is not None:
        checks.whole("updates", updates, 1)
    if hours is not None:
        checks.real("hours", hours, above=0.0)
    made = find_algorithm(checks.text("algorithm", algorithm))
    given = checks.values("settings", settings)
    if given.get("teacher") and not hasattr(made.settings, "teacher"):
        raise UserError(
            f"teacher {given['teacher']}: {algorithm} takes none; leave it out, or give its "
            "settings the fields teacher and teacher_updates"
        )
    unit = "minutes" if updates is None else "updates"
    with call("train"), bar(f"train {algorithm}", unit, progress) as shown:

        def logged(table: str, row: dict[str, float]) -> None:
            if updates is not None:
                shown(min(int(row["updates"]), updates), updates)
            elif hours is not None:
                total = ceil(60 * hours)
                shown(min(ceil(row["seconds"] / 60), total), total)
            report(table, row)

        train_with(
            made,
            _on_file(scenario_of(scenario, changes), target),
            changed(made.settings(), given),
            target,
            also=_several("also", also, target),
            evaluate=_several("evaluate", evaluate, target),
            seed=seed,
            hours=hours,
            updates=updates,
            device=device,
            report=logged,
            resume=resume,
        )
    best = target / "best.safetensors"
    return best if best.is_file() else target / "weights.safetensors"


def _on_file(setup: Setup, folder: Path) -> Settings:
    """The scenario, its map in a file: beside the folder, with its name, if it came as an array."""
    if reads_as(setup):
        return setup.asked
    choice, grid = setup.asked.map, setup.grid
    file = folder.with_name(f"{folder.name}.{'place' if grid.place else 'map.csv'}")
    with write_errors(file):
        file.parent.mkdir(parents=True, exist_ok=True)
    Map.of(grid, choice.pitch_m, ()).to_file(file)
    return replace(setup.asked, map=replace(choice, file=str(file), water="light"))


def _several(name: str, given: object, folder: Path) -> list[Settings]:
    """Scenarios of a list, or of one; raises `TypeError` for anything else."""
    several = [given] if isinstance(given, Setup | Settings | str | os.PathLike) else given
    if not isinstance(several, Sequence):
        raise TypeError(f"{name} is {type(given).__name__}; give a list of scenarios")
    beside = f"{folder.name}.{name}"
    return [
        _settings(name, one, folder.with_name(f"{beside}-{place}"))
        for place, one in enumerate(several)
    ]


def _settings(name: str, given: object, place: Path) -> Settings:
    """Of `SCENARIO:MAP` with the map's own starts, or a random cluster."""
    if isinstance(given, Settings):
        return given
    if isinstance(given, Setup):
        return _on_file(given, place)
    if not isinstance(given, str | os.PathLike):
        raise TypeError(f"{name} has {type(given).__name__}; give scenarios, names or TOML files")
    start, separator, file = os.fspath(given).partition(":")
    scenario = load_scenario(start)
    if not separator:
        return scenario
    return replace(scenario, map=replace(scenario.map, file=file, starts=None, water="light"))
