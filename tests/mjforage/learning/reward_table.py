"""Returns of policies beside what they collect, on the same episodes of the shipped scenarios.

`python -m tests.mjforage.learning.reward_table --world graph --json FILE` plays them. Returns are
those of `mjforage/Foraging-v0`: sums over agents and decisions, without a discount.
"""

import argparse
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.randomness import UInt64Array, episode_keys
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.policies import create_policy
from mjforage.learning.environments.core import EnvironmentCore
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.mission.policy import Policy
from mjforage.mission.task import Observation, Task
from mjforage.scenario.scenario_file import preset_names
from tests.controllers.proving_ground import say

POLICIES = ("stay", "random", "levy", "lawnmower", "greedy", "belief")
Values = NDArray[np.float64]  # (episode,)


class Stay:
    """All agents stay where they are, or where they must move make the first legal move."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready."""
        self._agents = len(task.fleet)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """(episode, agent, 9) preferences."""
        preferences = np.zeros((observation.active.size, self._agents, 9))
        preferences[..., STAY] = 1.0
        return preferences


def played(
    scenario: str, policy: str | Policy, episodes: int, world: str = "graph", turns: int = 1
) -> dict[str, Values]:
    """Sums of the terms of the default reward, return, PTA_C [%] and NT90 [%] of each episode.

    Parameters
    ----------
    policy : "stay", name of a policy, or one
    turns : steps of the environment in a decision of the fleet: agents for SharedPolicy-v0
    """
    core = EnvironmentCore(EnvironmentOptions(scenario, world), episodes, turns)
    numbers = np.arange(episodes)
    core.start(numbers, episode_keys(7, numbers))
    mission, one = core.mission, Stay() if policy == "stay" else policy
    one = create_policy(one) if isinstance(one, str) else one
    one.reset(mission.task, mission.keys)
    while mission.active.any():
        outcome = core.play(one.act(mission.observation))
    when = mission.ledger.t_collected
    exists = np.arange(when.shape[1]) < core.n_items[:, None]
    horizon = core.setup.scenario.horizon
    series = metrics.pta_series(np.where(when >= 0, when, np.nan), exists, horizon)
    found: dict[str, Values] = {name: sum_.sum(axis=1) for name, sum_ in outcome.sums.items()}
    total = np.sum(list(found.values()), axis=0)
    return {
        **found,
        "return": total,
        "pta_c": series[:, -1],
        "nt90": 100.0 * metrics.nt(series, 90.0),
    }


def ranks(found: Mapping[str, Mapping[str, Values]]) -> Iterator[tuple[str, str, bool]]:
    """Pairs of policies that differ in PTA_C, else in NT90, by more than the interval: the better
    one, the other, and whether the better one has the larger mean return.
    """
    for one, other in itertools.combinations(found, 2):
        gaps = {
            "pta_c": found[one]["pta_c"] - found[other]["pta_c"],
            "nt90": found[other]["nt90"] - found[one]["nt90"],
        }
        for gap in gaps.values():
            mean = float(gap.mean())
            if abs(mean) > float(metrics.half_width_95(gap)):
                better, worse = (one, other) if mean > 0.0 else (other, one)
                returns = [found[name]["return"].mean() for name in (better, worse)]
                yield better, worse, bool(returns[0] > returns[1])
                break


def correlation(found: Mapping[str, Mapping[str, Values]]) -> float:
    """Of return and PTA_C, over the episodes of all policies."""
    returns, shares = (
        np.concatenate([one[key] for one in found.values()]) for key in ("return", "pta_c")
    )
    return float(np.corrcoef(returns, shares)[0, 1])


def main(words: Sequence[str] | None = None) -> None:
    """Play all, print what was found of each scenario, and write the episodes."""
    parser = argparse.ArgumentParser(prog="python -m tests.mjforage.learning.reward_table")
    parser.add_argument("--world", default="graph")
    parser.add_argument("--episodes", type=int, default=40)
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--scenario", nargs="*", default=preset_names())
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args(words)
    written = {}
    for name in chosen.scenario:
        found = {
            policy: played(name, policy, chosen.episodes, chosen.world, chosen.turns)
            for policy in POLICIES
        }
        means = ", ".join(f"{policy} {one['return'].mean():.1f}" for policy, one in found.items())
        wrong = [f"{better} < {worse}" for better, worse, right in ranks(found) if not right]
        say(f"{name}, {chosen.world}: {means}; r = {correlation(found):.3f}; {wrong or 'in order'}")
        written[name] = {
            policy: {key: values.tolist() for key, values in one.items()}
            for policy, one in found.items()
        }
        if chosen.json:
            chosen.json.write_text(json.dumps(written), "utf-8")


if __name__ == "__main__":
    main()
