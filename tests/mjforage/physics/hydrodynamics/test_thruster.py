import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import command_for, thrust, thruster_force
from mjforage.physics.vessels import load_vessel

OTTER, SCOUT = pack(load_vessel("otter")), pack(load_vessel("scout"))


@pytest.mark.parametrize(
    ("speed_radps", "newton"),
    [
        (0.0, 0.0),
        (50.0, 27.7),  # 0.01108 * 2500
        (-50.0, -16.1125),  # 0.006445 * 2500
        (100.0, 110.8),
        (103.94, 119.7030),
        (500.0, 119.7030),  # saturated
        (-500.0, -66.7124),
    ],
)
def test_propeller_curve(speed_radps: float, newton: float) -> None:
    assert thrust(OTTER, speed_radps) == pytest.approx(newton, abs=1e-4)


@pytest.mark.parametrize(
    ("command", "newton"),
    [
        *((0.0, 0.0), (0.99, 0.0), (-0.99, 0.0), (1.0, 1.0), (-1.0, -1.0), (20.0, 20.0)),
        *((33.6, 33.6), (50.0, 33.6), (-19.9, -19.9), (-50.0, -19.9)),
    ],
)
def test_force_with_dead_zone_and_saturation(command: float, newton: float) -> None:
    assert thrust(SCOUT, command) == newton


@given(st.floats(-200.0, 200.0))
def test_command_for_gives_the_thrust_or_the_nearest(newton: float) -> None:
    expected = min(max(newton, thrust(OTTER, -1e9)), thrust(OTTER, 1e9))
    assert thrust(OTTER, command_for(OTTER, newton)) == pytest.approx(expected, abs=1e-9)


def test_port_thruster_turns_clockwise() -> None:
    surge, yaw = thruster_force(OTTER, 50.0, 0.0)
    assert surge == pytest.approx(27.7)
    assert yaw == pytest.approx(-27.7 * 0.395)
    assert thruster_force(OTTER, 0.0, 50.0) == pytest.approx((27.7, 27.7 * 0.395))
    assert thruster_force(OTTER, 80.0, 80.0)[1] == 0.0
