"""Checkpoints of somebody else, or spoilt by a disk, are refused before anything reads them."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest
import torch
from safetensors import safe_open
from safetensors.torch import save_file

from mjforage.base.errors import UserError
from mjforage.learning.training.run import train
from mjforage.learning.training.trainer import Trainer
from tests.mjforage.learning.training.tiny_runs import hyperparameters, scenario

Tensors = dict[str, torch.Tensor]
Notes = dict[str, Any]
MEMORY = "scout.memory"


def spoilt(folder: Path, change: Callable[[Tensors, Notes], None]) -> None:
    path = folder / "checkpoint.safetensors"
    with safe_open(path, "pt") as file:
        notes = json.loads(file.metadata()["mjforage"])
        tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    change(tensors, notes)
    save_file(tensors, path, metadata={"mjforage": json.dumps(notes)})


def put(name: str, value: torch.Tensor) -> Callable[[Tensors, Notes], None]:
    return lambda tensors, notes: tensors.update({name: value})


def drop(name: str) -> Callable[[Tensors, Notes], None]:
    def change(tensors: Tensors, notes: Notes) -> None:
        del tensors[name]

    return change


def note(*keys: str, value: object) -> Callable[[Tensors, Notes], None]:
    def change(tensors: Tensors, notes: Notes) -> None:
        for key in keys[:-1]:
            notes = notes[key]
        notes[keys[-1]] = value

    return change


def priority(value: float) -> Callable[[Tensors, Notes], None]:
    def change(tensors: Tensors, notes: Notes) -> None:
        tensors[f"{MEMORY}.priorities"].fill_(value)

    return change


def flat(tensors: Tensors, notes: Notes) -> None:
    name = next(name for name in tensors if name.endswith("exp_avg"))
    tensors[name] = tensors[name].reshape(-1)[:1].clone()


LONG = torch.full((200_000,), 1e300, dtype=torch.float64)
FOREIGN: dict[str, tuple[Callable[[Tensors, Notes], None], str]] = {
    "beyond the replay": (put(f"{MEMORY}.priorities", LONG), "priorities of a replay is float64"),
    "negative": (priority(-1.0), "priorities of a replay are below 0"),
    "not finite": (priority(float("nan")), r"priorities is not finite"),
    "counters": (
        put(f"{MEMORY}.counters", torch.tensor([1e9, -1e12, 1.0], dtype=torch.float64)),
        "counters of a replay are",
    ),
    "no counters": (drop(f"{MEMORY}.counters"), "counters of a replay are three numbers"),
    "more": (put(f"{MEMORY}.blocks", torch.ones(1)), "a replay of other arrays"),
    "moment": (put("scout.optimiser.x.y", torch.ones(1)), "invalid literal for int"),
    "moment of nothing": (put("scout.optimiser.999.step", torch.tensor(1.0)), "out of range"),
    "flat moment": (flat, "are not of its shape"),
    "generator": (note("random", "bit_generator", value="MT19937"), "PCG64"),
    "rounds": (note("progress", "rounds", value=-5), "progress.rounds = -5"),
    "seconds": (note("progress", "seconds", value=-1e300), "progress.seconds"),
}


@pytest.mark.parametrize("case", FOREIGN)
def test_what_no_training_writes_is_refused(
    case: str, finished: tuple[Path, Trainer], tmp_path: Path
) -> None:
    change, words = FOREIGN[case]
    copy = tmp_path / "copy"
    shutil.copytree(finished[0], copy)
    spoilt(copy, change)
    with pytest.raises(UserError, match=rf"checkpoint .*{words}.*remove it or give another folder"):
        train(scenario(), hyperparameters(), copy, seed=3, updates=80)


@pytest.mark.parametrize("rounds", [None, ["one"]])
def test_a_log_without_rounds_is_refused(
    rounds: list[str] | None, finished: tuple[Path, Trainer], tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(finished[0], copy)
    frame = pl.read_parquet(copy / "training.parquet")
    frame = frame.drop("rounds") if rounds is None else frame.with_columns(rounds=pl.lit(rounds[0]))
    frame.write_parquet(copy / "training.parquet")
    with pytest.raises(UserError, match=r"training.parquet: is no log of a training; move it away"):
        train(scenario(), hyperparameters(), copy, seed=3, updates=80)
