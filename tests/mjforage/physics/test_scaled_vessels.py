"""Vessels with a scenario's factors: the numbers that change, and that controllers do not know."""

from dataclasses import asdict, fields, replace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.mission.setup import Setup
from mjforage.physics.callback.vessel_motion import Surroundings, damping
from mjforage.physics.dynamics import mujoco_dynamics
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.scaled_vessels import deviations, scaled
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Integrator, Simulation
from mjforage.physics.vessels import ForceThruster, Vessel, load_vessel
from mjforage.physics.worlds import create_mission
from mjforage.scenario.scenario import Scale, Spread
from mjforage.scenario.scenario_file import (
    load_scenario,
    with_values,
)
from mjforage.scenario.vessel_files import vessel_names

AXES = ("surge", "sway", "yaw")
CHANGED = {
    "mass": {"mass_kg", "inertia_z_kgm2"},
    "added_mass": {f"added_mass_{axis}" for axis in ("surge_kg", "sway_kg", "yaw_kgm2")},
    "drag": {f"{part}_{axis}" for part in ("linear", "quadratic") for axis in AXES}
    | {"crossflow.coefficient"},
    "thrust": {
        *("thruster.k_ahead", "thruster.k_astern"),
        *("thruster.max_ahead_newton", "thruster.max_astern_newton"),
    },
    "windage": {"windage.area_front_m2", "windage.area_side_m2"},
}


def numbers(vessel: Vessel) -> dict[str, float]:
    """Every number of a vessel by its key."""
    found: dict[str, float] = {}
    for key, value in asdict(vessel).items():
        inside = value.items() if isinstance(value, dict) else [("", value)]
        for name, number in inside:
            if isinstance(number, float):
                found[f"{key}.{name}" if name else key] = number
    return found


@pytest.mark.parametrize("name", vessel_names())
def test_factors_of_one_are_the_vessel_to_the_bit(name: str) -> None:
    vessel = load_vessel(name)
    assert scaled(vessel, Scale()) == vessel
    assert repr(scaled(vessel, Scale())) == repr(vessel)


@pytest.mark.parametrize("name", vessel_names())
@pytest.mark.parametrize("key", [one.name for one in fields(Scale)])
def test_a_factor_changes_its_numbers_and_no_others(name: str, key: str) -> None:
    vessel, factor = load_vessel(name), 0.9
    before, after = numbers(vessel), numbers(scaled(vessel, replace(Scale(), **{key: factor})))
    for number, value in before.items():
        expected = factor * value if number in CHANGED[key] else value
        assert after[number] == pytest.approx(expected, rel=1e-12), number


def spied(monkeypatch: pytest.MonkeyPatch, scale: dict[str, float]) -> dict[str, list[Any]]:
    """What the MuJoCo world is built of, and what its controllers are told."""
    heard: dict[str, list[Any]] = {"fleet_scene": [], "vessel_model": [], "pack_fleet": []}
    for name, found in heard.items():
        original = getattr(mujoco_dynamics, name)

        def spy(*given: Any, original: Any = original, found: list[Any] = found) -> Any:
            found.append(original(*given))
            return found[-1]

        monkeypatch.setattr(mujoco_dynamics, name, spy)
    values = {f"physics.scale.{key}": value for key, value in scale.items()}
    create_mission(Setup.of(with_values(load_scenario("comb-port"), values, "")), "physics")
    return heard


def test_vessels_in_mujoco_are_scaled_and_their_controllers_do_not_know(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plain = spied(monkeypatch, {})
    monkeypatch.undo()
    heavy = spied(monkeypatch, {"mass": 1.2, "drag": 1.3})
    for team, mass in (("scouts", 36.0), ("foragers", 80.0)):
        names = [name for name in heavy["fleet_scene"][0].names if name.startswith(team[:-1])]
        assert names
        for name in names:
            body = heavy["fleet_scene"][0].model.body(f"{name}/hull")
            assert body.mass[0] == pytest.approx(1.2 * mass)
    assert heavy["pack_fleet"][0]["mass"] == pytest.approx(1.2 * plain["pack_fleet"][0]["mass"])
    drag = [one["pack_fleet"][0]["linear_sway"] for one in (plain, heavy)]
    assert drag[1] == pytest.approx(1.3 * drag[0])
    assert heavy["vessel_model"] == plain["vessel_model"]


@pytest.mark.parametrize("integrator", list(Integrator))
@pytest.mark.parametrize("part", ["mass", "drag", "thrust"])
def test_a_deviation_moves_a_vessel_as_one_of_such_a_scale(
    part: str, integrator: Integrator
) -> None:
    """An Otter that feels wind and items turns and is stopped, laden: items keep their numbers."""
    forager, poses = load_vessel("forager"), []
    otter = replace(load_vessel("otter"), windage=forager.windage, load=forager.load)
    for factor, deviation in ((0.8, 0.0), (1.0, -0.2), (1.0, 0.0)):
        vessel = scaled(otter, replace(Scale(), **{part: factor}))
        simulation = Simulation(build_scene([vessel]), integrator=integrator)
        simulation.spread[..., ("mass", "drag", "thrust").index(part)] = deviation
        simulation.vessel_wind[:], simulation.load[:] = (4.0, 2.0), 6.0
        for command in ((80.0, 30.0), (-40.0, 20.0)):
            simulation.commands[:] = command
            simulation.step(round(8.0 / simulation.step_s))
        poses.append(simulation.vessel_pose[0, 0])
    np.testing.assert_allclose(poses[0], poses[1], rtol=1e-9)
    assert abs(poses[0] - poses[2]).max() > 0.1


@pytest.mark.parametrize("name", vessel_names())
def test_a_factor_on_drag_damps_in_contacts_as_a_scale(name: str) -> None:
    vessel, still = load_vessel(name), Surroundings(0.0, 0.0, 0.3, 0.1, 5.0, 1.0, 1.0, 1.0, 1.0)
    known, other = pack(scaled(vessel, Scale(drag=1.3))), pack(vessel)
    way, lagged = (0.4, 0.9, -0.6, 0.3), (0.5, 0.2)
    found = damping(other, *way, lagged, still._replace(drag=1.3))
    assert found == pytest.approx(damping(known, *way, lagged, still), rel=1e-12)


def test_episodes_draw_deviations_of_their_own_in_any_company() -> None:
    keys, spread = episode_keys(4, np.arange(3000)), Spread(mass=0.2, thrust=0.3)
    drawn = deviations(spread, 4, keys)
    np.testing.assert_array_equal(drawn[7:9], deviations(spread, 4, keys[7:9]))
    assert not drawn[..., 1].any()
    for part, most in ((0, 0.2), (2, 0.3)):
        flat = drawn[..., part].ravel()
        assert stats.kstest(flat, stats.uniform(-most, 2.0 * most).cdf).pvalue > 0.01
        assert abs(np.corrcoef(drawn[..., part].T) - np.eye(4)).max() < 0.08
    assert abs(np.corrcoef(drawn[..., 0].ravel(), drawn[..., 2].ravel())[0, 1]) < 0.04


def test_missions_draw_anew_with_every_episode() -> None:
    scenario = load_scenario("comb-port", ["physics.spread.drag=0.4"])
    mission = create_mission(Setup.of(scenario), "physics")
    dynamics, keys = mission._dynamics, episode_keys(2, np.arange(3))
    assert isinstance(dynamics, mujoco_dynamics.MujocoDynamics)
    mission.start(keys[:2])
    given = deviations(scenario.physics.spread, 4, keys)
    np.testing.assert_array_equal(dynamics._simulation.spread, given[:2])
    mission.restart(np.array([1]), keys[2:])
    np.testing.assert_array_equal(dynamics._simulation.spread, given[[0, 2]])


def test_a_thrust_below_the_dead_zone_is_refused() -> None:
    """The scout has 19.9 N astern, of which 0.7 are 13.93."""
    vessel = load_vessel("scout")
    assert isinstance(vessel.thruster, ForceThruster)
    numb = replace(vessel, thruster=replace(vessel.thruster, dead_zone_newton=15.0))
    with pytest.raises(UserError, match=r"vessel scout with physics.scale: thruster.dead_zone"):
        scaled(numb, Scale(thrust=0.7))
