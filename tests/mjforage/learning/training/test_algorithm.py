"""Episodes and logs of all algorithms."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mjforage.learning.training.algorithm import Algorithm
from mjforage.learning.training.checkpoint import restore_checkpoint, save_checkpoint
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
from mjforage.learning.training.mappo.trainer import MappoTrainer
from mjforage.learning.training.trainer import Trainer
from tests.mjforage.learning.training.chain import SETTINGS, channel


def made(kind: type[Algorithm[Any]], folder: Path, seed: int = 3) -> Algorithm[Any]:
    settings: Any = Hyperparameters() if kind is Trainer else MappoHyperparameters()
    return kind([channel(folder)], changed(settings, SETTINGS), seed=seed)


def keys(trainer: Algorithm[Any]) -> list[int]:
    """Of the episodes of the next round, which is played."""
    trainer.play_round()
    found = np.zeros(2, np.uint64)
    for core, envs in zip(trainer.round.cores, trainer.round.envs, strict=True):
        found[envs] = core.mission.keys
    return [int(key) for key in found]


@pytest.mark.parametrize("kind", [Trainer, MappoTrainer])
def test_no_two_rounds_play_the_same_episodes(kind: type[Algorithm[Any]], tmp_path: Path) -> None:
    """Nor do they after the run was stopped, nor do seeds share any."""
    first, whole = made(kind, tmp_path), made(kind, tmp_path)
    before = [keys(first) for _ in range(3)]
    save_checkpoint(first, tmp_path / "checkpoint")
    second = made(kind, tmp_path)
    restore_checkpoint(second, tmp_path / "checkpoint")
    played = before + [keys(second) for _ in range(3)]
    assert played == [keys(whole) for _ in range(6)]
    other = [keys(made(kind, tmp_path, seed=4))]
    assert np.unique(played + other).size == 2 * 7


@pytest.mark.parametrize("kind", [Trainer, MappoTrainer])
def test_a_row_counts_decisions_up_to_the_end_and_what_they_cost(
    kind: type[Algorithm[Any]], tmp_path: Path
) -> None:
    """Agents without energy decide nothing more, and pay nothing, until the others are done."""
    trainer, decisions, lengths = made(kind, tmp_path), 0, set()
    for _ in range(8):
        row = trainer.play_round()
        steps = np.zeros(2, np.int64)
        for core, envs in zip(trainer.round.cores, trainer.round.envs, strict=True):
            steps[envs] = 2 if core.setup.fleet.energy[0] == 2.0 else 6
        decisions += steps.sum()
        lengths.add(row["length"])
        assert row["length"] == steps.mean() and trainer.progress.decisions == decisions
        (cost,) = (-value for name, value in row.items() if name.startswith("reward/"))
        assert 3.0 * steps.mean() <= cost <= 6.0 * steps.mean()  # of both agents, an episode
        assert row["return_forager"] == pytest.approx(-cost / 2)
    assert lengths >= {4.0, 6.0}, "also of one that ends beside one that lasts"
