"""Missions over a link, and what their owners know."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.link import Radio
from mjforage.mission.mission import Mission
from mjforage.mission.scoring import Scorer
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario

DISK = 'link.model="disk"'


def setup_of(*overrides: str) -> Setup:
    """The default mission, shorter, with other keys."""
    return Setup.of(load_scenario("comb-port", ["horizon=60", *overrides]))


def started(setup: Setup, episodes: int = 4, seed: int = 5) -> tuple[Mission, Radio]:
    """A mission over the scenario's link, and that."""
    mission = Mission(setup)
    mission.reset(seed, np.arange(episodes))
    assert isinstance(mission.exchange, Radio)
    return mission, mission.exchange


def advanced(mission: Mission, policy: str, steps: int) -> None:
    """Play some steps."""
    player = create_policy(policy)
    mission.prepare(player)
    for _ in range(steps):
        mission.advance(mission.ask(player))


def played(setup: Setup, policy: str, episodes: int = 3) -> dict[str, NDArray[Any]]:
    """What was logged of a whole mission."""
    mission = Mission(setup)
    mission.reset(5, np.arange(episodes))
    scorer = Scorer(mission)
    mission.run(create_policy(policy), (scorer,))
    log, names = scorer.log, ("agent_node", "direction", "t_discovered", "collected_by")
    return {name: np.array(getattr(log, name)) for name in names}
