"""An outside library learns on our environments, without wrappers of ours, within seconds."""

import runpy
from pathlib import Path
from typing import Any

import gymnasium
import pytest

import mjforage  # noqa: F401  registers the ids
from mjforage.graph_planner.networks.inference import one_thread

EXAMPLE = Path(__file__).parents[4] / "examples" / "stable_baselines3_ppo.py"


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
