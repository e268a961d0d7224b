"""Stable-Baselines3 trains PPO on our environments, without wrappers.

`pip install -c constraints.txt -e '.[libraries]'` installs it. Then

    python examples/stable_baselines3_ppo.py waypoint 9216
    python examples/stable_baselines3_ppo.py waypoint 9216 1
    python examples/stable_baselines3_ppo.py shared 24000

The numbers are steps and, if given, the learner's seed.
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import torch
from rich.console import Console

import mjforage  # noqa: F401  registers the ids

output = Console(highlight=False)

EPISODES = 20
SHARED_REWARD = {"removed": 1.0, "discovered": 0.5, "idleness": 0.02, "approach": 0.05}


def mean_return(env: gymnasium.Env[Any, Any], model: Any = None, episodes: int = EPISODES) -> float:
    """Mean undiscounted return of a model, or of random actions, on held-out episodes."""
    returns = []
    for episode in range(episodes):
        observation, _ = env.reset(seed=1_000_000 + episode)
        env.action_space.seed(episode)
        torch.manual_seed(episode)  # a model draws its actions
        total, over = 0.0, False
        while not over:
            action = env.action_space.sample() if model is None else model.predict(observation)[0]
            observation, reward, terminated, truncated, _ = env.step(action)
            total, over = total + float(reward), terminated or truncated
        returns.append(total)
    return float(np.mean(returns))


def builtin_return(env: Any) -> float:
    """Mean return of the built-in controller on the same waypoints and weather."""
    returns = []
    for episode in range(EPISODES):
        env.reset(seed=1_000_000 + episode)
        pilot, total, over = env.builtin_pilot(), 0.0, False
        while not over:
            _, reward, terminated, truncated, _ = env.step_builtin(pilot)
            total, over = total + reward, terminated or truncated
        returns.append(total)
    return float(np.mean(returns))


def steersman(env: gymnasium.Env[Any, Any], seed: int = 0) -> Any:
    """PPO for `mjforage/Waypoint-v0`, untrained."""
    from stable_baselines3 import PPO

    settings: dict[str, Any] = {"n_steps": 512, "batch_size": 64, "learning_rate": 1e-3}
    return PPO("MlpPolicy", env, seed=seed, device="cpu", gamma=0.95, **settings)


def learn(env: gymnasium.Env[Any, Any], model: Any, steps: int) -> None:
    """Train a model and print what it then gains."""
    started = time.perf_counter()
    model.learn(steps)
    seconds = time.perf_counter() - started
    output.print(f"PPO after {steps} steps, {seconds:.0f} s: {mean_return(env, model):.1f}")


def waypoint(steps: int = 9216, seed: int = 0) -> None:
    """PPO learns to steer a hull."""
    env = gymnasium.make("mjforage/Waypoint-v0")
    random, builtin = mean_return(env), builtin_return(env.unwrapped)
    output.print(f"random {random:.1f}, built-in controller {builtin:.1f}")
    learn(env, steersman(env, seed), steps)


def forager(env: gymnasium.Env[Any, Any], seed: int = 0) -> Any:
    """PPO for `mjforage/SharedPolicy-v0`, untrained."""
    from stable_baselines3 import PPO

    return PPO("MultiInputPolicy", env, seed=seed, device="cpu", n_steps=2400, batch_size=240)


def shared(steps: int = 24000, seed: int = 0) -> None:
    """PPO learns one policy for all agents of a fleet."""
    env = gymnasium.make("mjforage/SharedPolicy-v0", reward=SHARED_REWARD)
    output.print(f"random {mean_return(env):.1f}")
    learn(env, forager(env, seed), steps)


LESSONS: dict[str, Callable[..., None]] = {"waypoint": waypoint, "shared": shared}


def main(what: str = "waypoint", *numbers: str) -> None:
    """Run one lesson."""
    if what not in LESSONS:
        sys.exit(f"lesson {what}: unknown; choose {', '.join(LESSONS)}")
    if len(numbers) > 2 or not all(number.isdecimal() for number in numbers):
        sys.exit(f"{what} {' '.join(numbers)}: give at most 2 whole numbers, steps and seed")
    torch.set_num_threads(1)  # the networks are small: more threads only wait for each other
    LESSONS[what](*map(int, numbers))


if __name__ == "__main__":
    main(*sys.argv[1:])
