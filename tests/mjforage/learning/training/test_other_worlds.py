"""Training in the worlds of MuJoCo: what is played and evaluated, what episodes draw, resuming."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from safetensors.torch import load_file

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.learning.training.evaluation import HELD_OUT
from mjforage.learning.training.hyperparameters import Hyperparameters, changed
from mjforage.learning.training.run import train
from mjforage.learning.training.trainer import Trainer
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import METRICS, Scorer
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.scenario.assets import models_folder
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

TINY = {
    "world": "physics",
    "num_envs": 3,
    "capacity": 1000,
    "batch": 16,
    "warmup": 12,
    "evaluate_every": 1000,
    "evaluate_episodes": 2,
}
VARY = {"vary.physics.scale.mass": [0.8, 1.2], "vary.weather.wind_speed_mps": [2.0, 8.0]}


def scenario(*changes: str) -> Scenario:
    few = ("horizon=4", "items.mean=6", "items.std=0", "items.covariance_node2=4")
    return load_scenario("comb-port-weather", (*few, *changes))


def settings(**changes: object) -> Hyperparameters:
    return changed(Hyperparameters(), TINY | changes)


def played(mission: Mission, moves: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places of the agents after every decision by preferences (step, episode, agent, 9)."""
    return np.array([mission.advance(each).agent_rc.copy() for each in moves])


def test_a_batch_is_its_episodes_alone() -> None:
    """To the bit, and started anew as often as one likes."""
    keys = episode_keys(3, np.arange(3))
    moves = np.random.default_rng(0).random((4, 3, 4, 9))
    batch = EnvironmentCore(EnvironmentOptions(scenario(), "physics"), 3)
    for _ in range(2):
        batch.start(np.arange(3), keys)
        together = played(batch.mission, moves)
    for env in range(3):
        alone = create_mission(Setup.of(scenario()), "physics")
        alone.start(keys[[env]])
        np.testing.assert_array_equal(played(alone, moves[:, [env]]), together[:, [env]])
    graph = Mission(Setup.of(scenario()))
    graph.start(keys)
    assert (played(graph, moves) != together).any()


def test_episodes_draw_hulls_and_weather() -> None:
    """Every episode of a round is to the bit that of its own scenario in the world."""
    trainer = Trainer([scenario()], settings(num_envs=6, **VARY), seed=3)
    keys = episode_keys(3, np.arange(6))
    together = trainer.tasks[0].round(keys, 0)
    together.start(keys)
    moves = np.random.default_rng(0).random((4, 6, 4, 9))
    drawn = set()
    for core, envs in zip(together.cores, together.envs, strict=True):
        chosen = core.setup.scenario
        drawn.add((chosen.physics.scale.mass, chosen.weather.wind_speed_mps))
        alone = create_mission(Setup.of(chosen), "physics")
        alone.start(keys[envs])
        np.testing.assert_array_equal(
            played(alone, moves[:, envs]), played(core.mission, moves[:, envs])
        )
    assert len({mass for mass, _ in drawn}) == len({wind for _, wind in drawn}) == 2


def test_evaluations_are_in_the_world() -> None:
    many = scenario("horizon=12", "items.mean=60")
    trainer = Trainer([many], settings(initial="ddqn"), seed=3)
    trainer.begin()
    row = trainer.evaluate()
    assert scores(many, "physics") == pytest.approx({name: row[name] for name in SCORES})
    assert scores(many, "physics") != pytest.approx(scores(many, "graph"))


SCORES = ("pta_d", "rmse_columns")


def scores(chosen: Scenario, world: str) -> dict[str, float]:
    """Of `ddqn` on the held-out episodes."""
    mission = create_mission(Setup.of(chosen), world)
    mission.reset(HELD_OUT, np.arange(2))
    scorer = Scorer(mission, [METRICS.find(name) for name in SCORES])
    mission.run(create_policy("ddqn"), (scorer,))
    return {name: float(values.mean()) for name, values in scorer.scores().scalars.items()}


def test_n_and_m_updates_are_n_stop_resume_m(tmp_path: Path) -> None:
    chosen = settings(initial="ddqn", **VARY)
    for folder, ends in (("whole", (8,)), ("parts", (3, 8))):
        for updates in ends:
            done = train(scenario(), chosen, tmp_path / folder, seed=3, updates=updates)
            assert done.progress.updates >= updates
    one, other = (load_file(tmp_path / f / "checkpoint.safetensors") for f in ("whole", "parts"))
    assert one.keys() == other.keys()
    for name, value in one.items():
        assert torch.equal(value, other[name]), name
    facts = json.loads((tmp_path / "parts" / "training.json").read_text())
    assert facts["hyperparameters"]["world"] == "physics" and len(facts["hulls"]) == 16
    assert facts["code"].keys() == {"mjforage"} and "mujoco" in facts["versions"]
    with pytest.raises(UserError, match=r"hyperparameters.world is .physics. there and .hulls. he"):
        train(
            scenario(),
            settings(initial="ddqn", world="hulls", **VARY),
            tmp_path / "parts",
            seed=3,
            updates=9,
        )


def test_a_run_goes_on_with_the_same_hulls_only(tmp_path: Path) -> None:
    boat = tmp_path / "boat.toml"
    text = (models_folder() / "vessels" / "forager.toml").read_text(encoding="utf-8")
    boat.write_text(text, encoding="utf-8")
    chosen = settings(**{"vary.physics.vessels.foragers": ["forager", str(boat)], "num_envs": 1})
    train(scenario(), chosen, tmp_path / "run", updates=1)
    assert "value = 80.0" in text
    boat.write_text(text.replace("value = 80.0", "value = 81.0"), encoding="utf-8")
    with pytest.raises(UserError, match=r"holds another training: hulls is .* there and .* here"):
        train(scenario(), chosen, tmp_path / "run", updates=2)
    shutil.copy(models_folder() / "vessels" / "forager.toml", boat)
    train(scenario(), chosen, tmp_path / "run", updates=2)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"world": "sea"}, "world = 'sea': unknown; choose graph, hulls"),
        ({"vary.physics.scale.mass": [1.0, 2.0]}, "physics.scale.mass = 2.0 should be "),
        ({"vary.physics.vessels.scouts": ["scout", "raft"]}, "vessel raft: neither a shipped"),
        ({"vary.physics.item_classes": [["drifter"], ["rock"]]}, "item_classes: 'rock'; choose"),
    ],
)
def test_what_a_world_refuses_is_said_before_training(
    changes: dict[str, object], words: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=words):
        train(scenario(), settings(**changes), tmp_path / "run", updates=1)
    assert not (tmp_path / "run").exists()


def test_the_command_line_trains_in_a_world(command: Callable[..., object], tmp_path: Path) -> None:
    settings = {key: value for key, value in TINY.items() if key != "world"}
    words = [f"--learning={key}={value}" for key, value in settings.items()]
    few = ("--set", "horizon=3", "--set", "items.mean=3", "--set", "items.std=0")
    out = ("--updates", 1, "--out", tmp_path / "run")
    first = ("train", "ddqn", "--from", "ddqn", "--scenario", "comb-port-weather")

    done = command(*first, "--world", "hulls", *few, *out, *words)
    assert done.code == 0, done  # type: ignore[attr-defined]
    facts = json.loads((tmp_path / "run" / "training.json").read_text())["hyperparameters"]
    assert (facts["initial"], facts["world"]) == ("ddqn", "hulls")
