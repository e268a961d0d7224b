"""`mjforage train`: a run in a folder, from its checkpoint if there is one, to its end.

Folder: `training.json` (command, algorithm, scenario, hyperparameters, seed, versions),
`training.parquet`, `evaluations.parquet`, `tensorboard/`, `checkpoint.safetensors`,
`weights.safetensors` (latest) and `best.safetensors` (of the best evaluation).
"""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import torch

from mjforage.base.errors import UserError
from mjforage.graph_planner.encodings import encoder_class
from mjforage.graph_planner.networks.weights import ground_note
from mjforage.learning.environments.rewards import term_class
from mjforage.learning.training.algorithm import Algorithm, save_weights
from mjforage.learning.training.algorithm_validation import check_parts, checked_row
from mjforage.learning.training.checkpoint import identity, restore_checkpoint, save_checkpoint
from mjforage.learning.training.hyperparameters import CommonHyperparameters, Hyperparameters
from mjforage.learning.training.initial_weights import initial_file
from mjforage.learning.training.logs import Logs
from mjforage.learning.training.progress import Row
from mjforage.learning.training.trainer import Trainer
from mjforage.mission.setup import Setup
from mjforage.runs.fingerprint import our_code
from mjforage.runs.identity import (
    files_hash,
    hull_facts,
    outside_code_of,
    provenance,
    text_hash,
    versions,
    weather_hashes,
    weight_hashes,
    whole_paths,
)
from mjforage.runs.interrupts import stop_noted
from mjforage.runs.lock import folder_lock
from mjforage.runs.resuming import CODE, Resume, archive, open_folder
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import canonical_json

CHECKPOINT_S = 300.0  # between two checkpoints
CHECKPOINT = "checkpoint"  # name of what is reported when a run goes on
FINISHED = "finished"  # the same when nothing is left to do
STOPPING = (
    "train: stops at the end of this round and keeps it; once more stops at once, and what came "
    "after the last checkpoint is lost"
)
IDENTITY = (
    *("algorithm", "seed", "device", "hyperparameters", "scenario", "also", "evaluate"),
    *("maps", "weights", "hulls"),
    *CODE,
)
"""Keys of `training.json` in which two runs must agree for one to go on where the other stopped."""

Report = Callable[[str, Row], None]
Made = TypeVar("Made", bound=Algorithm[Any])


def train(
    scenario: Scenario, hyperparameters: Hyperparameters, folder: Path, **options: Any
) -> Trainer:
    """Train the Double DQN; `options` are those of `train_with`."""
    return train_with(Trainer, scenario, hyperparameters, folder, **options)


def train_with(
    algorithm: type[Made],
    scenario: Scenario,
    hyperparameters: CommonHyperparameters,
    folder: Path,
    *,
    also: Sequence[Scenario] = (),
    evaluate: Sequence[Scenario] = (),
    seed: int = 0,
    hours: float | None = None,
    updates: int | None = None,
    device: str = "auto",
    report: Report = lambda table, row: None,
    resume: Resume = "same",
) -> Made:
    """Train until the run has lasted so long, or its networks have had so many updates.

    Both count from the run's beginning, over all processes that worked on it. The end of a round is
    awaited, also after Ctrl-C or a scheduler's SIGTERM, whose `KeyboardInterrupt` follows a
    checkpoint; a second one stops at once. A run is deterministic on the CPU; on a GPU it is not to
    the bit. Raises `UserError` if there is no end, a scenario, the seed or the teacher is not
    valid, the device is missing, the folder holds another run or is being written, the algorithm
    has no networks or tensors that could be kept, or a round gives no row.

    Parameters
    ----------
    hyperparameters : of the algorithm's `settings`
    also : scenarios that rounds take in turn with the first
    evaluate : scenarios that share the episodes of evaluations; none: the first
    folder : of the run; a run of the same scenario, hyperparameters, seed and device in it goes on
    hours, updates : where to stop; at least one
    device : auto, cpu or cuda
    report : called with every row that is logged, and its table's name; with `CHECKPOINT` and how
        far it had come, if the folder's run goes on, or `FINISHED` if it had come to this end
    resume : treatment of a run that the folder holds
    """
    _check_ends(hours, updates)
    played = [whole_paths(one) for one in (scenario, *also)]
    trainer = algorithm(played, hyperparameters, seed, _device(device))
    check_parts(trainer)
    trainer.begin()
    if evaluate:
        trainer.evaluate_on([whole_paths(one) for one in evaluate])
    if resume == "fresh":
        archive(folder, "training")
    open_folder(folder, "training", _facts(trainer), IDENTITY, resume == "accept-code-change")
    with folder_lock(folder):
        _go_on(trainer, folder, hours, updates, report)
    return trainer


def _go_on(
    trainer: Algorithm[Any], folder: Path, hours: float | None, updates: int | None, report: Report
) -> None:
    """Rounds from the folder's checkpoint, if there is one, to the end."""
    checkpoint, hyperparameters = folder / "checkpoint.safetensors", trainer.hyperparameters
    if checkpoint.is_file():
        restore_checkpoint(trainer, checkpoint)
        over = _over(trainer, hours, updates)
        report(FINISHED if over else CHECKPOINT, trainer.come("rounds", "updates", "seconds"))
    logs, progress = Logs(folder, trainer.progress), trainer.progress
    if hyperparameters.initial and not progress.rounds:
        _evaluate(trainer, folder, logs, report)
    saved = time.perf_counter()
    with stop_noted(STOPPING) as stopped:
        while not _over(trainer, hours, updates):
            row = checked_row(trainer, trainer.play_round())
            logs.add("training", row)
            report("training", row)
            over = _over(trainer, hours, updates)
            due = progress.updates >= hyperparameters.evaluate_every + progress.evaluated
            if due or over:
                _evaluate(trainer, folder, logs, report)
                if due:
                    progress.evaluated = progress.updates
            stop = stopped() and not over
            if over or stop or time.perf_counter() - saved > CHECKPOINT_S:
                logs.write()  # first: what is younger than the checkpoint is dropped, not missed
                save_weights(trainer, folder / "weights.safetensors")
                trainer.book_time()
                save_checkpoint(trainer, checkpoint)
                saved = time.perf_counter()
            if stop:
                raise KeyboardInterrupt
    logs.close()


def _evaluate(trainer: Algorithm[Any], folder: Path, logs: Logs, report: Report) -> None:
    """Scores of the networks as they are; they are kept if none were better."""
    found, progress = trainer.evaluate(), trainer.progress
    logs.add("evaluations", found)
    report("evaluations", found)
    if found["rank"] < progress.best:
        progress.best = found["rank"]
        save_weights(trainer, folder / "best.safetensors")


def _check_ends(hours: float | None, updates: int | None) -> None:
    if hours is None and updates is None:
        raise UserError("train: no end given; give hours or updates, such as hours = 2")
    for name, value in (("hours", hours), ("updates", updates)):
        if value is not None and not 0 < value < float("inf"):
            raise UserError(f"train: {name} {value}: give a positive number")


def _over(trainer: Algorithm[Any], hours: float | None, updates: int | None) -> bool:
    progress = trainer.progress
    late = hours is not None and progress.seconds >= 3600.0 * hours
    return late or (updates is not None and progress.updates >= updates)


def _device(name: str) -> str:
    """The device to use. Raises `UserError` if there is none of that name."""
    if name not in ("auto", "cpu", "cuda"):
        raise UserError(f"device {name}: choose auto, cpu or cuda")
    if name == "cuda" and not torch.cuda.is_available():
        raise UserError("device cuda: torch finds no GPU here; choose cpu")
    return ("cuda" if torch.cuda.is_available() else "cpu") if name == "auto" else name


def _facts(trainer: Algorithm[Any]) -> dict[str, object]:
    """Content of `training.json`."""
    settings = trainer.hyperparameters
    teachers = [one for one in (getattr(settings, "teacher", ""),) if one]
    libraries = ("torch", "torchrl", *(() if settings.world == "graph" else ("mujoco",)))
    found: list[Callable[..., Any]] = [type(trainer), encoder_class(settings.observation)]
    found += map(term_class, settings.reward)
    code = our_code(libraries, learning=True).joined(outside_code_of(teachers, found))
    weights, hulls, setups = weight_hashes(teachers), {}, _setups(trainer)
    if settings.initial:
        weights |= {settings.initial: files_hash([initial_file(settings.initial)])}
    if settings.world != "graph":
        hulls = {"hulls": _hulls(setups, [settings.world])}
    return {
        "command": provenance()["command"],
        "instructions": torch.backends.cpu.get_cpu_capability(),
        **identity(trainer),
        "maps": _maps(setups),
        "weights": weights,
        **hulls,
        "versions": versions(code),
        "code": code.hashes,
    }


def _setups(trainer: Algorithm[Any]) -> list[Setup]:
    """Setups of the training, and of its evaluations."""
    played = [each for task in trainer.tasks for each in task.examples]
    if trainer.evaluation.scenarios != (trainer.setup.scenario,):
        played += trainer.evaluation.examples()
    return [each.setup for each in played]


def _maps(setups: Sequence[Setup]) -> str:
    """Hash of maps, starts and records: a file may have changed, its name stays."""
    found = [
        (ground_note(setup.task)["map"], setup.start_cells, *weather_hashes(setup).values())
        for setup in setups
    ]
    return text_hash(canonical_json(found))


def _hulls(setups: Sequence[Setup], worlds: Sequence[str]) -> str:
    """Hash of the hulls, debris and capture models that are played with."""
    return text_hash(canonical_json([hull_facts(setup, worlds) for setup in setups]))
