"""Fixtures of whole trainings; torch is loaded by those who ask for it."""

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from mjforage.learning.training.trainer import Trainer


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> "tuple[Path, Trainer]":
    """A run that is over, in its folder; neither is to be changed."""
    from mjforage.learning.training.run import train
    from tests.mjforage.learning.training.tiny_runs import hyperparameters, scenario

    folder = tmp_path_factory.mktemp("train") / "run"
    return folder, train(scenario(), hyperparameters(), folder, seed=3, updates=40)
