"""CPU time of one decision of a whole fleet, by policy and size of the fleet."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policies.registry import policy_names
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.runs.decision_time import Timer, timed
from mjforage.scenario.scenario_file import load_scenario

FLEETS = (4, 16, 64)  # agents, half of them scouts
HORIZON = 40  # decisions: most work is done in the first
EPISODES, REPEATS = 4, 3  # one after the other, as a fleet at sea is alone


@dataclass(frozen=True)
class DecisionTime:
    """Median [ms] over episodes, without an episode's first decision, and their range."""

    policy: str
    agents: int
    ms: float
    low: float
    high: float
    reason: str = ""  # why there is no time, which is 0 then


def fleet_setup(agents: int, horizon: int = HORIZON) -> Setup:
    """The mission that is decided in, with so many agents."""
    half = agents // 2
    teams = f"team.scouts.count={half}", f"team.foragers.count={agents - half}"
    return Setup.of(load_scenario("open-bay", (*teams, "map.starts=[]", f"horizon={horizon}")))


def _episode_ms(setup: Setup, name: str, episode: int) -> float:
    mission, timer = Mission(setup), Timer()
    mission.reset(0, np.array([episode]))
    mission.run(timed(create_policy(name), timer, 1))
    return 1000.0 * timer.cpu_s / max(1, timer.decisions)


def _time(setup: Setup, name: str) -> DecisionTime:
    agents = len(setup.fleet)
    try:
        _episode_ms(setup, name, EPISODES)  # compiles
        least = [
            min(_episode_ms(setup, name, episode) for _ in range(REPEATS))
            for episode in range(EPISODES)
        ]
    except UserError as error:
        return DecisionTime(name, agents, 0.0, 0.0, 0.0, str(error))
    return DecisionTime(name, agents, statistics.median(least), min(least), max(least))


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
            found.append(_time(setup, name))
    return found
