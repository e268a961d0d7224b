"""Missions of a few decisions: every hull has its own orders, thrusters, water, watch and time."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.graph_planner.graph.navigation import COMPASS, STAY
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.dynamics import BLOCKED, LATE
from mjforage.mission.mission import Mission
from mjforage.mission.moves import Moves
from mjforage.mission.task import IDLE
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.physics.hydrodynamics.parameters import pack_fleet
from mjforage.physics.hydrodynamics.power import drawn_power
from mjforage.physics.scaled_vessels import scaled
from mjforage.physics.vessels import load_vessel
from mjforage.physics.worlds import create_mission
from mjforage.scenario.roles import Role
from mjforage.scenario.scenario import Physics, Scale, Weather
from tests.mjforage.physics.dynamics.test_mujoco_dynamics import setup_of
from tests.mjforage.physics.validation.mission_checks import (
    FLEET,
    KEYS,
    PITCH_M,
    QUAY,
    WEST,
    advance,
    begun,
)

OWN = {name: name for name in FLEET}  # vessels of the teams
CALM = Weather(drift_node_per_step=0.0, noise_node_per_step=0.0)
STREAM = Weather(
    drift_node_per_step=0.0,
    noise_node_per_step=0.0,
    current_speed_mps=0.4,
    current_to_deg=90.0,
)


def mission_of(preset: str, *overrides: str) -> tuple[Mission, MujocoDynamics]:
    """Two episodes of a mission of hulls."""
    mission = create_mission(setup_of(preset, *overrides), "physics")
    mission.reset(3, np.arange(2))
    dynamics = mission._dynamics
    assert isinstance(dynamics, MujocoDynamics)
    return mission, dynamics


def test_pilots_are_told_where_a_move_begins_and_where_it_ends() -> None:
    mission, dynamics = mission_of("open-bay", "horizon=3")
    for word in ("N", "SE"):
        begin = dynamics._graph.metres(np.rint(mission.state.agent_rc))
        mission.advance(np.tile(np.eye(9)[COMPASS.index(word)], (2, 4, 1)))
        assert mission.moves is not None
        end = dynamics._centres_xy[mission.moves.target]
        told = dynamics._pilot._fleets.state
        for axis, name in enumerate("xy"):
            np.testing.assert_array_equal(told[f"origin_{name}"], begin[..., axis])
            np.testing.assert_array_equal(told[f"target_{name}"], end[..., axis])
        assert np.abs(end - begin).max(axis=-1).min() > 3.0


@pytest.mark.parametrize("scale", [Scale(), Scale(thrust=0.7)])
def test_hulls_draw_power_for_their_own_thrusters(scale: Scale) -> None:
    """The scout's thrusters stand still, the forager's push it ahead and about, in a current."""
    dynamics, state = begun(STREAM, physics=Physics(vessels=OWN, scale=scale))
    commands = np.zeros((len(KEYS), 2, 2))
    commands[:, 1] = [(40.0, 70.0), (60.0, 30.0)]
    dynamics._pilot.command = lambda *_: commands  # type: ignore[method-assign]
    vessels: Any = pack_fleet([scaled(load_vessel(name), scale) for name in FLEET])
    ticks: Any = dynamics._playing
    work, inner = np.zeros((len(KEYS), 2)), ticks._steer
    thrusters = dynamics._simulation.thruster_state

    def steer(*about: Any) -> None:
        inner(*about)
        for at in np.ndindex(work.shape):
            work[at] += 0.1 * drawn_power(vessels[at[1]], *thrusters[at])

    ticks._steer = steer
    advance(dynamics, state)
    np.testing.assert_allclose(dynamics._simulation.vessel_water[..., 0], 0.4, atol=0.01)
    np.testing.assert_allclose(state.work, work, rtol=1e-9)
    power = load_vessel("scout").power
    assert power is not None
    np.testing.assert_allclose(state.work[:, 0], 20.0 * power.hotel_w)
    assert (state.work[:, 1] > 2.0 * state.work[:, 0]).all() and np.ptp(state.work[:, 1]) > 100.0


def test_hulls_move_by_the_scenarios_factors() -> None:
    """Twice the windage takes them farther before the wind, at most twice as far."""
    ways = []
    for scale in (Scale(), Scale(windage=2.0)):
        dynamics, state = begun(WEST, physics=Physics(vessels=OWN, scale=scale))
        advance(dynamics, state)
        ways.append(state.distance.copy())
    assert (ways[1] > 1.3 * ways[0]).all() and (ways[1] < 2.0 * ways[0]).all()


@pytest.mark.parametrize("hull", [0, 1])
def test_who_gives_way_is_blocked_and_nobody_else(hull: int) -> None:
    """Both lie still beside where they are sent; pilots say which one lets others pass."""
    dynamics, state = begun(CALM)
    way = np.zeros((len(KEYS), 2), np.bool_)
    way[:, hull] = True
    kind = type(dynamics._pilot)
    dynamics._pilot.__class__ = type("Waiting", (kind,), {"giving_way": way})
    dynamics.place(dynamics._motion.pose + np.array([3.0, 0.0, 0.0]))
    advance(dynamics, state)
    np.testing.assert_array_equal(state.outcome, np.where(way, BLOCKED, LATE))


@pytest.mark.parametrize("hull", [0, 1])
def test_who_has_no_legal_move_is_blocked_and_nobody_else(hull: int) -> None:
    dynamics, state = begun(WEST)
    no_move = np.zeros((len(KEYS), 2), np.bool_)
    no_move[:, hull] = True
    advance(dynamics, state, no_move)
    np.testing.assert_array_equal(state.outcome, np.where(no_move, BLOCKED, LATE))


def test_an_episode_that_is_over_stays_as_it_is() -> None:
    """Its hulls, items, clock and what it tells, also items that would have to part."""
    mission, dynamics = mission_of("comb-port-weather", "horizon=20")
    policy, state, simulation = create_policy("greedy"), dynamics._state, dynamics._simulation
    mission.prepare(policy)
    for _ in range(20):
        mission.advance(mission.ask(policy))
        if (state.pickup[1] != IDLE).any():
            break
    simulation._afloat.q[:, :2] = simulation._afloat.q[:, :1]
    simulation.item_class[:, :2] = 0

    def arrays() -> list[NDArray[Any]]:
        parts = (*state, dynamics._tick, dynamics._room_left, *dynamics._period, *dynamics._motion)
        return [np.array(part[1]) for part in (*parts, simulation.item_xy, simulation.time_s)]

    before = arrays()
    moves = Moves(
        np.full(state.agent_node.shape, STAY, np.int8),
        state.agent_node.copy(),
        np.zeros(state.agent_node.shape, np.int8),
        np.zeros(state.agent_node.shape, np.bool_),
    )
    for step in (21, 22):
        dynamics.advance(np.array([True, False]), np.full(2, step, np.int32), moves)
    assert (state.pickup[1] != IDLE).any() and dynamics._tick[0] > dynamics._tick[1]
    for one, other in zip(before, arrays(), strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("full", [False, True])
def test_what_was_given_up_is_left_for_seconds_and_who_is_full_seeks_nothing(full: bool) -> None:
    """All items are left until 25 s have passed: in the first two decisions none is sought."""
    mission, dynamics = mission_of("comb-port-weather", "sensors.camera_noise_m=0", "horizon=9")
    policy, sought = create_policy("greedy"), []
    mission.prepare(policy)
    if full:
        dynamics._room_left[:] = 0
    else:
        dynamics._attempts.later_s[:] = 25.0
    for _ in range(9):
        mission.advance(mission.ask(policy))
        state = dynamics._pilot._fleets.state
        sought.append(np.isfinite(state["item_x"]).any() or np.isfinite(state["next_x"]).any())
    assert sought[:2] == [False, False] and any(sought[2:]) != full


def test_a_mouth_takes_its_items_by_seconds() -> None:
    """One in 5 s of the five that lie in it: after 0.1, 5.1, 10.1 and 15.1 s."""
    mouth = Physics(vessels=OWN, capture="intake", intake_rate_per_s=0.2)
    team = {name: Role(1, 1, 1.0, collects=name == "forager") for name in FLEET}
    dynamics, state = begun(CALM, physics=mouth, team=team)
    bow = dynamics._motion.pose[:, 1:, :2] + (0.5 * load_vessel("forager").length_m + 0.11, 0.0)
    xy = dynamics._simulation.item_xy
    xy[:, :5] = bow + np.array([(0.0, 0.2 * k - 0.4) for k in range(5)])
    dynamics._simulation.place_items(xy, 0)
    advance(dynamics, state)
    assert (state.collected_by == 1).sum(axis=1).tolist() == [4, 4]


def test_what_cameras_saw_drifts_on_until_it_is_used() -> None:
    """Frames are 2 s old, in which a wind of 8 m/s carries an item half a metre."""
    frames = ("noise_m=0.1", "range_noise_per_m=0", "fov_deg=360", "range_m=100", "latency_s=2")
    camera = (f"sensors.camera_{each}" for each in frames)
    wind = ("weather.wind_speed_mps=8", "weather.noise_node_per_step=0", "physics.capture=intake")
    team = ("team.scouts.count=0", "items.mean=20")
    mission, dynamics = mission_of("open-bay", *camera, *wind, *team, "horizon=5")
    for _ in range(4):
        mission.advance(np.tile(np.eye(9)[STAY], (2, 2, 1)))
    ticks: Any = dynamics._playing
    off = ticks._known() - dynamics._simulation.item_xy[:, None]
    assert np.nanmedian(np.abs(off)) < 0.05


@pytest.mark.parametrize("part", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_hulls_that_a_current_carries_into_a_quay_and_each_other_strike_as_fast_as_they_go(
    part: float,
) -> None:
    """In whichever part of a time step: bow on, and in the other episode one at one that lies."""
    dynamics, state = begun(replace(STREAM, current_speed_mps=0.8), physics=Physics(vessels=OWN))
    quay = dynamics._graph.metres(np.array(QUAY, np.float64)) - (0.5 * PITCH_M, 0.0)
    pose, velocity = np.zeros((2, len(KEYS), 2, 3))
    half = [0.5 * load_vessel(name).length_m for name in FLEET]
    for v, length in enumerate(half):
        pose[0, v, :2] = quay - (length + 0.08 * (3.0 + part), 2.0 - 4.0 * v)
    velocity[0, :, 0] = velocity[1, 0, 0] = 0.8
    pose[1, 1, :2] = quay - (half[1] + 1e-3, 0.0)  # it lies at the quay
    pose[1, 0, :2] = pose[1, 1, :2] - (sum(half) + 0.08 * (3.0 + part), 0.0)
    dynamics._simulation.place_vessels(pose, velocity)
    ticks: Any = dynamics._playing
    ticks.motion = ticks.motion._replace(pose=pose, velocity=velocity)
    inner, speeds = ticks._steer, [velocity[..., 0]]

    def steer(*about: Any) -> None:
        inner(*about)
        speeds.append(ticks.motion.velocity[..., 0])

    ticks._steer = steer
    impact, told = advance(dynamics, state), np.array(speeds)
    for e, v in ((0, 0), (0, 1), (1, 0)):
        of = told[:, e, v]
        last = of[np.argmax(of[1:] < 0.9 * of[:-1])]
        assert last > 0.6 and impact[e, v] == pytest.approx(last, rel=0.02)
