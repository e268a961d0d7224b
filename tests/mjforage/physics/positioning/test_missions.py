"""Missions with satellite positioning: consistent filters, slow touches."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from mjforage.graph_planner.policies import create_policy
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario_file import load_scenario


@pytest.mark.parametrize("policy", ["belief", "greedy"])
def test_filters_are_consistent_and_touches_slow_in_a_mission(policy: str) -> None:
    """Of each vessel the normalised innovations squared, and their sum, within the 95 % band.

    One of eight vessels may be outside.
    """
    setup = Setup.of(load_scenario("comb-port-gnss", ["horizon=60"]))
    mission = create_mission(setup, "physics")
    mission.reset(11, np.arange(2))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    surprise, measured = np.zeros((2, 4)), np.zeros((2, 4))
    inner = dynamics._locate

    def locate(active: Any) -> Any:
        nonlocal surprise, measured
        known, told = inner(active), dynamics._pilot._navigator.filters  # type: ignore[union-attr]
        surprise = surprise + told.surprise * active[:, None]
        measured = measured + told.measured * active[:, None]
        return known

    dynamics._locate = locate  # type: ignore[method-assign]
    log = EpisodeLog(mission)
    mission.run(create_policy(policy), (log,))
    low, high = (chi2.ppf(share, measured) for share in (0.025, 0.975))
    assert ((low < surprise) & (surprise < high)).sum() >= 7
    low, high = (chi2.ppf(share, measured.sum()) for share in (0.025, 0.975))
    assert low < surprise.sum() < high
    assert np.nanmax(log.impact) < 0.5
