"""When thrusters fail, by given and drawn times, and which thrust of which vessel does."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.policies.registry import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.faults import failures
from mjforage.physics.dynamics.mujoco_dynamics import MujocoDynamics
from mjforage.scenario.scenario_file import load_scenario

KEYS = episode_keys(4, np.arange(3))


def setup_of(*overrides: str) -> Setup:
    return Setup.of(load_scenario("comb-port", overrides))


def test_losses_by_time_vessel_and_side() -> None:
    about = ("team=foragers", "vessel=1", "side=starboard", "from_s=20", "left=0.7")
    setup = setup_of(*(f"faults.{key}" for key in about))
    found = failures(setup.scenario.faults, setup.fleet, KEYS)
    assert found is not None
    losses = found.losses(np.array([0.0, 19.9, 20.0]))
    expected = np.zeros((3, 4, 2))
    expected[2, 3, 1] = 0.3
    np.testing.assert_allclose(losses, expected)
    setup = setup_of("faults.team=scouts", "faults.side=both")
    both = failures(setup.scenario.faults, setup.fleet, KEYS)
    assert both is not None
    losses = both.losses(np.zeros(3))
    assert (losses[:, 0] == 1.0).all() and (losses[:, 1:] == 0.0).all()


def test_without_a_table_there_is_nothing_to_look_up() -> None:
    setup = setup_of()
    assert failures(setup.scenario.faults, setup.fleet, KEYS) is None


def test_drawn_times_have_their_rate_and_belong_to_the_episode() -> None:
    """Exponential: mean and standard deviation 1 / rate, sides and vessels independent."""
    setup = setup_of("faults.rate_per_h=2", "faults.left=0.4")
    keys = episode_keys(8, np.arange(2000))
    found = failures(setup.scenario.faults, setup.fleet, keys)
    assert found is not None
    times = found.from_s
    assert times.mean() == pytest.approx(1800.0, rel=0.03)
    assert times.std() == pytest.approx(1800.0, rel=0.05)
    correlation = np.corrcoef(times.reshape(2000, 8).T) - np.eye(8)
    assert np.abs(correlation).max() < 0.1
    alone = failures(setup.scenario.faults, setup.fleet, keys[7:8])
    assert alone is not None and np.array_equal(alone.from_s[0], times[7])
    assert found.losses(np.full(2000, 1e9)) == pytest.approx(0.6)


def test_rows_that_restart_have_the_faults_of_their_episodes() -> None:
    """After one decision the losses in the simulation are those of each row's own time."""
    setup = setup_of("faults.rate_per_h=200")
    dynamics = MujocoDynamics(setup.graph, setup.fleet, setup.scenario)
    mission = Mission(setup, dynamics)
    mission.reset(4, np.arange(3))
    stay = np.zeros((3, 4, 9))
    for _ in range(3):
        mission.advance(stay)
    fresh = episode_keys(4, np.array([9]))
    mission.restart(np.array([1]), fresh)
    mission.advance(stay)
    found = failures(setup.scenario.faults, setup.fleet, np.array([KEYS[0], fresh[0], KEYS[2]]))
    assert found is not None
    now = np.array([39.5, 9.5, 39.5])  # last time that wind, water and faults were looked up
    expected = found.losses(now)
    assert 0 < expected.sum() < expected.size
    np.testing.assert_array_equal(dynamics._simulation.thrust_loss, expected)


def test_before_its_time_a_fault_changes_no_bit_and_then_one_vessel() -> None:
    tracks = []
    for overrides in ([], ["faults.team=foragers", "faults.from_s=20", "faults.noticed=false"]):
        setup = setup_of(*overrides)
        mission = Mission(setup, MujocoDynamics(setup.graph, setup.fleet, setup.scenario))
        mission.reset(4, np.arange(1))
        rc = []
        for decision in range(3):
            mission.advance(np.random.default_rng(decision).random((1, 4, 9)))
            rc.append(mission.state.agent_rc[0].copy())
        tracks.append(np.array(rc))
    healthy, faulty = tracks
    assert np.array_equal(healthy[:2], faulty[:2])
    off = np.hypot(*np.moveaxis(faulty[2] - healthy[2], -1, 0))
    assert off[2] > 0.2 and np.delete(off, 2).max() < 0.02


def noticed(preset: str, decisions: int, *overrides: str) -> tuple[Mission, NDArray[np.float64]]:
    """A mission of `belief` after some decisions, and the losses that pilots counted with."""
    setup = Setup.of(load_scenario(preset, overrides))
    dynamics = MujocoDynamics(setup.graph, setup.fleet, setup.scenario)
    mission, policy = Mission(setup, dynamics), create_policy("belief")
    mission.reset(12, np.arange(4))
    mission.prepare(policy)
    state, most = dynamics._pilot._fleets.state, np.zeros((4, 4, 2))
    for _ in range(decisions):
        mission.advance(mission.ask(policy))
        now = np.stack((state["port_loss"], state["starboard_loss"]), axis=-1)
        np.maximum(most, now, out=most)
    return mission, most


@pytest.mark.parametrize("preset", ["comb-port", "comb-port-wind-8", "comb-port-gnss"])
def test_healthy_missions_notice_no_fault(preset: str) -> None:
    mission, most = noticed(preset, 60, "faults.team=scouts", "faults.from_s=1e9")
    assert most.max() == 0.0
    assert np.isinf(mission.observation.energy_left).all()


def test_the_vessel_that_failed_is_known_to_have_no_range_and_the_other_takes_over() -> None:
    mission, most = noticed("comb-port", 60, "faults.team=foragers", "faults.vessel=1")
    assert (most[:, 3, 0] > 0.5).all() and np.delete(most.reshape(4, 8), 6, axis=1).max() == 0.0
    assert (mission.observation.energy_left[:, 3] == 0.0).all()
    assert np.isinf(mission.observation.energy_left[:, :3]).all()
    assert (mission.taken[:, 2] > 3 * mission.taken[:, 3]).all()


def test_who_is_lame_is_told_of_its_own_episode_alone() -> None:
    setup = setup_of()
    dynamics = MujocoDynamics(setup.graph, setup.fleet, setup.scenario)
    mission = Mission(setup, dynamics)
    mission.reset(4, np.arange(3))
    dynamics._pilot._fleets.state["starboard_loss"][1, 2] = 0.9
    mission.advance(np.zeros((3, 4, 9)))
    assert np.argwhere(mission.state.disabled).tolist() == [[1, 2]]
