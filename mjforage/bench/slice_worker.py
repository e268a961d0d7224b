"""One side of `mjforage bench --against`: does slices of work on request.

Run as a script with the checkout to measure first on `PYTHONPATH`, so that it imports that
checkout's mjforage: it keeps to what has long been there. A line "NAME SECONDS" on standard input
asks for a slice; the answer is the work done and the CPU seconds that it took.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import gymnasium
import numba
import numpy as np

import mjforage  # noqa: F401  registers the environments
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.worlds import create_mission
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.scenario_file import load_scenario

HASHES = 1_000_000
EVALUATED = 400  # episodes of a call
HORIZON = 20  # decisions with hulls
ENV_STEPS = 50  # of the vector environment in a call


def _hash(count: int) -> np.uint64:
    """Integer hashing, the yardstick: it hangs on the core alone, not on memory."""
    value = np.uint64(1)
    for _ in range(count):
        value ^= value >> np.uint64(30)
        value *= np.uint64(0xBF58476D1CE4E5B9)
        value ^= value >> np.uint64(27)
    return value


_fast_hash = cast(Any, numba).njit(_hash)


def _hashing() -> float:
    _fast_hash(HASHES)
    return HASHES


def _steps(policy_name: str, episodes: int) -> Callable[[], float]:
    mission = Mission(Setup.of(load_scenario("comb-port")))
    policy = create_policy(policy_name)

    def work() -> float:
        mission.reset(0, np.arange(episodes))
        mission.run(policy)
        return float(mission.step.sum())

    return work


def _evaluation() -> float:
    setup = Setup.of(load_scenario("comb-port"))
    with tempfile.TemporaryDirectory() as folder:
        summary = evaluate(setup, ["greedy"], Path(folder) / "run", episodes=EVALUATED)
    return float(summary["graph"]["greedy"]["length"]["mean"]) * EVALUATED


def _hulls() -> Callable[[], float]:
    setup = Setup.of(load_scenario("comb-port", [f"horizon={HORIZON}"]))

    def work() -> float:
        mission = create_mission(setup, "physics")
        mission.reset(0, np.arange(4))
        mission.run(create_policy("greedy"))
        return float(mission.step.sum())

    return work


def _environment(num_envs: int) -> Callable[[], float]:
    """The vector environment with egocentric observations and random actions."""
    env: Any = gymnasium.make_vec("mjforage/Foraging-v0", num_envs=num_envs, scenario="comb-port")
    actions = np.random.default_rng(0).integers(0, 9, (ENV_STEPS, *env.action_space.shape))

    def work() -> float:
        env.reset(seed=0)
        for action in actions:
            env.step(action)
        return float(num_envs * ENV_STEPS)

    return work


NAMES = (
    "hashing",
    *("random, 400 episodes", "random, 100 episodes", "random, 1 episode"),
    *("greedy, 400 episodes", "greedy, 100 episodes", "levy, 100 episodes"),
    *("environment, 64 episodes", "evaluate", "physics"),
)
"""Workloads: a policy and the episodes of its batch at graph level, or one of the others."""


def _made(name: str) -> Callable[[], float]:
    """A piece of work, which returns how many steps (or hashes) it was."""
    policy, _, batch = name.partition(", ")
    if policy == "environment":
        return _environment(int(batch.split()[0]))
    if batch:
        return _steps(policy, int(batch.split()[0]))
    return _hulls() if name == "physics" else {"hashing": _hashing, "evaluate": _evaluation}[name]


def serve() -> None:
    """Answer requests until standard input ends; the first slice of a kind compiles before it."""
    made: dict[str, Callable[[], float]] = {}
    for line in sys.stdin:
        name, _, seconds = line.strip().rpartition(" ")
        if name not in made:
            made[name] = _made(name)
            made[name]()
        done, started = 0.0, time.process_time()
        while (spent := time.process_time() - started) < float(seconds):
            done += made[name]()
        sys.stdout.write(f"{done} {spent}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    serve()
