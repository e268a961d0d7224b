"""Positioning models by their names, and what missions do with their measurements."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.randomness import UInt64Array, episode_keys
from mjforage.controllers.navigation import SensorErrors
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.positioning import POSITIONING, Measured, create_positioning
from mjforage.physics.worlds import WORLDS, create_mission
from mjforage.runs.identity import scenario_parts
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.sensors import Sensors

FloatArray = NDArray[np.float64]


class Shifted:
    """All measurements are off by a constant."""

    errors: SensorErrors | None = None

    def __init__(
        self,
        sensors: Sensors,
        shape: tuple[int, int],
        tick_s: float,
        east: float = 0.0,
        turn: float = 0.0,
        speed: float = 0.0,
    ) -> None:
        self._off, self._fix = np.array([east, 0.0, turn]), np.ones(shape, np.bool_)
        self._speed = np.array([speed, 0.0, 0.0])

    def reset(self, rows: NDArray[np.int64]) -> None:
        pass

    def measure(
        self, keys: UInt64Array, tick: NDArray[np.int64], pose: FloatArray, velocity: FloatArray
    ) -> Measured:
        return Measured(pose + self._off, velocity + self._speed, self._fix)


class Broken(Shifted):
    errors: Any = (1.0, 2.0)


@pytest.fixture(autouse=True)
def own() -> Iterator[None]:
    with POSITIONING.lent({"shifted": Shifted, "broken": Broken}):
        yield


def staying(positioning: str, *overrides: str, scenario: str = "open-bay") -> Mission:
    """Lone scouts in calm water that stay where they are for four decisions."""
    calm = ("weather.drift_node_per_step=0", "team.foragers.count=0", "team.scouts.count=1")
    named = f'sensors.positioning="{positioning}"'
    setup = Setup.of(load_scenario(scenario, ["items.mean=5", *calm, named, *overrides]))
    mission = create_mission(setup, "physics")
    mission.start(episode_keys(5, np.arange(3)))
    for _ in range(4):
        mission.advance(np.tile(np.eye(9)[STAY], (3, 1, 1)))
    return mission


def poses(mission: Mission) -> tuple[FloatArray, FloatArray]:
    """(episode, 3) where the vessels are, and (episode, 2) where they think that they stay."""
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    node = dynamics._graph.metres(np.rint(mission._state.agent_rc))
    return dynamics._motion.pose[:, 0], node[:, 0]


@pytest.mark.parametrize("east", [0.9, -0.9])
def test_vessels_steer_by_measured_positions(east: float) -> None:
    """One that thinks it is too far east keeps its place too far west."""
    mission = staying(f"shifted(east={east})")
    pose, node = poses(mission)
    assert np.abs(pose[:, 0] + east - node[:, 0]).max() < 0.35
    assert np.abs(pose[:, 1] - node[:, 1]).max() < 0.35
    true = mission.setup.graph.row_column(pose[:, :2])  # what the mission goes on from
    np.testing.assert_array_equal(mission.state.agent_rc[:, 0], true)


def test_vessels_steer_by_measured_velocities() -> None:
    mission = staying("shifted(speed=0.5)")
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    believed = dynamics._pilot._fleets.state["vx"][:, 0]
    assert np.abs(believed - 0.5 - dynamics._motion.velocity[:, 0, 0]).max() < 0.1


def test_vessels_steer_by_measured_headings() -> None:
    """A heading that is off by half a turn sends thrust the wrong way: it does not stay there."""
    right, wrong = staying("shifted"), staying(f"shifted(turn={math.pi:.3f}, east=0.9)")
    off = [np.hypot(*(pose[:, :2] - node).T).max() for pose, node in map(poses, (right, wrong))]
    assert off[0] < 0.35 < 2.0 < off[1]


def test_foragers_seek_items_where_cameras_saw_them_from_measured_positions() -> None:
    """Who thinks it is 0.9 m too far east takes them to be as far east, and goes for them there."""
    camera = ("camera_noise_m=1e-6", "camera_range_noise_per_m=0", "camera_fov_deg=360")
    own = ("sensors.camera_range_m=100", "physics.capture=intake", "team.foragers.count=1")
    frames = (*(f"sensors.{each}" for each in camera), *own, "team.scouts.count=0")
    mission = staying("shifted(east=0.9)", *frames, "items.covariance_node2=0.5")
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    true, state = dynamics._simulation.item_xy, dynamics._pilot._fleets.state
    ticks: Any = dynamics._playing
    off = ticks._known()[:, 0] - true
    np.testing.assert_allclose(np.nanmedian(off, axis=1), np.tile((0.9, 0.0), (3, 1)), atol=0.02)
    for name in ("item", "next"):
        for e in np.flatnonzero(np.isfinite(state[f"{name}_x"][:, 0])):
            goal = np.array([state[f"{name}_x"][e, 0], state[f"{name}_y"][e, 0]])
            nearest = (goal - true[e])[np.argmin(np.hypot(*(goal - (0.9, 0.0) - true[e]).T))]
            np.testing.assert_allclose(nearest, (0.9, 0.0), atol=0.1)
    assert np.isfinite(state["item_x"]).any() or np.isfinite(state["next_x"]).any()


def test_an_exact_filter_steers_as_well_as_exact_measurements() -> None:
    pose, node = poses(staying("gnss", "sensors.latency_s=0.3"))
    assert np.hypot(*(pose[:, :2] - node).T).max() < 0.35


def test_margins_come_from_the_filters_covariance() -> None:
    mission = staying("gnss", "sensors.position_wander_m=0.5")
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics) and dynamics._pilot._navigator is not None
    told, state = dynamics._pilot._navigator.filters, dynamics._pilot._fleets.state
    of_each = np.sqrt(np.linalg.eigvalsh(told.covariance[:, 0, :2, :2])[:, -1])
    assert state["margin"][:, 0] == pytest.approx(3.5 * of_each) and (of_each > 0.1).all()
    assert np.abs(told.pose[..., 0] - state["x"]).max() < 1e-9  # as it is, no second filter
    exact = staying("white")._dynamics
    assert isinstance(exact, MujocoDynamics) and exact._pilot._navigator is None
    assert (exact._pilot._fleets.state["margin"] == 0.0).all()


def test_the_filter_can_be_left_out() -> None:
    keys = {"positioning": "gnss", "position_wander_m": 1.0}
    for used in (True, False):
        sensors = Sensors(**keys, filter=used)  # type: ignore[arg-type]
        assert (create_positioning(sensors, (1, 1), 0.1).errors is not None) == used


BAD = [
    ("gns", "positioning gns: unknown; did you mean gnss"),
    ("shifted(west=1)", "positioning shifted: .*west"),
    ("broken", "positioning broken: errors is no SensorErrors; give one, or None"),
    ("own_code:Sensors", "names positioning own_code:Sensors, code that neither ships .*--trust"),
]


@pytest.mark.parametrize(("name", "words"), BAD)
def test_names_that_do_not_fit_are_refused(name: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        create_positioning(Sensors(positioning=name), (1, 1), 0.1)


def test_a_mission_names_what_does_not_fit_before_it_starts() -> None:
    setup = Setup.of(load_scenario("comb-port-gnss", ["sensors.latency_s=0.25"]))
    with pytest.raises(UserError, match=r"latency_s = 0.25: give a multiple"):
        create_mission(setup, "physics")


def test_code_of_a_model_is_part_of_a_runs_identity() -> None:
    scenario = load_scenario("comb-port-gnss", ["sensors.positioning=shifted"])
    assert scenario_parts(scenario) == (Shifted,)
    assert scenario_parts(load_scenario("comb-port-weather")) == ()


def test_worlds_below_physics_have_exact_sensors() -> None:
    scenario = load_scenario("comb-port-gnss")
    exact = WORLDS["intake"].adapt(scenario).sensors
    assert exact == replace(load_scenario("comb-port").sensors, detection=0.95, camera_fov_deg=360)


def test_the_estimate_chooses_items_where_there_is_a_filter() -> None:
    setup = Setup.of(load_scenario("comb-port-gnss", ["horizon=3"]))
    mission = create_mission(setup, "physics")
    mission.start(episode_keys(5, np.arange(2)))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    ticks: Any = dynamics._playing
    known = ticks._locate(np.ones(2, np.bool_))
    assert (known.seeking == known.pose).all()
    assert (np.abs(known.pose - dynamics._motion.pose)[..., :2] > 0.0).all()
