"""`mjforage bench --decisions`: what a policy's decision for a whole fleet takes, by its size."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import policy_names
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.runs.decision_time import Watch, watched
from mjforage.scenario.scenario_file import load_scenario

SCENARIO = "open-bay"  # where there is room for 64
FLEETS = (4, 16, 64)  # agents, half of them scouts
HORIZON = 40  # decisions: most work is done in the first
EPISODES = 4  # one after the other, as a fleet at sea is alone
REPEATS = 3


@dataclass(frozen=True)
class DecisionTime:
    """CPU time of one decision of a fleet.

    Attributes
    ----------
    policy, agents : whose, and of how many
    ms : median over episodes, repeats apart; without an episode's first decision, which prepares
    low, high : of the episodes
    reason : why there is no time; "" if there is
    """

    policy: str
    agents: int
    ms: float
    low: float
    high: float
    reason: str = ""


def fleet_setup(agents: int, horizon: int = HORIZON) -> Setup:
    """The mission that is decided in, with so many agents."""
    half = agents // 2
    teams = f"team.scouts.count={half}", f"team.foragers.count={agents - half}"
    return Setup.of(load_scenario(SCENARIO, (*teams, "map.starts=[]", f"horizon={horizon}")))


def _episode_ms(setup: Setup, name: str, episode: int) -> float:
    """CPU milliseconds per decision of an episode."""
    mission, watch = Mission(setup), Watch()
    mission.reset(0, np.array([episode]))
    mission.run(watched(create_policy(name), watch, 1))
    return 1000.0 * watch.cpu_s / max(1, watch.decisions)


def decision_times(
    policies: Sequence[str] = (),
    fleets: Sequence[int] = FLEETS,
    horizon: int = HORIZON,
    progress: Callable[[str], None] = lambda name: None,
) -> list[DecisionTime]:
    """Time of every policy (all that have a name, if none is given) with every fleet."""
    found = []
    for agents in fleets:
        setup = fleet_setup(agents, horizon)
        for name in policies or policy_names():
            progress(f"{name}, {agents} agents")
            try:
                _episode_ms(setup, name, EPISODES)  # compiles
                each = [
                    _episode_ms(setup, name, episode)
                    for episode in range(EPISODES)
                    for _ in range(REPEATS)
                ]
            except UserError as error:
                found.append(DecisionTime(name, agents, *(float("nan"),) * 3, str(error)))
                continue
            least = [min(each[i : i + REPEATS]) for i in range(0, len(each), REPEATS)]
            found.append(
                DecisionTime(name, agents, statistics.median(least), min(least), max(least))
            )
    return found
