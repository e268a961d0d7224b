"""MaskablePPO of sb3-contrib on `mjforage/SharedPolicy-v0`, with all but the batch by default.

    python -m tests.mjforage.learning.maskable_ppo --seeds 0 1 2 --json found.json

trains a model for each seed and plays it beside `random` on held-out episodes of `comb-port`.
"""

import argparse
import ast
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
import polars as pl
import torch
from sb3_contrib import MaskablePPO
from stable_baselines3.common.vec_env import DummyVecEnv

import mjforage as mf
from tests.controllers.proving_ground import say

ENVIRONMENTS, DECISIONS = 8, 200_000
SCENARIO = "comb-port"


def trained(reward: Any, seed: int, decisions: int) -> MaskablePPO:
    """A model after so many decisions of an agent."""

    def make() -> gymnasium.Env[Any, Any]:
        return gymnasium.make("mjforage/SharedPolicy-v0", scenario=SCENARIO, reward=reward)

    envs = DummyVecEnv([make] * ENVIRONMENTS)
    model = MaskablePPO("MultiInputPolicy", envs, n_steps=512, batch_size=512, seed=seed)
    return model.learn(decisions)


def played(model: MaskablePPO, episodes: int) -> dict[str, list[float]]:
    """PTA_C of the model and of `random`, episode by episode [%]."""
    run = mf.evaluate(SCENARIO, [model, "random"], episodes=episodes, seed=7)
    rows = run.episodes.sort("episode")
    by = {True: rows.filter(policy="random"), False: rows.filter(pl.col("policy") != "random")}
    return {"model": by[False]["pta_c"].to_list(), "random": by[True]["pta_c"].to_list()}


def main(words: Sequence[str] | None = None) -> None:
    """Train, play and write what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reward", default="mission", help="a name, or a mapping of weights")
    parser.add_argument("--seeds", type=int, nargs="*", default=[0, 1, 2], help="of learning")
    parser.add_argument("--decisions", type=int, default=DECISIONS)
    parser.add_argument("--episodes", type=int, default=60)
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args(words)
    reward = chosen.reward
    reward = ast.literal_eval(reward) if reward.startswith("{") else reward
    torch.set_num_threads(1)
    found = []
    for seed in chosen.seeds:
        began = time.process_time()
        model = trained(reward, seed, chosen.decisions)
        minutes = (time.process_time() - began) / 60
        found.append({"seed": seed, "cpu_minutes": minutes} | played(model, chosen.episodes))
        means = {k: sum(v) / len(v) for k, v in found[-1].items() if isinstance(v, list)}
        say(f"{reward}, seed {seed}, {minutes:.1f} CPU minutes: {means}")
    if chosen.json:
        chosen.json.write_text(json.dumps(found) + "\n", "utf-8")


if __name__ == "__main__":
    main()
