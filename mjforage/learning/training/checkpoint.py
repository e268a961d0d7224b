"""Checkpoints: one safetensors file with all that later rounds depend on.

Tensors are networks, optimisers and replays; counters, identity and the state of the random
generator are JSON in the file's header, so a checkpoint is whole or absent.
"""

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError, safe_open

from mjforage.base.errors import UserError
from mjforage.learning.training.algorithm import Algorithm
from mjforage.learning.training.files import save_tensors
from mjforage.learning.training.progress import Progress
from mjforage.scenario.scenario_file import scenario_to_tree
from mjforage.scenario.schema import check

FORMAT = "mjforage training checkpoint 5"
_NOTE = "mjforage"
REMEDY = "remove it or give another folder"


@dataclass(frozen=True)
class _Notes:
    """Header of a checkpoint."""

    format: str
    identity: Mapping[str, Any]
    progress: Progress
    random: Mapping[str, Any]


def identity(trainer: Algorithm[Any]) -> dict[str, Any]:
    """Facts that two runs must share for one to go on where the other stopped."""
    first, *others = (task.scenario for task in trainer.tasks)
    made, judged = type(trainer), trainer.evaluation.scenarios
    return {
        "algorithm": f"{made.__module__}:{made.__qualname__}",
        "scenario": scenario_to_tree(first),
        "also": [scenario_to_tree(scenario) for scenario in others],
        "hyperparameters": trainer.hyperparameters.tree(),
        "seed": trainer.seed,
        "device": trainer.device,
    } | ({} if judged == (first,) else {"evaluate": [scenario_to_tree(one) for one in judged]})


def save_checkpoint(trainer: Algorithm[Any], path: Path) -> None:
    """Write a checkpoint through a temporary file. Raises `UserError` if it cannot be written."""
    notes = {
        "format": FORMAT,
        "identity": identity(trainer),
        "progress": dataclasses.asdict(trainer.progress),
        "random": trainer.random.bit_generator.state,
    }
    save_tensors(path, trainer.tensors(), (_NOTE, json.dumps(notes, sort_keys=True)))


def restore_checkpoint(trainer: Algorithm[Any], path: Path) -> None:
    """Bring a fresh trainer to where a checkpoint was written.

    Raises `UserError` if the file is not a checkpoint, one of another scenario, seed or
    hyperparameters, or holds what no training writes.
    """
    try:
        with safe_open(path, "pt") as file:
            found = json.loads((file.metadata() or {}).get(_NOTE, "{}"))
            if found.get("format") != FORMAT:
                raise UserError(
                    f"checkpoint {path}: format {found.get('format')!r}, expected {FORMAT!r}; "
                    "give another folder"
                )
            notes = check(_Notes, found, f"checkpoint {path}", remedy=REMEDY)
            if notes.identity != json.loads(json.dumps(identity(trainer))):
                raise UserError(
                    f"checkpoint {path}: of another training than {path.parent} is for; remove it "
                    "or give another folder"
                )
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (OSError, ValueError, RecursionError, AttributeError, SafetensorError) as error:
        raise UserError(f"checkpoint {path}: cannot be read ({error}); {REMEDY}") from error
    try:
        for name, tensor in tensors.items():
            if tensor.is_floating_point() and not tensor.isfinite().all():
                raise ValueError(f"{name} is not finite")
        trainer.restore(tensors)
        trainer.random = np.random.Generator(np.random.PCG64())
        trainer.random.bit_generator.state = notes.random
    except (LookupError, ValueError, TypeError, RuntimeError, OverflowError) as error:
        words = " ".join(str(error).split())
        raise UserError(
            f"checkpoint {path}: is damaged, or of another training ({words}); {REMEDY}"
        ) from error
    trainer.progress = notes.progress
