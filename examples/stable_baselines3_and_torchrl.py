"""Two outside libraries on our environments, without wrappers of ours.

Stable-Baselines3 trains PPO on `mjforage/SharedPolicy-v0` and `mjforage/Waypoint-v0`; TorchRL plays
the PettingZoo view. `pip install -c constraints.txt -e '.[libraries]'` installs both. Then

    python examples/stable_baselines3_and_torchrl.py waypoint 9216
    python examples/stable_baselines3_and_torchrl.py waypoint 9216 1
    python examples/stable_baselines3_and_torchrl.py shared 24000
    python examples/stable_baselines3_and_torchrl.py torchrl
    python examples/stable_baselines3_and_torchrl.py policy 24000

The numbers are steps and, if given, the learner's seed. The last one makes a policy of the model,
and compares it with Greedy at graph level and in MuJoCo.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray
from rich.console import Console

import mjforage
from mjforage.learning.environments.spaces import Arrays
from mjforage.learning.model_policy import ModelPolicy
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.scenario_file import load_scenario

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


class Ppo(ModelPolicy):
    """A model of `forager` as a policy; on a command line `MODULE:Ppo(file=ppo.zip)`."""

    def __init__(self, file: Path = Path("ppo.zip")) -> None:
        from stable_baselines3 import PPO

        super().__init__([file])
        self.model = PPO.load(file, device="cpu")

    def decide(self, seen: Arrays, agents: NDArray[np.int64]) -> NDArray[Any]:
        """Moves (row,), one row for each agent that decides."""
        moves: NDArray[Any] = self.model.predict(seen, deterministic=True)[0]
        return moves


def policy(steps: int = 24000, seed: int = 0) -> None:
    """PPO learns in the environment and plays in both worlds; `ppo.zip` and `runs/ppo` are left."""
    model = forager(gymnasium.make("mjforage/SharedPolicy-v0", reward=SHARED_REWARD), seed)
    model.learn(steps).save("ppo.zip")
    compared("ppo.zip", Path("runs/ppo"))


def compared(file: str, folder: Path, *overrides: str, episodes: int = 5) -> None:
    """Play a model beside Greedy at graph level and in MuJoCo, and print what each collected."""
    names = [f"{Path(__file__).stem}:Ppo(file={file})", "greedy"]
    setup = Setup.of(load_scenario("comb-port", overrides))
    found = evaluate(setup, names, folder, episodes=episodes, worlds=("graph", "physics"))
    for world, policies in found.items():
        for name, metrics in policies.items():
            output.print(f"{world}, {name}: PTA_C {metrics['pta_c']['mean']:.1f} %")


def torchrl() -> None:
    """TorchRL plays a masked random episode of the PettingZoo view."""
    from torchrl.envs.libs.pettingzoo import PettingZooWrapper

    view = mjforage.parallel_env(scenario="published")
    env = PettingZooWrapper(view, use_mask=True, seed=0)  # groups scouts_0, ... by their teams
    episode = env.rollout(150)
    for team in env.group_map:
        rewards = episode["next", team, "reward"]
        mean = float(rewards.sum(0).mean())
        output.print(f"{team}: {rewards.shape[0]} steps, return per agent {mean:.1f}")


LESSONS: dict[str, Callable[..., None]] = {
    "waypoint": waypoint,
    "shared": shared,
    "torchrl": torchrl,
    "policy": policy,
}


def main(what: str = "torchrl", *numbers: str) -> None:
    """Run one lesson."""
    most = 0 if what == "torchrl" else 2
    if what not in LESSONS:
        sys.exit(f"lesson {what}: unknown; choose {', '.join(LESSONS)}")
    if len(numbers) > most or not all(number.isdecimal() for number in numbers):
        sys.exit(f"{what} {' '.join(numbers)}: give at most {most} whole numbers, steps and seed")
    torch.set_num_threads(1)  # the networks are small: more threads only wait for each other
    LESSONS[what](*map(int, numbers))


if __name__ == "__main__":
    main(*sys.argv[1:])
