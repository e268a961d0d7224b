"""Two outside libraries on our environments, without wrappers of ours.

Stable-Baselines3 trains PPO on `mjforage/SharedPolicy-v0` and `mjforage/Waypoint-v0`; TorchRL plays
the PettingZoo view. Install them first: `pip install stable-baselines3 torchrl`. Then

    python examples/stable_baselines3_and_torchrl.py waypoint 10000
    python examples/stable_baselines3_and_torchrl.py shared 40000
    python examples/stable_baselines3_and_torchrl.py torchrl
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import torch
from rich.console import Console

import mjforage

output = Console(highlight=False)

EPISODES = 20
SHARED_REWARD = {"removed": 1.0, "discovered": 0.5, "idleness": 0.02, "approach": 0.05}


def mean_return(env: gymnasium.Env[Any, Any], model: Any = None) -> float:
    """Mean undiscounted return of a model, or of random actions, on held-out episodes."""
    returns = []
    for episode in range(EPISODES):
        observation, _ = env.reset(seed=1_000_000 + episode)
        env.action_space.seed(episode)
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


def waypoint(steps: int) -> None:
    """PPO learns to steer a hull."""
    from stable_baselines3 import PPO

    env = gymnasium.make("mjforage/Waypoint-v0")
    random, builtin = mean_return(env), builtin_return(env.unwrapped)
    output.print(f"random {random:.1f}, built-in controller {builtin:.1f}")
    settings: dict[str, Any] = {"n_steps": 512, "batch_size": 64, "learning_rate": 1e-3}
    model = PPO("MlpPolicy", env, seed=0, device="cpu", gamma=0.95, **settings)
    started = time.perf_counter()
    model.learn(steps)
    minutes = (time.perf_counter() - started) / 60
    output.print(f"PPO after {steps} steps, {minutes:.1f} min: {mean_return(env, model):.1f}")


def shared(steps: int) -> None:
    """PPO learns one policy for all agents of a fleet."""
    from stable_baselines3 import PPO

    env = gymnasium.make("mjforage/SharedPolicy-v0", reward=SHARED_REWARD)
    output.print(f"random {mean_return(env):.1f}")
    model = PPO("MultiInputPolicy", env, seed=0, device="cpu", n_steps=2400, batch_size=240)
    started = time.perf_counter()
    model.learn(steps)
    minutes = (time.perf_counter() - started) / 60
    output.print(f"PPO after {steps} steps, {minutes:.1f} min: {mean_return(env, model):.1f}")


def torchrl() -> None:
    """TorchRL plays a masked random episode of the PettingZoo view."""
    from torchrl.envs.libs.pettingzoo import PettingZooWrapper

    view = mjforage.parallel_env(scenario="published")
    teams: dict[str, list[str]] = {}
    for agent in view.possible_agents:
        teams.setdefault(agent.rpartition("-")[0], []).append(agent)
    env = PettingZooWrapper(view, use_mask=True, seed=0, group_map=teams)
    episode = env.rollout(150)
    for team in env.group_map:
        rewards = episode["next", team, "reward"]
        mean = float(rewards.sum(0).mean())
        output.print(f"{team}: {rewards.shape[0]} steps, return per agent {mean:.1f}")


if __name__ == "__main__":
    torch.set_num_threads(1)  # the networks are small: more threads only wait for each other
    what, *numbers = sys.argv[1:] or ["torchrl"]
    lessons: dict[str, Callable[..., None]] = {
        "waypoint": waypoint,
        "shared": shared,
        "torchrl": torchrl,
    }
    lessons[what](*map(int, numbers))
