"""An outside library learns on our environments, without wrappers of ours, within seconds."""

import importlib
import runpy
import sys
from pathlib import Path
from typing import Any

import gymnasium
import pytest
from stable_baselines3 import PPO

import mjforage  # noqa: F401  registers the ids
from mjforage.graph_planner.networks.inference import one_thread

EXAMPLE = Path(__file__).parents[4] / "examples" / "stable_baselines3_and_torchrl.py"


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    return runpy.run_path(str(EXAMPLE))


def test_ppo_learns_to_steer_a_hull(example: dict[str, Any]) -> None:
    """Random thrusters lose about 54, the built-in controller gains 83; half-way is clear of luck.

    Ten seeds came to 47 to 60 on these six episodes.
    """
    env = gymnasium.make("mjforage/Waypoint-v0")
    with one_thread():
        model = example["steersman"](env).learn(3072)
        assert example["mean_return"](env, episodes=6) < -30.0
        assert example["mean_return"](env, model, 6) > 15.0


def test_a_model_of_the_example_plays_in_both_worlds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(EXAMPLE.parent)
    example = importlib.import_module(EXAMPLE.stem)
    env = gymnasium.make("mjforage/SharedPolicy-v0", set=("horizon=4",))
    PPO("MultiInputPolicy", env, n_steps=16, batch_size=16, device="cpu").save("ppo.zip")
    monkeypatch.setattr(example.output, "file", sys.stdout)
    example.compared("ppo.zip", tmp_path / "run", "horizon=4", episodes=1)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(", ")[0] for line in lines] == ["graph", "graph", "physics", "physics"]
    assert f"{EXAMPLE.stem}:Ppo: PTA_C" in lines[0]
