"""Checkpoints: one safetensors file with all that later rounds depend on.

Tensors are networks, optimisers and replays; counters, settings, scenario and the state of the
random generator are JSON in the file's header, so a checkpoint is whole or absent.
"""

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from mjforage.errors import UserError
from mjforage.learning.training import Progress, Trainer
from mjforage.scenario_file import scenario_to_tree
from mjforage.storage import writing

FORMAT = "mjforage training checkpoint 1"


def identity(trainer: Trainer) -> dict[str, Any]:
    """What two runs must share for one to go on where the other stopped."""
    first, *others = (game.setting.scenario for game in trainer.games)
    return {
        "scenario": scenario_to_tree(first),
        "also": [scenario_to_tree(scenario) for scenario in others],
        "settings": trainer.settings.tree(),
        "seed": trainer.seed,
    }


def save_checkpoint(trainer: Trainer, path: Path) -> None:
    """Write a checkpoint through a temporary file.

    Raises
    ------
    UserError
        If it cannot be written.
    """
    tensors = {
        f"{team}.{name}": value
        for team, learner in trainer.learners.items()
        for name, value in learner.tensors().items()
    }
    notes = {
        "format": FORMAT,
        "identity": json.dumps(identity(trainer)),
        "progress": json.dumps(dataclasses.asdict(trainer.progress)),
        "random": json.dumps(trainer.random.bit_generator.state),
    }
    beside = path.with_suffix(".part")
    with writing(path):
        save_file(tensors, beside, metadata=notes)
        beside.chmod(0o644)  # safetensors leaves it to the owner alone
        beside.replace(path)


def restore_checkpoint(trainer: Trainer, path: Path) -> None:
    """Bring a fresh trainer to where a checkpoint was written.

    Raises
    ------
    UserError
        If the file is not a checkpoint, or one of another scenario, seed or settings.
    """
    try:
        with safe_open(path, "pt") as file:
            notes = file.metadata() or {}
            if notes.get("format") != FORMAT:
                raise UserError(
                    f"checkpoint {path}: format {notes.get('format')!r}, expected {FORMAT!r}; "
                    "give another --out"
                )
            _check(json.loads(notes["identity"]), identity(trainer), path)
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (OSError, SafetensorError) as error:
        raise UserError(
            f"checkpoint {path}: cannot be read ({error}); remove it or give another --out"
        ) from error
    for team, learner in trainer.learners.items():
        start = f"{team}."
        own = {n.removeprefix(start): v for n, v in tensors.items() if n.startswith(start)}
        learner.restore(own)
    trainer.progress = Progress(**json.loads(notes["progress"]))
    trainer.random = np.random.Generator(np.random.PCG64())
    trainer.random.bit_generator.state = json.loads(notes["random"])


def _check(found: dict[str, Any], wanted: dict[str, Any], path: Path) -> None:
    wanted = json.loads(json.dumps(wanted))
    for part in ("seed", "settings", "scenario", "also"):
        if found[part] != wanted[part]:
            keys = (
                [k for k in wanted[part] if found[part].get(k) != wanted[part][k]]
                if isinstance(wanted[part], dict)
                else []
            )
            where = f"{part} {keys[0]}" if keys else part
            old = found[part].get(keys[0]) if keys else found[part]
            raise UserError(
                f"checkpoint {path}: was written with another {where} ({old!r:.80}); use the same "
                "command to go on, or another --out to begin anew"
            )
