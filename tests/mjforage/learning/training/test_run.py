"""Whole training runs, tiny ones: determinism, resuming, what they play and leave behind."""

import json
import shutil
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import polars as pl
import pytest
import torch
from safetensors import safe_open

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies.ddqn import QPolicy
from mjforage.learning.training import run
from mjforage.learning.training.checkpoint import save_checkpoint
from mjforage.learning.training.evaluation import HELD_OUT
from mjforage.learning.training.hyperparameters import Hyperparameters
from mjforage.learning.training.progress import Row
from mjforage.learning.training.run import CHECKPOINT, train
from mjforage.learning.training.trainer import Trainer
from mjforage.learning.training.training_info import TrainingInfo
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.schema import check, json_schema
from tests.mjforage.learning.training.tiny_runs import TINY, hyperparameters, scenario


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


def test_no_evaluation_plays_what_was_trained_on() -> None:
    """`evaluate --seed 3` has other episodes than `train --seed 3`, and than its evaluations."""
    trainer = Trainer([scenario()], hyperparameters(), seed=3)
    trainer.start_round()
    trained = set(trainer.round.cores[0].mission.keys.tolist())
    for seed in (3, HELD_OUT):
        evaluated = set(episode_keys(seed, np.arange(64)).tolist())
        assert trained and not trained & evaluated


@pytest.mark.every_capability
def test_one_seed_gives_the_same_weights(finished: tuple[Path, Trainer], tmp_path: Path) -> None:
    again = train(scenario(), hyperparameters(), tmp_path / "again", seed=3, updates=40)
    assert_same(finished[1], again)
    for name in ("weights", "best"):
        first, second = (f / f"{name}.safetensors" for f in (finished[0], tmp_path / "again"))
        assert first.read_bytes() == second.read_bytes(), name
    for path in (tmp_path / "a", tmp_path / "b"):
        save_checkpoint(again, path)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    other = train(scenario(), hyperparameters(), tmp_path / "other", seed=4, updates=15)
    assert not torch.equal(
        state(other)["scout.online.trunk.0.bias"], state(again)["scout.online.trunk.0.bias"]
    )


@pytest.mark.every_capability
def test_n_and_m_updates_are_n_stop_resume_m(
    finished: tuple[Path, Trainer], tmp_path: Path
) -> None:
    folder = tmp_path / "run"
    train(scenario(), hyperparameters(), folder, seed=3, updates=20)
    resumed = train(scenario(), hyperparameters(), folder, seed=3, updates=40)
    assert_same(finished[1], resumed)
    for name in ("training", "evaluations"):
        whole, parts = (pl.read_parquet(f / f"{name}.parquet") for f in (finished[0], folder))
        whole, parts = whole.drop("seconds"), parts.drop("seconds")
        if name == "training":
            assert whole.equals(parts, null_equal=True)
        else:  # the end of the first part was evaluated, too
            assert whole.equals(parts.join(whole, on="rounds", how="semi"), null_equal=True)
            assert parts.height == whole.height + 1
        assert parts["rounds"].is_sorted()


@pytest.mark.parametrize(
    ("what", "call"),
    [("Trainer.play_round", 4), ("save_checkpoint", 3), ("save_weights", 4), ("Logs.write", 3)],
)
def test_a_killed_run_goes_on_from_its_checkpoint(
    finished: tuple[Path, Trainer],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    what: str,
    call: int,
) -> None:
    """Wherever it is killed: to the bit, and with every row of the tables once."""
    monkeypatch.setattr(run, "CHECKPOINT_S", 0.0)
    owner, _, name = what.rpartition(".")
    place = getattr(run, owner) if owner else run
    original, calls = getattr(place, name), [0]

    def dying(*arguments: Any) -> Any:
        calls[0] += 1
        if calls[0] == call:
            raise KeyboardInterrupt
        return original(*arguments)

    folder = tmp_path / "run"
    with monkeypatch.context() as patch:
        patch.setattr(place, name, dying)
        with pytest.raises(KeyboardInterrupt):
            train(scenario(), hyperparameters(), folder, seed=3, updates=40)
    assert_same(finished[1], train(scenario(), hyperparameters(), folder, seed=3, updates=40))
    for table in ("training", "evaluations"):
        whole, parts = (pl.read_parquet(f / f"{table}.parquet") for f in (finished[0], folder))
        assert whole.drop("seconds").equals(parts.drop("seconds"), null_equal=True)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_run_that_is_told_to_stop_keeps_its_round(
    finished: tuple[Path, Trainer],
    tmp_path: Path,
    number: signal.Signals,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """And goes on from there to the bit; afterwards signals are whose they were."""
    folder, rows, before = tmp_path / "run", [], signal.getsignal(number)

    def stop(table: str, row: Row) -> None:
        rows.append(row["updates"])
        signal.raise_signal(number)

    with pytest.raises(KeyboardInterrupt):
        train(scenario(), hyperparameters(), folder, seed=3, updates=40, report=stop)
    assert signal.getsignal(number) is before
    assert len(rows) == 1 and "stops at the end of this round and keeps it" in caplog.text
    assert pl.read_parquet(folder / "training.parquet")["updates"].to_list() == rows
    again: list[tuple[str, float]] = []

    def note(table: str, row: Row) -> None:
        again.append((table, row["rounds"]))

    gone_on = train(scenario(), hyperparameters(), folder, seed=3, updates=40, report=note)
    assert again[:2] == [(CHECKPOINT, 1.0), ("training", 2.0)]
    assert_same(finished[1], gone_on)


def test_a_run_that_is_told_so_twice_stops_at_once(tmp_path: Path) -> None:
    def stop(table: str, row: Row) -> None:
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        train(scenario(), hyperparameters(), tmp_path, seed=3, updates=40, report=stop)
    assert not (tmp_path / "checkpoint.safetensors").exists()


def test_what_a_run_leaves_behind(finished: tuple[Path, Trainer]) -> None:
    folder, trainer = finished
    names = {path.name for path in folder.iterdir()}
    assert names == {
        *("training.json", "training.parquet", "evaluations.parquet", "tensorboard"),
        *("checkpoint.safetensors", "weights.safetensors", "best.safetensors", ".lock"),
    }
    facts = json.loads((folder / "training.json").read_text())
    jsonschema.validate(facts, json_schema(TrainingInfo))
    found = check(TrainingInfo, facts, "").hyperparameters
    assert check(Hyperparameters, found, "") == trainer.hyperparameters
    assert facts["instructions"] == torch.backends.cpu.get_cpu_capability()
    assert facts["seed"] == 3 and facts["hyperparameters"]["num_envs"] == 3
    rows = pl.read_parquet(folder / "training.parquet")
    assert rows.height == trainer.progress.rounds
    assert {"return_scout", "return_forager", "loss", "pta_c", "seconds"} <= set(rows.columns)
    assert any((folder / "tensorboard").iterdir())
    with safe_open(folder / "checkpoint.safetensors", "pt") as file:
        assert (
            json.loads(file.metadata()["mjforage"])["progress"]["updates"]
            == trainer.progress.updates
        )
    policy = QPolicy(folder / "weights.safetensors")
    mission = Mission(Setup.of(scenario()))
    mission.reset(0, np.arange(2))
    mission.run(policy)
    assert not mission.active.any()


def test_the_best_weights_are_those_of_the_lowest_rank(tmp_path: Path) -> None:
    """They change when an evaluation is better than all before it, and at no other time."""
    ranks, kept = [], []

    def note(table: str, row: Row) -> None:
        if table == "evaluations":
            ranks.append(row["rank"])
            best = tmp_path / "best.safetensors"
            kept.append(best.read_bytes() if best.is_file() else b"")

    settings = hyperparameters(evaluate_every=1)
    train(scenario(), settings, tmp_path, seed=3, updates=60, report=note)
    kept.append((tmp_path / "best.safetensors").read_bytes())
    better = [i == 0 or rank < min(ranks[:i]) for i, rank in enumerate(ranks)]
    assert [kept[i] != kept[i + 1] for i in range(len(ranks))] == better
    assert 1 < sum(better) < len(better), "some are better, some are not"


def test_trained_weights_are_a_policy_by_their_file_name(
    finished: tuple[Path, Trainer],
    command: Callable[..., object],
    refused: Callable[..., str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("evaluate", "published", "--set", "horizon=8", "--episodes", 2, "--out", "run")
    assert "policy mine: unknown; choose auction, belief" in refused(*words, "--policy", "mine")
    shutil.copy(finished[0] / "weights.safetensors", "mine.safetensors")
    assert "there is no such file" in refused(*words, "--policy", "far/mine.safetensors")
    for name in ("mine", "mine.safetensors"):  # the same run, which is finished
        done = command(*words, "--policy", name)
        assert done.code == 0, done  # type: ignore[attr-defined]
    Path("bad.safetensors").write_bytes(b"none")
    assert "weights" in refused(*words, "--policy", "bad")


def test_rounds_take_scenarios_in_turn(tmp_path: Path) -> None:
    other = load_scenario("open-bay", ("horizon=12",))
    trainer = Trainer([scenario(), other], hyperparameters(), seed=0)
    nodes = set()
    for _ in range(2):
        trainer.play_round()
        nodes.add(len(trainer.round.cores[0].setup.graph))
    assert nodes == {len(Setup.of(one.scenario).graph) for one in trainer.tasks}
    assert len(nodes) == 2
    train(scenario(), hyperparameters(), tmp_path, also=[other], updates=1)
    with pytest.raises(UserError, match=r"also differs; maps is "):
        train(scenario(), hyperparameters(), tmp_path, updates=1)
    with pytest.raises(
        UserError, match=r"scenarios published on map .* and comb-port on map .*: fleets or arrays"
    ):
        Trainer(
            [scenario(), load_scenario("comb-port", ("team.scouts.count=1",))], hyperparameters()
        )


def test_a_row_has_what_episodes_had_of_each_term_of_the_reward() -> None:
    trainer = Trainer([scenario()], hyperparameters(), seed=0)
    row = trainer.play_round()
    terms = {name.partition("/")[2]: row[name] for name in row if name.startswith("reward/")}
    assert set(terms) == set(trainer.hyperparameters.reward)
    assert terms["time"] == pytest.approx(trainer.hyperparameters.reward["time"] * 4 * 12)
    agents = {team: ids.size for team, ids in trainer.agents.items()}
    earned = sum(row[f"return_{team}"] * size for team, size in agents.items())
    assert sum(terms.values()) == pytest.approx(earned)
    again = trainer.play_round()
    assert again["reward/time"] == pytest.approx(terms["time"])  # of one round, not of all


def test_a_full_replay_ends_the_warm_up() -> None:
    """A replay has room for rows that no update can draw, so it may never hold `warmup`."""
    trainer = Trainer([scenario()], hyperparameters(warmup=1000), seed=0)
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
    assert "goes on" not in done.err  # type: ignore[attr-defined]
    assert (out / "best.safetensors").is_file()
    again = command(*first, *words)
    updates = pl.read_parquet(out / "training.parquet")["updates"][-1]
    assert f"train: was finished, after {updates:.0f} updates, 0." in again.err  # type: ignore[attr-defined]
    more = command(*(updates + 1 if word == 1 else word for word in first), *words)
    assert f"train: goes on after {updates:.0f} updates, 0." in more.err  # type: ignore[attr-defined]
