"""Power drawn at rest, at cruise speed and flat out, of every shipped hull with motors."""

import dataclasses
import math

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.power import drawn_power
from mjforage.physics.hydrodynamics.thruster import command_for, thrust, thruster_force
from mjforage.physics.scene.build import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import check_vessel, load_vessel
from mjforage.scenario.vessel_files import vessel_names

PACK_WH, BUDGET_W, ENDURANCE_H = 3660.0, 833.8, 4.39  # NTNU, power usage of the Otter
OTTER = load_vessel("otter")
# Drawn at rest, at cruise speed, flat out [W]; top speed [m/s].
HULLS = {
    "otter": (33.8, 450.5, 833.8, 3.087),
    "forager": (33.8, 692.8, 833.8, 1.815),
    "scout": (33.8, 260.9, 271.8, 1.970),
}


def top_speed(name: str) -> float:
    """Speed after a minute flat out [m/s]."""
    vessel = load_vessel(name)
    simulation = Simulation(build_scene([vessel]))
    simulation.commands[:] = vessel.thruster.command_range[1]
    simulation.step(round(60.0 / simulation.step_s))
    return float(simulation.vessel_velocity[0, 0, 0])


@pytest.mark.parametrize("name", HULLS)
def test_power_at_rest_at_cruise_and_flat_out(name: str) -> None:
    vessel, p = load_vessel(name), pack(load_vessel(name))
    assert vessel.control is not None
    cruise, full = vessel.control.cruise_ahead_mps, vessel.thruster.command_range[1]
    drag = (vessel.linear_surge + vessel.quadratic_surge * cruise) * cruise
    effort = np.linspace(0.0, full, 20_001)
    force = [thruster_force(p, each, each, cruise, 0.0)[0] for each in effort]
    command = effort[np.searchsorted(force, drag)]
    drawn = [drawn_power(p, each, each) for each in (0.0, command, full)]
    assert (*drawn, top_speed(name)) == pytest.approx(HULLS[name], rel=2e-3)


def test_every_shipped_hull_is_checked() -> None:
    with_motors = {name for name in vessel_names() if load_vessel(name).power}
    assert with_motors == set(HULLS)


@pytest.mark.parametrize("name", HULLS)
def test_motors_never_draw_more_than_their_rating_nor_give_more_than_they_draw(name: str) -> None:
    vessel, p = load_vessel(name), pack(load_vessel(name))
    assert vessel.power is not None
    for command in np.linspace(-300.0, 300.0, 41):
        drawn = drawn_power(p, command, 0.0) - vessel.power.hotel_w
        assert drawn <= vessel.power.motor_w * (1.0 + 1e-12)
        for speed in np.linspace(-4.0, 4.0, 17):
            force, _ = thruster_force(p, command, 0.0, speed, 0.0)
            assert force * speed <= 0.7 * drawn + 1e-9  # more than any propeller makes of it


def test_the_otter_flat_out_lasts_as_long_as_its_users_say() -> None:
    full = OTTER.thruster.command_range[1]
    drawn = drawn_power(pack(OTTER), full, full)
    assert drawn == pytest.approx(BUDGET_W)
    assert PACK_WH / drawn == pytest.approx(ENDURANCE_H, abs=0.005)


def test_power_goes_with_the_thrust_to_three_halves() -> None:
    p = pack(OTTER)
    half = command_for(p, 0.5 * thrust(p, 1e9))
    assert drawn_power(p, half, 0.0) == pytest.approx(33.8 + 400.0 * 0.5**1.5)
    astern = thrust(p, -1e9) / thrust(p, 1e9)
    assert drawn_power(p, 0.0, -1e9) == pytest.approx(33.8 + 400.0 * abs(astern) ** 1.5)


def test_a_vessel_without_the_table_draws_nothing_and_keeps_its_thrust() -> None:
    p = pack(dataclasses.replace(OTTER, power=None))
    assert drawn_power(p, 60.0, 0.0) == 0.0
    assert thruster_force(p, 60.0, 60.0, 3.0, 0.5)[0] == 2.0 * 0.01108 * 3600.0


def test_motors_too_weak_for_their_thrust_are_refused() -> None:
    assert OTTER.power is not None
    least = math.sqrt(119.703**3 / OTTER.power.disc_kgpm)
    weak = dataclasses.replace(OTTER, power=dataclasses.replace(OTTER.power, motor_w=0.99 * least))
    with pytest.raises(UserError, match=r"^vessel x: power.motor_w = .* is less than the 163.2 W"):
        check_vessel(weak, "vessel x")
