"""Whole runs of multi-agent PPO, tiny ones, and its weights as a policy."""

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import torch

from mjforage.base.errors import UserError, WeightsError
from mjforage.graph_planner.networks import weights
from mjforage.graph_planner.networks.weights import ACTOR, read_header
from mjforage.graph_planner.policies.ddqn import MappoPolicy, QPolicy
from mjforage.learning.training.hyperparameters import changed
from mjforage.learning.training.mappo.critic_features import critic_features
from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
from mjforage.learning.training.mappo.trainer import MappoTrainer
from mjforage.learning.training.run import train, train_with
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

TINY = {
    "num_envs": 3,
    "batch": 16,
    "epochs": 1,
    "evaluate_every": 2,
    "evaluate_episodes": 2,
    "teacher": "greedy",
    "teacher_updates": 3,
}


def scenario() -> Scenario:
    return load_scenario("published", ("horizon=12",))


def settings(**changes: object) -> MappoHyperparameters:
    return changed(MappoHyperparameters(), TINY | changes)


def run(folder: Path, updates: int, **more: Any) -> MappoTrainer:
    return train_with(MappoTrainer, scenario(), settings(), folder, seed=3, updates=updates, **more)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, MappoTrainer]:
    folder = tmp_path_factory.mktemp("mappo") / "run"
    return folder, run(folder, 12)


def test_training_changes_every_weight_and_tells_what_it_did(
    finished: tuple[Path, MappoTrainer],
) -> None:
    fresh = MappoTrainer([scenario()], settings(), seed=3).tensors()
    after = finished[1].tensors()
    same = [n for n, v in fresh.items() if n.startswith(("actors", "critic")) and v.numel() > 1]
    assert not [name for name in same if torch.equal(fresh[name], after[name])]
    rows = pl.read_parquet(finished[0] / "training.parquet")
    assert rows["loss_taught"][0] > 0.0 and rows["loss_taught"].is_nan()[-1]
    assert rows["loss_objective"].is_nan()[0] and not rows["loss_objective"].is_nan()[-1]
    assert rows["loss_critic"].is_not_nan().all()


def test_the_critic_alone_is_shown_where_items_are() -> None:
    trainer = MappoTrainer([scenario()], settings(), seed=0)
    trainer.start_round()
    found, mission = critic_features(trainer.round), trainer.round.cores[0].mission
    graph, counts = mission.setup.graph, np.zeros((3, 16, 16))
    height, width = graph.shape
    for env, item in np.argwhere(mission.truth.item_node >= 0):
        node = mission.truth.item_node[env, item]
        counts[env, graph.rows[node] * 16 // height, graph.cols[node] * 16 // width] += 1
    expected = np.floor(25.5 * np.minimum(counts, 10))
    np.testing.assert_array_equal(found["truth.items"][:, 0], expected)
    assert (counts > 10).any() and (found["truth.facts"][:, 2] == 0).all()
    assert (found["truth.facts"][:, 0] == 255).all()
    assert not set(trainer.shapes) & set(found)


def test_the_critic_is_told_how_far_it_has_come_and_how_items_drift() -> None:
    """In 255ths, rounded down: items left, those found and left, the time, drift south and east."""
    long = load_scenario("published", ("horizon=60",))
    trainer = MappoTrainer([long], settings(), seed=0)
    trainer.start_round()
    trainer.round.teach("greedy")
    for _ in range(45):
        trainer.round.play(trainer.round.demonstrated()[0])
    found, mission = critic_features(trainer.round)["truth.facts"], trainer.round.cores[0].mission
    for env in range(3):
        here = mission.truth.item_node[env] >= 0
        items, entries = int(mission.initial.n_items[env]), mission.ledger
        known = int((here & (entries.t_discovered[env] >= 0)).sum())
        south, east = mission.truth.drift_rc[env]
        shares = [here.sum() / items, known / items, 45 / 60, (1 + south) / 2, (1 + east) / 2]
        assert found[env].tolist() == [int(255 * share) for share in shares]
    assert (found[:, 1] > 0).any() and (found[:, 3] != found[:, 4]).any()
    assert (found[:, 0] < 255).any()


def test_rewards_are_an_agents_own_or_the_fleets(monkeypatch: pytest.MonkeyPatch) -> None:
    paid = {}
    for shared in (0.0, 1.0):
        trainer = MappoTrainer([scenario()], settings(shared=shared, teacher="", teacher_updates=0))
        learn = trainer.updates.learn
        monkeypatch.setattr(
            trainer.updates, "learn", lambda round, *a, s=shared: paid.update({s: round}) or []
        )
        trainer.play_round()
        assert learn is not None
    own, mean = paid[0.0].rewards, paid[1.0].rewards
    assert (own != own[:, :1]).any()
    np.testing.assert_allclose(mean, np.repeat(own.mean(axis=1, keepdims=True), 4, 1), rtol=1e-5)


def test_weights_are_a_policy_without_torchrl(
    finished: tuple[Path, MappoTrainer], tmp_path: Path
) -> None:
    """Without TorchRL they are played, and training says what is missing."""
    shutil.copy(finished[0] / "best.safetensors", tmp_path / "mine.safetensors")
    assert read_header(tmp_path / "mine.safetensors").format == ACTOR
    text = """
import sys
sys.modules["torchrl"] = sys.modules["tensordict"] = None
from mjforage.cli import main
words = ["evaluate", "published", "--set", "horizon=8", "--episodes", "2", "--policy", "mine"]
try:
    main([*words, "--out", "run"])
except SystemExit as end:
    assert not end.code, end
try:
    main(["train", "mappo", "--updates", "1", "--out", "none"])
except SystemExit as end:
    sys.exit(end.code)
"""
    done = subprocess.run(
        [sys.executable, "-c", text], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (tmp_path / "run" / "summary.json").is_file(), done.stderr
    assert done.returncode == 2
    wanted = "train mappo: needs torchrl; install it with pip install 'mjforage[learn]'"
    assert wanted in " ".join(done.stderr.split())


def test_weights_of_another_kind_are_refused(
    finished: tuple[Path, MappoTrainer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    actor = finished[0] / "best.safetensors"
    mission = Mission(Setup.of(scenario()))
    mission.reset(0, np.arange(1))
    mission.run(QPolicy(actor))
    (tmp_path / "weights").mkdir()
    monkeypatch.setattr(weights, "models_folder", lambda: tmp_path)
    data = actor.read_bytes().replace(b"mjforage actor 1", b"mjforage actor 9")
    (tmp_path / "weights" / "mappo.safetensors").write_bytes(data)
    with pytest.raises(WeightsError, match=r"format 'mjforage actor 9', .* expected .*actor 1'"):
        MappoPolicy()
    trained = train(scenario(), changed_ddqn(), tmp_path / "ddqn", updates=1)
    assert trained.weights_kind != ACTOR
    shutil.copy(tmp_path / "ddqn/best.safetensors", tmp_path / "weights/mappo.safetensors")
    with pytest.raises(WeightsError, match=r"q-network 1', expected 'mjforage actor 1'"):
        MappoPolicy()


def changed_ddqn() -> Any:
    from mjforage.learning.training.hyperparameters import Hyperparameters

    small = {"num_envs": 2, "batch": 8, "warmup": 8, "capacity": 1000, "evaluate_episodes": 1}
    return changed(Hyperparameters(), small)


def test_settings_and_devices_are_checked(refused: Callable[..., str], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="gae = 2 should be "):
        settings(gae=2)
    with pytest.raises(UserError, match="teacher = 'greedy', teacher_updates = 0: give both"):
        settings(teacher_updates=0)
    words = ("--updates", 1, "--out", tmp_path / "run")
    assert "unknown key n_step" in refused("train", "mappo", "--learning", "n_step=3", *words)
    assert "algorithm mapo: unknown; did you mean mappo" in refused("train", "mapo", *words)
    assert "is no mjforage" in refused("train", "json:JSONDecoder", *words)
