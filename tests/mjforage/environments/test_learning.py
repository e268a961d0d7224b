"""An outside library learns on our environments, without wrappers of ours, within seconds."""

from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO

import mjforage  # noqa: F401  registers the ids
from graph_planner.inference import one_thread


def mean_return(env: gymnasium.Env[Any, Any], episodes: int, model: PPO | None = None) -> float:
    """Of a model, or of random actions, on held-out episodes."""
    returns = []
    for episode in range(episodes):
        observation, _ = env.reset(seed=1_000_000 + episode)
        env.action_space.seed(episode)
        torch.manual_seed(episode)
        total, over = 0.0, False
        while not over:
            action = env.action_space.sample() if model is None else model.predict(observation)[0]
            observation, reward, terminated, truncated, _ = env.step(action)
            total, over = total + float(reward), terminated or truncated
        returns.append(total)
    return float(np.mean(returns))


def trained(env: gymnasium.Env[Any, Any], policy: str, steps: int, **settings: Any) -> PPO:
    """PPO after so many steps."""
    with one_thread():
        model = PPO(policy, env, learning_rate=1e-3, seed=0, device="cpu", **settings)
        return model.learn(steps)


def test_ppo_learns_to_steer_a_hull() -> None:
    """Random thrusters lose about 60, the built-in controller gains 84."""
    env = gymnasium.make("mjforage/Waypoint-v0")
    model = trained(env, "MlpPolicy", 3072, n_steps=512, batch_size=64, gamma=0.95)
    assert mean_return(env, 4) < 0.0
    assert mean_return(env, 4, model) > 40.0


def test_ppo_learns_to_forage() -> None:
    reward = {"idleness": 0.1, "removed": 1.0, "discovered": 1.0}
    env = gymnasium.make(
        "mjforage/SharedPolicy-v0", scenario="published", set=("horizon=30",), reward=reward
    )
    settings = {"n_steps": 960, "batch_size": 120, "n_epochs": 5, "gamma": 0.97}
    model = trained(env, "MultiInputPolicy", 4800, **settings)
    assert mean_return(env, 20, model) > 1.25 * mean_return(env, 20)
