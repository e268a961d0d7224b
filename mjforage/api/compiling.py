"""Compiling kernels before they are needed: by playing a little of what will be played."""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np

import mjforage
from mjforage.api.evaluating import evaluate

SCENARIOS = "comb-port", "comb-port-weather", "comb-port-radio"
POLICIES = "greedy", "belief"
WORLDS = "graph", "physics"
DECISIONS = 6
ENCODINGS = "egocentric", "paper"


def compile_kernels(
    scenarios: Sequence[str] = (), policies: Sequence[str] = (), worlds: Sequence[str] = ()
) -> None:
    """Compile and keep the kernels of missions, runs and environments.

    What else a scenario or policy needs is compiled when it is first played.

    Parameters
    ----------
    scenarios, policies, worlds : names; none: `SCENARIOS`, `POLICIES`, `WORLDS`

    Raises
    ------
    UserError
        If there is no such scenario, policy or world.
    """
    worlds = worlds or WORLDS
    for scenario in scenarios or SCENARIOS:
        about: dict[str, Any] = {"world": worlds, "episodes": 2, "horizon": DECISIONS}
        evaluate(scenario, list(policies or POLICIES), progress=False, **about)
        for world in worlds:
            for observation in ENCODINGS:
                _use_environments(scenario=scenario, world=world, observation=observation)


def _use_environments(**arguments: Any) -> None:
    """Reset and step every kind of environment; of two side by side one starts again."""
    env: Any = gymnasium.make_vec("mjforage/Foraging-v0", num_envs=2, **arguments)
    env.reset(seed=0)
    actions = np.zeros(env.action_space.shape, np.int64)
    env.step(actions)
    env.reset(options={"reset_mask": np.array([True, False])})
    env.step(actions)
    single: Any = gymnasium.make("mjforage/SharedPolicy-v0", **arguments)
    single.reset(seed=0)
    for _ in range(actions.shape[1]):
        single.step(np.int64(0))
    parallel = mjforage.parallel_env(**arguments)
    parallel.reset(seed=0)
    parallel.step(dict.fromkeys(parallel.agents, 0))
    parallel.state()
