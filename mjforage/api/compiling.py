"""Compiling kernels before they are needed: by playing a little of what will be played."""

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

import gymnasium
import numpy as np

import mjforage
from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy, policy_names
from mjforage.learning.environments.rewards import PRESETS

SCENARIOS = "comb-port", "comb-port-weather", "comb-port-radio", "channels"
POLICIES = "greedy", "belief"
WORLDS = "graph", "physics"
DECISIONS = 30  # of an episode: some kernels are first used late in it
ENCODINGS = "egocentric", "paper"
TRAINING = {"num_envs": 2, "capacity": 1000, "batch": 4, "warmup": 4, "evaluate_episodes": 1}


def compile_kernels(
    scenarios: Sequence[str] = (), policies: Sequence[str] = (), worlds: Sequence[str] = ()
) -> None:
    """Compile and keep the kernels of runs, pictures, environments and training.

    What else a scenario or policy needs is compiled when it is first played. What cannot be played
    here for want of an extra or of OpenGL is left out. Raises `UserError` if there is no such
    scenario, policy or world.

    Parameters
    ----------
    scenarios, worlds : names; none: `SCENARIOS`, `WORLDS`
    policies : names; none: all of them in the first scenario, `POLICIES` in the others
    """
    worlds, scenarios = worlds or WORLDS, scenarios or SCENARIOS
    about: dict[str, Any] = {"horizon": DECISIONS, "progress": False}
    for scenario in scenarios:
        playing = policies or (_playable() if scenario == scenarios[0] else POLICIES)
        more = about | {"episodes": 2, "world": worlds}
        run = mjforage.evaluate(scenario, list(playing), **more)
        for world in worlds:
            with suppress(UserError):
                run.frame(world=world, time_s=5.0)
            for observation in ENCODINGS:
                _use_environments(scenario=scenario, world=world, observation=observation)
    with suppress(UserError), tempfile.TemporaryDirectory() as folder:
        about |= {"settings": TRAINING | {"vary.items.mean": [50, 75]}, "folder": f"{folder}/run"}
        mjforage.train("ddqn", scenarios[0], updates=1, **about)


def _playable() -> Iterator[str]:
    """Names of the policies that can be made here."""
    for name in policy_names():
        with suppress(UserError):
            create_policy(name)
            yield name


def _use_environments(**arguments: Any) -> None:
    """Reset, step and draw every kind of environment; of two side by side one starts again."""
    arguments |= {"reward": dict.fromkeys(PRESETS, 1.0), "render_mode": "rgb_array"}
    env: Any = gymnasium.make_vec("mjforage/Foraging-v0", num_envs=2, **arguments)
    env.reset(seed=0)
    actions = np.zeros(env.action_space.shape, np.int64)
    env.step(actions)
    env.reset(options={"reset_mask": np.array([True, False])})
    env.step(actions)
    env.render()
    single: Any = gymnasium.make("mjforage/SharedPolicy-v0", **arguments)
    single.reset(seed=0)
    for _ in range(actions.shape[1]):
        single.step(np.int64(0))
    parallel = mjforage.parallel_env(**arguments)
    parallel.reset(seed=0)
    parallel.step(dict.fromkeys(parallel.agents, 0))
    parallel.state()
