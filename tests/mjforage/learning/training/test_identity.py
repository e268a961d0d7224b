"""Identity of a training: whatever decides its weights, changed alone, is refused on resuming."""

import copy
import inspect
import json
import shutil
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from mjforage.base.errors import UserError
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training import run
from mjforage.learning.training.algorithms import ALGORITHMS, find_algorithm
from mjforage.learning.training.checkpoint import identity, restore_checkpoint
from mjforage.learning.training.run import IDENTITY, train_with
from mjforage.learning.training.tasks import TrainingTask
from mjforage.learning.training.trainer import Trainer
from mjforage.learning.training.training_info import TrainingInfo
from mjforage.runs.resuming import differences
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario
from tests.mjforage.changing import assert_refused, changes, leaves, with_other
from tests.mjforage.learning.training.tiny_runs import hyperparameters, scenario

FREE = {
    "command": "names flags such as --updates, which say where it stops",
    "instructions": "of the processor on which it began, to be read",
    "versions.mjforage": "its code counts",
    "versions.python": "computes no number",
}
"""Facts of `training.json` in which a training may differ, and why."""
Finished = tuple[Path, Trainer]


class Other(Trainer):
    """Another algorithm that plays the same."""


def facts_of(trainer: Trainer, **changed: Any) -> dict[str, Any]:
    """Content of `training.json` of one like it but for some attributes."""
    like = copy.copy(trainer)
    vars(like).update(changed)
    found: dict[str, Any] = json.loads(json.dumps(run._facts(like)))
    return found


def test_whatever_training_json_says_decides_or_is_free_for_a_reason(finished: Finished) -> None:
    there = json.loads((finished[0] / "training.json").read_text())
    settings = facts_of(finished[1])
    assert settings.keys() == there.keys() and not differences(there, settings, IDENTITY)
    named = {field.name for field in fields(TrainingInfo)} | {"code"}
    assert named == {*IDENTITY, *(name.partition(".")[0] for name in FREE)}
    for path in leaves(there):
        name = ".".join(map(str, path))
        changed = with_other(there, path)
        assert (not differences(there, changed, IDENTITY)) == (name in FREE), name


@pytest.mark.parametrize("name", ALGORITHMS.ours())
def test_every_setting_is_of_the_training(name: str, finished: Finished) -> None:
    """Of its file and of its checkpoint."""
    settings = find_algorithm(name).settings
    folder = finished[0]
    trainer: Any = copy.copy(finished[1])
    trainer.hyperparameters = hyperparameters() if name == "ddqn" else settings()
    there, names = identity(trainer), set()
    for field, changed in changes(trainer.hyperparameters):
        trainer.hyperparameters = changed
        assert differences(there, identity(trainer), IDENTITY), field
        with pytest.raises(UserError, match="of another training"):
            restore_checkpoint(trainer, folder / "checkpoint.safetensors")
        names.add(field)
    assert names == {field.name for field in fields(settings)} and len(names) > 20


def test_every_argument_of_train_is_of_the_training_or_free(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(finished[0], folder)
    longer = load_scenario("published", ("horizon=13",))
    asked = {
        "algorithm": Other,
        "scenario": longer,
        "hyperparameters": hyperparameters(batch=8),
        "also": [longer],
        "evaluate": [longer],
        "seed": 5,
        "device": "cpu",
    }
    free = {
        "folder": "where it is",
        "hours": "where it stops",
        "updates": "where it stops",
        "report": "receives rows",
        "resume": "what to do with another training",
    }
    assert asked.keys() | free.keys() == inspect.signature(train_with).parameters.keys()
    settings: dict[str, Any] = {
        "algorithm": Trainer,
        "scenario": scenario(),
        "seed": 3,
        "updates": 99,
    }
    settings |= {"hyperparameters": hyperparameters(), "folder": folder}
    for name, value in asked.items():
        if name == "device":
            monkeypatch.setattr(run, "_device", lambda name: "meta")  # whose tensors hold nothing
            monkeypatch.setattr(run, "check_parts", lambda trainer: None)
        assert_refused(folder, partial(train_with, **settings | {name: value}), name)


def placed_on(file: Path) -> Scenario:
    """A scenario on a map of a file, with the starts beside it."""
    home = scenario()
    return replace(home, map=replace(home.map, file=str(file), starts=None))


def test_cells_and_starts_of_maps_are_of_the_training(finished: Finished, tmp_path: Path) -> None:
    """Whatever their names say; those of evaluations too."""
    file, starts = tmp_path / "bay.csv", tmp_path / "bay.starts.csv"
    facts = []
    for cell, start in (("1", "0,0"), ("0", "0,0"), ("1", "1,1")):
        file.write_text("\n".join([*["1,1,1,1,1,1"] * 5, f"1,1,1,1,1,{cell}"]) + "\n")
        starts.write_text(f"{start}\n0,2\n2,0\n3,3\n")
        task = TrainingTask(EnvironmentOptions(placed_on(file)), 3, {})
        judged = copy.copy(finished[1])
        judged.evaluate_on([placed_on(file)])
        facts += [
            facts_of(finished[1], tasks=[task]),
            facts_of(finished[1], tasks=[*finished[1].tasks, task]),
            facts_of(judged),
        ]
    for place in range(3):
        first, *others = facts[place::3]
        for other in others:
            assert [one.key for one in differences(first, other, IDENTITY)] == ["maps"]


def test_what_is_in_files_of_weights_is_of_the_training(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of those that the networks begin with, and of a teacher's."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "w.safetensors"
    weights = (finished[0] / "weights.safetensors").read_bytes()
    other = weights[:-1] + bytes([weights[-1] ^ 1])
    every: list[dict[str, Any]] = [{"initial": file.name}, {"teacher": "w", "teacher_updates": 5}]
    for asked in every:
        facts = []
        for content in (weights, other):
            file.write_bytes(content)
            settings = replace(finished[1].hyperparameters, **asked)
            facts.append(facts_of(finished[1], hyperparameters=settings))
        found = differences(facts[0], facts[1], IDENTITY)
        assert [one.key for one in found] == ["weights"], asked
