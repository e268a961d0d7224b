"""MaskablePPO of sb3-contrib, trained from nothing and played beside `random`.

    python -m tests.mjforage.learning.maskable_ppo --json found.json

trains a model for each seed on `mjforage/SharedPolicy-v0`, with all but the batch by default, and
plays it on held-out episodes of `comb-port`. With `--world physics` it learns on hulls and plays
there: on the batch of docs/learning/hulls.md and with the settings of that page.
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
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnv

import mjforage as mf
from tests.controllers.proving_ground import say
from tests.documents.blocks import blocks

ENVIRONMENTS, DECISIONS = 8, 200_000
FLEETS = 16  # on hulls, of four agents each
SCENARIO = "comb-port"
SEEDS, HELD_OUT = (100, 200, 300), 7
"""Of learning: its environments have this seed and the next ones; and of the episodes played."""


def trained(reward: Any, seed: int, decisions: int, world: str = "graph") -> MaskablePPO:
    """A model after so many decisions of an agent."""
    options = {"scenario": SCENARIO, "reward": reward}

    def make() -> gymnasium.Env[Any, Any]:
        return gymnasium.make("mjforage/SharedPolicy-v0", **options)

    if world == "graph":
        envs: VecEnv = DummyVecEnv([make] * ENVIRONMENTS)
        settings: dict[str, Any] = {"n_steps": 512, "batch_size": 512}
    else:
        envs = fleets(FLEETS, world=world, **options)
        settings = {"n_steps": 64, "batch_size": 512, "learning_rate": 1e-3}
    return MaskablePPO("MultiInputPolicy", envs, seed=seed, **settings).learn(decisions)


def fleets(count: int, **options: Any) -> VecEnv:
    """Make an instance of the class that docs/learning/hulls.md has."""
    (file,) = (block for block in blocks("docs/learning/hulls.md") if block.file == "fleets.py")
    names: dict[str, Any] = {}
    exec(file.text, names)
    made: VecEnv = names["Fleets"](count, **options)
    return made


def played(model: MaskablePPO, episodes: int, world: Any = "graph") -> dict[str, list[float]]:
    """PTA_C of the model and of `random`, episode by episode [%]."""
    run = mf.evaluate(SCENARIO, [model, "random"], episodes=episodes, seed=HELD_OUT, world=world)
    rows = run.episodes.sort("episode")
    by = {True: rows.filter(policy="random"), False: rows.filter(pl.col("policy") != "random")}
    return {"model": by[False]["pta_c"].to_list(), "random": by[True]["pta_c"].to_list()}


def main(words: Sequence[str] | None = None) -> None:
    """Train, play and write what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", default="graph")
    parser.add_argument("--reward", default="mission", help="a name, or a mapping of weights")
    parser.add_argument("--seeds", type=int, nargs="*", default=SEEDS, help="of learning")
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
        model = trained(reward, seed, chosen.decisions, chosen.world)
        minutes = (time.process_time() - began) / 60
        scores = played(model, chosen.episodes, chosen.world)
        found.append({"seed": seed, "cpu_minutes": minutes} | scores)
        means = {k: sum(v) / len(v) for k, v in scores.items()}
        say(f"{reward}, seed {seed}, {minutes:.1f} CPU minutes: {means}")
    if chosen.json:
        chosen.json.write_text(json.dumps(found) + "\n", "utf-8")


if __name__ == "__main__":
    main()
