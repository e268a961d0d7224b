"""The checkers of Gymnasium and PettingZoo, and the clients that are to work without adapters."""

import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test
from stable_baselines3.common import env_checker

import mjforage
from mjforage.base.errors import UserError

SHORT = ("horizon=12",)
FORAGING = ("mjforage/Foraging-v0", "mjforage/SharedPolicy-v0")


@pytest.mark.parametrize("world", ["graph", "physics"])
@pytest.mark.parametrize("kind", ["egocentric", "paper"])
@pytest.mark.parametrize("name", FORAGING)
def test_gymnasium_accepts_the_foraging_environments(name: str, kind: str, world: str) -> None:
    env = gymnasium.make(name, world=world, observation=kind, set=SHORT, render_mode="rgb_array")
    check_env(env.unwrapped)


def test_gymnasium_accepts_the_waypoints() -> None:
    check_env(gymnasium.make("mjforage/Waypoint-v0", render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("world", ["graph", "physics"])
def test_pettingzoo_accepts_the_parallel_view(world: str) -> None:
    env = mjforage.parallel_env(world=world, set=SHORT, render_mode="rgb_array")
    parallel_api_test(env, 30)
    env.reset(seed=0)
    assert env.render().dtype == np.uint8


def test_default_arguments_work_once_mjforage_is_imported() -> None:
    for name in (*FORAGING, "mjforage/Waypoint-v0"):
        env = gymnasium.make(name)
        env.reset(seed=0)
        env.step(env.action_space.sample())
        env.close()


def test_registration_imports_neither_torch_nor_mujoco_nor_numba() -> None:
    program = (
        "import sys, mjforage, gymnasium\n"
        "assert 'mjforage/Waypoint-v0' in gymnasium.registry\n"
        "print(sorted({'torch', 'mujoco', 'numba', 'scipy', 'pettingzoo'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("name", ["mjforage/SharedPolicy-v0", "mjforage/Waypoint-v0"])
def test_stable_baselines3_accepts(name: str) -> None:
    env_checker.check_env(gymnasium.make(name), warn=False)  # it takes maps in [0, 1] for pictures


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"world": "mars"}, "world = 'mars': unknown; choose graph, hulls"),
        ({"observation": "pixels"}, "observation pixels: unknown; choose egocentric, paper"),
        ({"reward": {"remove": 1.0}}, "reward remove: unknown; did you mean removed?"),
        ({"reward": ["removed"]}, "reward = ['removed']: give a weight for each term"),
        ({"reward": "misson"}, "reward = 'misson': unknown; did you mean mission?"),
        ({"reward": {"removed": float("nan")}}, "reward removed = nan: give a finite number"),
        ({"render_mode": "ansi"}, "render_mode = 'ansi': unknown; choose None, rgb_array"),
        ({"scenario": "nowhere"}, "scenario nowhere: neither a shipped scenario nor a TOML file"),
    ],
)
def test_bad_options_are_named(options: dict[str, Any], words: str) -> None:
    with pytest.raises(UserError) as raised:
        mjforage.parallel_env(**options)
    assert words in str(raised.value)
