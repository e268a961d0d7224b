"""Missions with satellite positioning: consistent filters, slow touches."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2

from mjforage.base.registry import trust
from mjforage.controllers.navigation import SensorErrors
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.episode_log import EpisodeLog
from mjforage.mission.moves import Moves
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.positioning import Measured
from mjforage.physics.worlds import create_mission
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Items, MapChoice, Physics, Weather
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.sensors import Sensors
from tests.mjforage.mission.by_hand import by_hand
from tests.mjforage.physics.validation.mission_checks import KEYS

FloatArray = NDArray[np.float64]


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
    ticks: Any = dynamics._playing
    inner = ticks._locate

    def locate(active: Any) -> Any:
        nonlocal surprise, measured
        known, told = inner(active), dynamics._pilot._navigator.filters  # type: ignore[union-attr]
        surprise = surprise + told.surprise * active[:, None]
        measured = measured + told.measured * active[:, None]
        return known

    ticks._locate = locate
    log = EpisodeLog(mission)
    mission.run(create_policy(policy), (log,))
    low, high = (chi2.ppf(share, measured) for share in (0.025, 0.975))
    assert ((low < surprise) & (surprise < high)).sum() >= 7
    low, high = (chi2.ppf(share, measured.sum()) for share in (0.025, 0.975))
    assert low < surprise.sum() < high
    assert np.nanmax(log.impact) < 0.5


class Shifted:
    """A receiver whose fixes are off by the same way, which its filter takes for a slow error."""

    def __init__(
        self, sensors: Sensors, shape: tuple[int, int], tick_s: float, off_m: float
    ) -> None:
        self.errors: SensorErrors | None = SensorErrors(
            0.02, 0.17, 60.0, 0.01, np.radians(1.0), 0.01, 0, tick_s
        )
        self._off, self._fix = np.array([off_m, -off_m, 0.0]), np.ones(shape, np.bool_)

    def reset(self, rows: Any = None) -> None:
        """Nothing is kept."""

    def measure(self, keys: Any, tick: Any, pose: FloatArray, velocity: FloatArray) -> Measured:
        return Measured(pose + self._off, velocity, self._fix)


@pytest.mark.parametrize("off_m", [0.0, 0.35])
def test_an_item_in_a_corner_is_collected_though_fixes_are_off_towards_it(off_m: float) -> None:
    """By the chart the item would lie on land: that tells by how much the fixes are off."""
    name = f"{__name__}:Shifted(off_m={off_m})"
    trust(f"{__name__}:Shifted")
    role = Role(count=1, moves=1, radius=1.0, collects=True)
    setup = by_hand(
        np.ones((2, 2), np.bool_),
        map=MapChoice("pool", pitch_m=4.0, starts=((1, 1),)),
        team={"foragers": role},
        items=Items(mean=1, std=0.0),
        weather=Weather(drift_node_per_step=0.0, noise_node_per_step=0.0),
        physics=Physics(capture="intake"),
        sensors=Sensors(positioning=name, camera_noise_m=0.1),
    )
    dynamics, keys = MujocoDynamics(setup.graph, setup.fleet, setup.scenario), KEYS[:1]
    initial = setup.create_initial_state(keys)
    corner = np.full((1, 1), setup.graph.node_of_cell[1, 1], np.int32)
    initial = replace(initial, item_rc=np.full((1, 1, 2), 1.475), item_node=corner)
    state, still = dynamics.reset(initial, keys, ["0"]), np.zeros((1, 1), np.int8)
    for step in range(1, 9):
        moves = Moves(still + np.int8(STAY), corner, still, still > 0)
        dynamics.advance(np.ones(1, np.bool_), np.full(1, step, np.int32), moves)
    assert state.collected_by[0, 0] == 0
