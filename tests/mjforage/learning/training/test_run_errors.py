"""Errors of trainings: named in a sentence, and nothing is lost."""

import shutil
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.networks.q_network import DuelingNetwork
from mjforage.graph_planner.networks.weights import ACTOR
from mjforage.learning.training.algorithm import Algorithm, save_weights
from mjforage.learning.training.algorithm_validation import check_parts
from mjforage.learning.training.algorithms import find_algorithm
from mjforage.learning.training.checkpoint import save_checkpoint
from mjforage.learning.training.run import train, train_with
from mjforage.learning.training.trainer import Trainer
from mjforage.runs.lock import folder_lock
from tests.mjforage.learning.training.tiny_runs import hyperparameters, scenario


def test_ends_and_folders_are_checked(finished: tuple[Path, Trainer], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no end given; give hours or updates, such as hours = 2"):
        train(scenario(), hyperparameters(), tmp_path)
    copy = tmp_path / "copy"
    shutil.copytree(finished[0], copy)
    (copy / "evaluations.parquet").write_bytes(b"none")
    with pytest.raises(UserError, match=r"evaluations.parquet: missing, truncated or not Parquet"):
        train(scenario(), hyperparameters(), copy, seed=3, updates=1)
    shutil.copy(copy / "weights.safetensors", copy / "checkpoint.safetensors")
    with pytest.raises(UserError, match="format 'mjforage dueling q-network 1', expected"):
        train(scenario(), hyperparameters(), copy, seed=3, updates=1)
    (copy / "checkpoint.safetensors").write_bytes(b"none")
    with pytest.raises(UserError, match="cannot be read"):
        train(scenario(), hyperparameters(), copy, seed=3, updates=1)
    with pytest.raises(UserError, match="device tpu: choose auto, cpu or cuda"):
        train(scenario(), hyperparameters(), tmp_path, updates=1, device="tpu")
    with folder_lock(copy), pytest.raises(UserError, match="another process is writing this run"):
        train(scenario(), hyperparameters(), copy, seed=3, updates=1)


def test_a_folder_is_its_trainings_from_the_start(tmp_path: Path) -> None:
    """Before the first checkpoint, and beside what something else has written."""
    with pytest.MonkeyPatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Trainer, "play_round", Mock(side_effect=KeyboardInterrupt))
        train(scenario(), hyperparameters(), tmp_path / "run", seed=3, updates=1)
    with pytest.raises(UserError, match="holds another training: seed is 3 there and 4 here"):
        train(scenario(), hyperparameters(), tmp_path / "run", seed=4, updates=1)
    other = tmp_path / "other"
    other.mkdir()
    (other / "run.json").write_text("{}")
    with pytest.raises(UserError, match=r"holds run.json but no training.json"):
        train(scenario(), hyperparameters(), other, updates=1)
    assert [path.name for path in other.iterdir()] == ["run.json"]


def test_files_that_cannot_be_written_are_named(
    finished: tuple[Path, Trainer], tmp_path: Path
) -> None:
    for save in (save_weights, save_checkpoint):
        with pytest.raises(UserError, match=r"none/w.safetensors: cannot be written"):
            save(finished[1], tmp_path / "none" / "w.safetensors")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"batchsize": 3}, "unknown key batchsize; did you mean batch"),
        ({"batch": 1.5}, "batch = 1.5 should be a valid integer"),
        ({"gamma": 2}, "learning settings: gamma = 2 should be "),
        ({"reward.removd": 2.0}, "reward removd: unknown; did you mean removed"),
        ({"warmup": 1001}, "warmup = 1001: the replay holds only capacity = 1000"),
        ({"updates_per_step": 0}, "updates_per_step = 0 should be "),
        ({"gamma": float("nan")}, "gamma = nan should be "),
        ({"teacher": "belief"}, "teacher = 'belief', teacher_updates = 0: give both"),
        ({"teacher_updates": 9}, "teacher = '', teacher_updates = 9: give both"),
    ],
)
def test_settings_are_checked(changes: dict[str, object], words: str) -> None:
    with pytest.raises(UserError, match=words):
        hyperparameters(**changes)


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ({"hours": float("nan")}, "train: hours nan: give a positive number"),
        ({"hours": float("inf")}, "train: hours inf: give a positive number"),
        ({"hours": -1.0}, "train: hours -1.0: give a positive number"),
        ({"updates": 0}, "train: updates 0: give a positive number"),
        ({"updates": 1, "hours": 0.0}, "train: hours 0.0: give a positive number"),
        ({"updates": 1, "seed": -1}, "seed -1: out of range; give 0 to 1099511627775"),
        ({"updates": 1, "seed": 1 << 64}, "seed 18446744073709551616: out of range"),
    ],
)
def test_ends_and_seeds_are_checked_before_a_folder_is_made(
    end: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=words):
        train(scenario(), hyperparameters(), tmp_path / "run", **end)
    assert not (tmp_path / "run").exists()


class Unwritten(Trainer):
    """An algorithm that nobody has finished."""

    play_round = Algorithm.play_round
    tensors = Algorithm.tensors


def test_an_algorithm_that_lacks_something_is_refused_at_the_start() -> None:
    with pytest.raises(UserError, match="has no play_round, tensors; write it"):
        find_algorithm(f"{__name__}:Unwritten")


class Unplayable(Trainer):
    """An algorithm whose weights no policy reads."""

    weights_kind = "actor-critic"


def test_an_algorithm_whose_weights_nobody_plays_is_refused_at_the_start() -> None:
    with pytest.raises(UserError, match="weights_kind 'actor-critic': no policy plays it; give"):
        find_algorithm(f"{__name__}:Unplayable")


class Telling(Trainer):
    """Its rounds are counted, and then tell something else."""

    def play_round(self) -> Any:
        return super().play_round() | {"note": "hello"}


def test_a_row_is_checked(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="Telling: play_round gave note = 'hello'; a row has numb"):
        train_with(Telling, scenario(), hyperparameters(), tmp_path, updates=1)


class Listed(Trainer):
    """Has a list of networks."""

    @property
    def networks(self) -> Any:
        return [learner.average for learner in self.learners.values()]


def test_parts_that_no_run_can_use_are_refused_before_a_folder_is_made(tmp_path: Path) -> None:
    with pytest.raises(
        UserError, match=r"Listed: networks and tensors\(\) are list and dict; make"
    ):
        train_with(Listed, scenario(), hyperparameters(), tmp_path / "run", updates=1)
    assert not (tmp_path / "run").exists()


class Wider(DuelingNetwork):
    """A network of a user."""


class OwnNetwork(Trainer):
    """Has networks of a class that no policy makes."""

    @property
    def networks(self) -> Any:
        return {team: Wider(self.shapes) for team in super().networks}


class OfAnotherKind(Trainer):
    """Says of its networks what they are not."""

    weights_kind = ACTOR


def test_networks_whose_weights_no_policy_plays_are_told_of_before_they_train(
    caplog: pytest.LogCaptureFixture,
) -> None:
    check_parts(Trainer([scenario()], hyperparameters()))
    assert caplog.text == ""
    check_parts(OwnNetwork([scenario()], hyperparameters()))
    words = "OwnNetwork: its networks are of Wider; they train, but by weights_kind 'mjforage duel"
    assert words in caplog.text and caplog.text.count("OwnNetwork") == 1
    assert caplog.text.rstrip().endswith("of their file: play them by a ModelPolicy")
    caplog.clear()
    check_parts(OfAnotherKind([scenario()], hyperparameters()))
    assert caplog.text.rstrip().endswith("give weights_kind = 'mjforage dueling q-network 1'")
