import math

import numpy as np
import pytest

from mjforage.controllers.allocation import allocate, command_for, lagged, led_command, thrust_of
from mjforage.controllers.vessel_model import packed
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import thrust
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessels import load_vessel

SCOUT, FORAGER = load_vessel("scout"), load_vessel("forager")
P_SCOUT, P_FORAGER = packed(vessel_model(SCOUT)), packed(vessel_model(FORAGER))


def test_inside_the_limits_both_wishes_are_met() -> None:
    port, starboard = allocate(P_SCOUT, 20.0, 3.45)
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
    assert allocate(P_SCOUT, surge, moment) == pytest.approx((port, starboard))


@pytest.mark.parametrize("force", [-66.0, -12.0, 0.0, 5.0, 119.0])
def test_commands_invert_the_thrust_curve(force: float) -> None:
    """k n |n| with another k each way, as the plant has it."""
    command = command_for(P_FORAGER, force)
    assert thrust(pack(FORAGER), command) == pytest.approx(force)
    assert thrust_of(P_FORAGER, command) == pytest.approx(force)


@pytest.mark.parametrize(("force", "command"), [(1e4, 103.94), (-1e4, -101.74)])
def test_commands_stay_in_range(force: float, command: float) -> None:
    assert command_for(P_FORAGER, force) == command


@pytest.mark.parametrize(
    ("force", "command"), [(0.4, 0.0), (0.6, 1.0), (-0.4, 0.0), (-0.6, -1.0), (2.0, 2.0)]
)
def test_dead_zone_gives_the_nearer_of_nothing_and_its_edge(force: float, command: float) -> None:
    assert command_for(P_SCOUT, force) == command


def test_lead_halves_the_lag() -> None:
    command = led_command(P_SCOUT, 0.0, 10.0, 0.1)
    reached = lagged(P_SCOUT, 0.0, command, 0.1)
    assert reached == pytest.approx(10.0 * (1.0 - math.exp(-0.1 / (0.5 * P_SCOUT.lag_s))))


def test_lead_stays_in_range() -> None:
    commands = [led_command(P_SCOUT, state, 33.6, 0.1) for state in np.linspace(-19.9, 33.6, 7)]
    assert max(commands) == 33.6
