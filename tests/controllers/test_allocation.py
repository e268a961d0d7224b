import math

import numpy as np
import pytest

from mjforage.controllers.allocation import allocate, command_for, lagged, led_command, thrust_of
from mjforage.controllers.steering import commands
from mjforage.controllers.vessel_model import packed
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import thrust, thruster_force
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel
from tests.controllers.plant import blank

SCOUT, FORAGER = load_vessel("scout"), load_vessel("forager")
P_SCOUT, P_FORAGER = packed(vessel_model(SCOUT)), packed(vessel_model(FORAGER))


def test_inside_the_limits_both_wishes_are_met() -> None:
    port, starboard = allocate(P_SCOUT, 20.0, 3.45, 0.0, 0.0)
    assert port + starboard == pytest.approx(20.0)
    assert (starboard - port) * P_SCOUT.lever_m == pytest.approx(3.45)


@pytest.mark.parametrize(
    ("surge", "moment", "port", "starboard"),
    [
        (200.0, 6.9, 13.6, 33.6),  # full ahead: surge gives way, 33.6 - 20 on the inner side
        (-200.0, 6.9, -19.9, 0.1),  # full astern
        (0.0, 100.0, -19.9, 33.6),  # more moment than there is: the ends of both ranges
        (0.0, -100.0, 33.6, -19.9),
        (200.0, 0.0, 33.6, 33.6),
    ],
)
def test_yaw_has_priority(surge: float, moment: float, port: float, starboard: float) -> None:
    assert allocate(P_SCOUT, surge, moment, 0.0, 0.0) == pytest.approx((port, starboard))


@pytest.mark.parametrize("force", [-66.0, -12.0, 0.0, 5.0, 119.0])
def test_commands_invert_the_thrust_curve(force: float) -> None:
    """k n |n| with another k each way, as the plant has it."""
    command = command_for(P_FORAGER, force, 0.0)
    assert thrust(pack(FORAGER), command) == pytest.approx(force)
    assert thrust_of(P_FORAGER, command, 0.0) == pytest.approx(force)


@pytest.mark.parametrize("speed", [-1.2, 0.4, 1.7])
@pytest.mark.parametrize("force", [-30.0, 20.0, 60.0])
def test_commands_invert_the_thrust_under_way(force: float, speed: float) -> None:
    command = command_for(P_FORAGER, force, speed)
    assert thruster_force(pack(FORAGER), command, command, speed, 0.0)[0] == pytest.approx(
        2 * force
    )
    assert thrust_of(P_FORAGER, command, speed) == pytest.approx(force)


def test_under_way_yaw_still_has_priority() -> None:
    """At 1.5 m/s a side has 82.3 N ahead, and astern what it has moored."""
    port, starboard = allocate(P_FORAGER, 500.0, 20.0, 1.5, 0.0)
    assert starboard == pytest.approx(thrust_of(P_FORAGER, 103.94, 1.5))
    assert (starboard - port) * P_FORAGER.lever_m == pytest.approx(20.0)
    assert allocate(P_FORAGER, -500.0, 0.0, 1.5, 0.0)[0] == P_FORAGER.thrust_low


@pytest.mark.parametrize(("surge", "moment"), [(0.0, 100.0), (500.0, 5.0), (-500.0, -5.0)])
def test_what_is_allocated_can_be_given_in_a_turn(surge: float, moment: float) -> None:
    """On the spot, port going astern and starboard ahead: each by the speed that it has."""
    rate = 0.8
    sides = allocate(P_SCOUT, surge, moment, 0.0, rate)
    beside = (-P_SCOUT.lever_m * rate, P_SCOUT.lever_m * rate)
    for force, speed in zip(sides, beside, strict=True):
        given = thrust_of(P_SCOUT, command_for(P_SCOUT, force, speed), speed)
        assert given == pytest.approx(force)


@pytest.mark.parametrize(("force", "command"), [(1e4, 103.94), (-1e4, -101.74)])
def test_commands_stay_in_range(force: float, command: float) -> None:
    assert command_for(P_FORAGER, force, 0.0) == command


@pytest.mark.parametrize(
    ("force", "command"), [(0.4, 0.0), (0.6, 1.0), (-0.4, 0.0), (-0.6, -1.0), (2.0, 2.0)]
)
def test_dead_zone_gives_the_nearer_of_nothing_and_its_edge(force: float, command: float) -> None:
    assert command_for(P_SCOUT, force, 0.0) == command


def test_lead_halves_the_lag() -> None:
    command = led_command(P_SCOUT, 0.0, 10.0, 0.1)
    reached = lagged(P_SCOUT, 0.0, command, 0.1)
    assert reached == pytest.approx(10.0 * (1.0 - math.exp(-0.1 / (0.5 * P_SCOUT.lag_s))))


def test_lead_stays_in_range() -> None:
    commands = [led_command(P_SCOUT, state, 33.6, 0.1) for state in np.linspace(-19.9, 33.6, 7)]
    assert max(commands) == 33.6


def test_commands_know_the_speed_of_each_propeller() -> None:
    """Turning to port in a current that comes along: starboard is the faster one in the water."""
    s = blank()
    s.vx, s.drift_x, s.rate = 1.8, 0.3, 0.4
    left, right = commands(s, P_FORAGER, 5.0, 5.0, 0.1)
    beside = 0.395 * 0.4
    assert left == led_command(P_FORAGER, 0.0, command_for(P_FORAGER, 5.0, 1.5 - beside), 0.1)
    assert right == led_command(P_FORAGER, 0.0, command_for(P_FORAGER, 5.0, 1.5 + beside), 0.1)
    assert right > left
