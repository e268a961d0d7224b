"""Whole training runs, tiny ones: determinism, resuming, what they leave behind, errors."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import torch
from safetensors import safe_open

from graph_planner.policies.ddqn import QPolicy
from mjforage.errors import UserError
from mjforage.learning.run import train
from mjforage.learning.settings import Settings, changed
from mjforage.learning.training import Trainer
from mjforage.mission import Mission, Setting
from mjforage.scenario import Scenario
from mjforage.scenario_file import load_scenario
from mjforage.storage import claimed

TINY = {
    "lanes": 3,
    "capacity": 1000,
    "batch": 16,
    "warmup": 40,
    "explore_updates": 20,
    "evaluate_every": 15,
    "evaluate_episodes": 2,
}


def scenario() -> Scenario:
    return load_scenario("published", ("horizon=12",))


def settings(**changes: object) -> Settings:
    return changed(Settings(), TINY | changes)


def state(trainer: Trainer) -> dict[str, torch.Tensor]:
    return {
        f"{team}.{name}": value
        for team, learner in trainer.learners.items()
        for name, value in learner.tensors().items()
    }


def assert_same(one: Trainer, other: Trainer) -> None:
    first, second = state(one), state(other)
    assert first.keys() == second.keys()
    for name, value in first.items():
        assert torch.equal(value, second[name]), name
    assert one.random.bit_generator.state == other.random.bit_generator.state
    assert one.progress.updates == other.progress.updates > 0


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Trainer]:
    folder = tmp_path_factory.mktemp("train") / "run"
    return folder, train(scenario(), settings(), folder, seed=3, updates=40)


def test_one_seed_gives_the_same_weights(finished: tuple[Path, Trainer], tmp_path: Path) -> None:
    again = train(scenario(), settings(), tmp_path / "again", seed=3, updates=40)
    assert_same(finished[1], again)
    other = train(scenario(), settings(), tmp_path / "other", seed=4, updates=15)
    assert not torch.equal(
        state(other)["scout.online.trunk.0.bias"], state(again)["scout.online.trunk.0.bias"]
    )


def test_n_and_m_updates_are_n_stop_resume_m(
    finished: tuple[Path, Trainer], tmp_path: Path
) -> None:
    folder = tmp_path / "run"
    train(scenario(), settings(), folder, seed=3, updates=20)
    resumed = train(scenario(), settings(), folder, seed=3, updates=40)
    assert_same(finished[1], resumed)
    for name in ("training", "evaluations"):
        whole, parts = (pl.read_parquet(f / f"{name}.parquet") for f in (finished[0], folder))
        known = [c for c in whole.columns if c != "seconds"]
        if name == "training":
            assert whole.select(known).equals(parts.select(known), null_equal=True)
        assert parts["updates"].is_sorted()


def test_a_killed_run_goes_on_from_its_checkpoint(
    finished: tuple[Path, Trainer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjforage.learning.run.CHECKPOINT_S", 0.0)
    original, rounds = Trainer.play_round, [0]

    def dying(trainer: Trainer) -> dict[str, float]:
        rounds[0] += 1
        if rounds[0] == 4:
            raise KeyboardInterrupt
        return original(trainer)

    folder = tmp_path / "run"
    with monkeypatch.context() as patch:
        patch.setattr(Trainer, "play_round", dying)
        with pytest.raises(KeyboardInterrupt):
            train(scenario(), settings(), folder, seed=3, updates=40)
    assert_same(finished[1], train(scenario(), settings(), folder, seed=3, updates=40))


def test_what_a_run_leaves_behind(finished: tuple[Path, Trainer]) -> None:
    folder, trainer = finished
    names = {path.name for path in folder.iterdir()}
    assert names == {
        *("train.json", "training.parquet", "evaluations.parquet", "tensorboard"),
        *("checkpoint.safetensors", "weights.safetensors", "best.safetensors"),
    }
    facts = json.loads((folder / "train.json").read_text())
    assert facts["seed"] == 3 and facts["settings"]["lanes"] == 3
    rows = pl.read_parquet(folder / "training.parquet")
    assert rows.height == trainer.progress.rounds
    assert {"return_scout", "return_forager", "loss", "pta_c", "seconds"} <= set(rows.columns)
    assert any((folder / "tensorboard").iterdir())
    with safe_open(folder / "checkpoint.safetensors", "pt") as file:
        assert json.loads(file.metadata()["progress"])["updates"] == trainer.progress.updates
    policy = QPolicy(folder / "weights.safetensors")
    mission = Mission(Setting.of(scenario()))
    mission.reset(0, np.arange(2))
    mission.run(policy)
    assert not mission.active.any()


def test_trained_weights_are_a_policy_by_their_file_name(
    finished: tuple[Path, Trainer],
    command: Callable[..., object],
    refused: Callable[..., str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("evaluate", "published", "--set", "horizon=8", "--episodes", 2, "--out", "run")
    assert "policy mine: unknown; choose belief" in refused(*words, "--policy", "mine")
    shutil.copy(finished[0] / "weights.safetensors", "mine.safetensors")
    done = command(*words, "--policy", "mine")
    assert done.code == 0, done  # type: ignore[attr-defined]
    Path("bad.safetensors").write_bytes(b"none")
    assert "weights" in refused(*words, "--policy", "bad")


def test_a_teacher_is_followed(tmp_path: Path) -> None:
    """Shown moves are stored for every decision, and its lanes play them."""
    trainer = Trainer([scenario()], settings(teacher="greedy", teacher_updates=1000), seed=0)
    trainer.play_round()
    for learner in trainer.learners.values():
        replay = learner.replay
        rows = replay.tree[replay.tree.size // 2 :][: replay.kind.size] > 0
        shown, moves = replay.shown[: replay.kind.size][rows], replay.moves[rows].astype(np.int64)
        assert shown.any(axis=1).all()
        same = np.take_along_axis(shown, moves[:, None], axis=1)
        assert same.mean() > 0.8  # the first lanes are all the teacher's


def test_rounds_take_scenarios_in_turn(tmp_path: Path) -> None:
    other = load_scenario("open-bay", ("horizon=12",))
    trainer = Trainer([scenario(), other], settings(), seed=0)
    nodes = set()
    for _ in range(2):
        trainer.play_round()
        nodes.add(len(trainer.game.setting.graph))
    assert nodes == {len(game.setting.graph) for game in trainer.games} and len(nodes) == 2
    train(scenario(), settings(), tmp_path, also=[other], updates=1)
    with pytest.raises(UserError, match="was written with another also"):
        train(scenario(), settings(), tmp_path, updates=1)
    with pytest.raises(UserError, match="scenarios published and comb-port: fleets or arrays"):
        Trainer([scenario(), load_scenario("comb-port", ("team.scouts.count=1",))], settings())


def test_ends_and_folders_are_checked(finished: tuple[Path, Trainer], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no end given; add --hours 2 or --updates 10000"):
        train(scenario(), settings(), tmp_path)
    copy = tmp_path / "copy"
    shutil.copytree(finished[0], copy)
    with pytest.raises(UserError, match="was written with another seed"):
        train(scenario(), settings(), copy, seed=5, updates=1)
    with pytest.raises(UserError, match="was written with another settings batch"):
        train(scenario(), settings(batch=8), copy, seed=3, updates=1)
    with pytest.raises(UserError, match="another scenario horizon"):
        train(load_scenario("published", ("horizon=13",)), settings(), copy, seed=3, updates=1)
    shutil.copy(copy / "weights.safetensors", copy / "checkpoint.safetensors")
    with pytest.raises(UserError, match="format 'mjforage dueling q-network 1', expected"):
        train(scenario(), settings(), copy, seed=3, updates=1)
    (copy / "checkpoint.safetensors").write_bytes(b"none")
    with pytest.raises(UserError, match="cannot be read"):
        train(scenario(), settings(), copy, seed=3, updates=1)
    with pytest.raises(UserError, match="--device tpu: choose auto, cpu or cuda"):
        train(scenario(), settings(), tmp_path, updates=1, device="tpu")
    with claimed(copy), pytest.raises(UserError, match="another process is writing this run"):
        train(scenario(), settings(), copy, seed=3, updates=1)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"batchsize": 3}, "batchsize: unknown setting"),
        ({"batch": 1.5}, "batch = 1.5: expected int"),
        ({"gamma": 2}, "gamma = 2.0: out of range; give 0 to 1"),
        ({"reward.removd": 2.0}, "reward removd: unknown term; did you mean removed"),
        ({"warmup": 1001}, "warmup = 1001: the replay holds only capacity = 1000"),
        ({"updates_per_step": 0}, "updates_per_step = 0.0: out of range"),
        ({"gamma": float("nan")}, "gamma = nan: out of range"),
        ({"teacher": "belief"}, "teacher = 'belief', teacher_updates = 0: give both"),
        ({"teacher_updates": 9}, "teacher = '', teacher_updates = 9: give both"),
    ],
)
def test_settings_are_checked(changes: dict[str, object], words: str) -> None:
    with pytest.raises(UserError, match=words):
        settings(**changes)


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ({"hours": float("nan")}, "--hours nan: give a positive number"),
        ({"hours": float("inf")}, "--hours inf: give a positive number"),
        ({"hours": -1.0}, "--hours -1.0: give a positive number"),
        ({"updates": 0}, "--updates 0: give a positive number"),
        ({"updates": 1, "hours": 0.0}, "--hours 0.0: give a positive number"),
        ({"updates": 1, "seed": -1}, "seed -1: out of range; give 0 to 1099511627775"),
        ({"updates": 1, "seed": 1 << 64}, "seed 18446744073709551616: out of range"),
    ],
)
def test_ends_and_seeds_are_checked_before_a_folder_is_made(
    end: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=words):
        train(scenario(), settings(), tmp_path / "run", **end)
    assert not (tmp_path / "run").exists()


def test_a_full_replay_ends_the_warm_up() -> None:
    """A replay has room for rows that no update can draw, so it may never hold `warmup`."""
    trainer = Trainer([scenario()], settings(warmup=1000), seed=0)
    while not trainer.progress.updates and trainer.progress.rounds < 60:
        trainer.play_round()
    assert trainer.progress.updates > 0


def test_the_command_line_trains(command: Callable[..., object], tmp_path: Path) -> None:
    words = [f"--learning={key}={value}" for key, value in TINY.items()]
    out = tmp_path / "run"
    also = ("--also", "published:open_bay", "--also", "channels")
    first = ("train", "ddqn", "--set", "horizon=6", "--updates", 1, "--out", out, *also)
    done = command(*first, *words)
    assert done.code == 0, done  # type: ignore[attr-defined]
    assert "PTA_C" in done.out  # type: ignore[attr-defined]
    assert (out / "best.safetensors").is_file()


def test_the_command_line_names_what_is_wrong(refused: Callable[..., str], tmp_path: Path) -> None:
    assert "no end given" in refused("train", "ddqn", "--out", tmp_path)
    taught = ("--teacher", "foo", "--learning", "teacher_updates=9", "--updates", 1)
    words = refused("train", "ddqn", *taught, "--out", tmp_path / "run")
    assert "policy foo: unknown" in words
    assert not (tmp_path / "run").exists()
    assert "expected KEY=VALUE" in refused(
        "train", "ddqn", "--learning", "lanes", "--out", tmp_path
    )
