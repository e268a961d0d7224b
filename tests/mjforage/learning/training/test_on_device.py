"""Rounds whose decisions are on a device, where their observations stay."""

from typing import Any
from unittest.mock import patch

import pytest
import torch

from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.device_core import DeviceCore
from mjforage.learning.training import tasks
from mjforage.learning.training.algorithms import find_algorithm
from mjforage.learning.training.hyperparameters import changed
from mjforage.learning.training.replay_memory import ReplayMemory
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

SETTINGS: dict[str, dict[str, Any]] = {
    "ddqn": {"warmup": 8, "batch": 4, "capacity": 1000, "teacher": "greedy", "teacher_updates": 6},
    "mappo": {"epochs": 1, "batch": 8},
}
COMMON = {"world": "physics", "num_envs": 2, "evaluate_episodes": 2}


def scenario() -> Scenario:
    changes = "horizon=4", "period_s=3", "physics.device=warp-cpu"
    return load_scenario("comb-port-weather", list(changes))


def trained(name: str) -> tuple[Any, dict[str, torch.Tensor]]:
    """An algorithm after two rounds, and all that it goes on from."""
    made: Any = find_algorithm(name)
    trainer = made([scenario()], changed(made.settings(), {**COMMON, **SETTINGS[name]}), 1)
    for _ in range(2):
        trainer.play_round()
    return trainer, trainer.tensors()


@pytest.mark.parametrize("name", SETTINGS)
def test_training_on_a_device_is_training_on_the_host(name: str) -> None:
    """Bit for bit: weights, optimisers and replays, with and without a teacher."""
    if name == "mappo":
        pytest.importorskip("torchrl")
    found, there = trained(name)
    assert isinstance(found.round.cores[0], DeviceCore)
    with patch.object(tasks, "create_core", EnvironmentCore):
        known, here = trained(name)
    assert type(known.round.cores[0]) is EnvironmentCore
    assert found.progress.updates == known.progress.updates > 0
    assert there.keys() == here.keys()
    for key, wanted in here.items():
        assert torch.equal(there[key], wanted), key


def test_pictures_stay_where_the_memory_is() -> None:
    """Tensors go in and come out as tensors."""
    memory = ReplayMemory({"x": (2,)}, 1, 10, 1, 0.9)
    assert isinstance(memory.levels["x"], torch.Tensor)
    assert ReplayMemory({"x": (2,)}, 1, 10, 1, 0.9, "meta").levels["x"].is_meta
