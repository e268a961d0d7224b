"""From vessels to models, and tunings for vessels that bring none."""

import dataclasses
import math

import numpy as np
import pytest

from mjforage.controllers.propulsion import thrust_under_way
from mjforage.physics.vessel_models import decision_s, default_control, top_speed, vessel_model
from mjforage.physics.vessels import (
    CrossFlow,
    ForceThruster,
    Power,
    Vessel,
    Windage,
    load_vessel,
)
from mjforage.scenario.vessel_files import vessel_names
from tests.controllers.plant import beam_gusts, sail

YAWS = np.linspace(-np.pi, np.pi, 7)[:-1]

WORKBOAT = Vessel(
    name="otter",  # for its looks
    description="a workboat of 6 m",
    length_m=6.0,
    beam_m=2.4,
    draft_m=0.5,
    mass_kg=1800.0,
    cog_x_m=0.2,
    inertia_z_kgm2=5500.0,
    added_mass_surge_kg=120.0,
    added_mass_sway_kg=1500.0,
    added_mass_yaw_kgm2=3000.0,
    linear_surge=150.0,
    linear_sway=900.0,
    linear_yaw=3000.0,
    quadratic_surge=120.0,
    quadratic_sway=0.0,
    quadratic_yaw=2000.0,
    yaw_linear_growth=0.0,
    lever_m=0.9,
    lag_s=0.4,
    thruster=ForceThruster(1200.0, 800.0, 10.0),
    crossflow=CrossFlow("integrated", 0.9, 0.5, 6.0, 1025.0),
    windage=Windage(2.5, 5.0, 0.9, 0.55, 0.6, 0.6, 0.0),
    power=Power(0.4, 4000.0, 50.0),
)


NUMBERS = {
    "length_m": 6.0,
    "beam_m": 2.4,
    "lever_m": 0.9,
    "lag_s": 0.4,
    "mass_surge_kg": 1920.0,
    "mass_sway_kg": 3300.0,
    "inertia_yaw_kgm2": 8500.0,
    "munk_kg": 1380.0,
    "offset_kgm": 360.0,
    "linear_surge": 150.0,
    "linear_sway": 900.0,
    "linear_yaw": 3000.0,
    "quadratic_surge": 120.0,
    "command_low": -800.0,
    "command_high": 1200.0,
    "exponent": 1.0,
    "dead_zone": 10.0,
    "disc_kgpm": 2050.0 * np.pi * 0.04,
    "k_ahead": 1.0,
    "k_astern": 1.0,
}


def test_numbers_of_a_propeller_and_of_a_force() -> None:
    otter, scout = vessel_model(load_vessel("otter")), vessel_model(load_vessel("scout"))
    assert (otter.mass_surge_kg, otter.mass_sway_kg) == (80.0 + 5.28, 80.0 + 82.5)
    assert otter.inertia_yaw_kgm2 == pytest.approx(16.01 + 24.03)
    assert otter.munk_kg == pytest.approx(82.5 - 5.28)
    assert (otter.exponent, otter.k_ahead, otter.dead_zone) == (2.0, 0.01108, 0.0)
    assert (scout.exponent, scout.k_ahead, scout.dead_zone) == (1.0, 1.0, 1.0)
    assert (scout.command_low, scout.command_high) == (-19.9, 33.6)


def test_controllers_know_every_number_of_a_vessel() -> None:
    """Of a vessel whose numbers are unlike, all that does not follow from several, by its name."""
    known = dataclasses.asdict(vessel_model(WORKBOAT))
    assert {name: known[name] for name in NUMBERS} == pytest.approx(NUMBERS)
    otter = vessel_model(load_vessel("otter"))
    assert (otter.k_ahead, otter.k_astern) == (0.01108, 0.006445)


def test_a_decision_takes_a_quarter_turn_and_the_way() -> None:
    tuning = vessel_model(WORKBOAT).tuning
    quarter = np.radians(90.0) / tuning.yaw_rate_radps
    assert decision_s(WORKBOAT, 1e-12) == pytest.approx(quarter, rel=1e-4)
    farther = decision_s(WORKBOAT, 400.0) - decision_s(WORKBOAT, 300.0)
    assert farther == pytest.approx(100.0 / tuning.cruise_ahead_mps)


def test_the_table_of_a_vessel_is_its_tuning() -> None:
    scout = load_vessel("scout")
    assert scout.control is not None
    assert dataclasses.asdict(vessel_model(scout).tuning) == dataclasses.asdict(scout.control)


@pytest.mark.parametrize("name", vessel_names())
def test_default_tunings_can_be_done(name: str) -> None:
    """At cruise speed drag takes 90 % of the thrust; braking needs less than there is."""
    vessel = load_vessel(name)
    control, (low, high) = default_control(vessel), vessel.thruster.thrust_range
    u, surge = control.cruise_ahead_mps, vessel.mass_kg + vessel.added_mass_surge_kg
    disc = vessel.power.disc_kgpm if vessel.power else 0.0
    thrust = 1.8 * thrust_under_way(high, u, disc)
    assert (vessel.linear_surge + vessel.quadratic_surge * u) * u == pytest.approx(thrust)
    assert control.brake_mps2 * surge == pytest.approx(0.7 * -2.0 * low)
    r, model = control.yaw_rate_radps, vessel_model(vessel)
    drag = (model.linear_yaw + model.quadratic_yaw * r) * r
    thrust = thrust_under_way(min(high, -low), vessel.lever_m * r, disc)
    assert drag == pytest.approx(0.9 * vessel.lever_m * 2.0 * thrust)


def test_top_speeds_are_those_of_the_thrust_under_way() -> None:
    """6 knots of the Otter (MSS), and the scout's 1.97 m/s; flat out astern is slower."""
    assert top_speed(load_vessel("otter")) == pytest.approx(6.0 * 0.5144, rel=1e-3)
    assert top_speed(load_vessel("scout")) == pytest.approx(1.97, rel=1e-3)


@pytest.mark.parametrize("name", ["scout", "forager"])
def test_default_tunings_sail(name: str) -> None:
    vessel = dataclasses.replace(load_vessel(name), control=None)
    track = sail(vessel, YAWS, (4.0, 0.0), 15.0)
    assert track.first_within((4.0, 0.0), 1.0).max() < 10.0
    assert track.off((4.0, 0.0))[-1].max() < 0.6


def test_a_vessel_of_another_size_sails_by_default() -> None:
    """Three times as long, twenty times as heavy: legs reached, turned into, and kept in gusts."""
    track = sail(WORKBOAT, YAWS, (40.0, 0.0), 60.0)
    assert np.isfinite(track.first_within((40.0, 0.0), 1.0)).all()
    assert track.pose[..., 0].max() < 42.0
    away = sail(WORKBOAT, np.zeros(3), (100.0, 0.0), 70.0, weather=beam_gusts())
    x, y = away.pose[..., 0], away.pose[..., 1]
    there = (x > 40.0) & (x < 99.0)
    assert math.sqrt((y[there] ** 2).mean()) < 0.5
    kept = sail(WORKBOAT, YAWS, (0.0, 0.0), 90.0, stay=True, weather=beam_gusts())
    assert math.sqrt((kept.off((0.0, 0.0))[450:] ** 2).mean()) < 1.0
