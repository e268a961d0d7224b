import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mjforage.controllers.propulsion import thrust_under_way
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import (
    command_for,
    thrust,
    thrust_amid_step,
    thrust_in_step,
    thruster_force,
    thruster_slope,
)
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
    surge, yaw = thruster_force(OTTER, 50.0, 0.0, 0.0, 0.0)
    assert surge == pytest.approx(27.7)
    assert yaw == pytest.approx(-27.7 * 0.395)
    assert thruster_force(OTTER, 0.0, 50.0, 0.0, 0.0) == pytest.approx((27.7, 27.7 * 0.395))
    assert thruster_force(OTTER, 80.0, 80.0, 0.0, 0.0)[1] == 0.0


def test_each_side_has_its_own_speed_through_the_water() -> None:
    """Turning to port at 0.5 rad/s, starboard goes 0.395 m/s faster than port, for less thrust."""
    left = thrust_under_way(119.703, 1.0 - 0.1975, OTTER.disc)
    right = thrust_under_way(119.703, 1.0 + 0.1975, OTTER.disc)
    force, moment = thruster_force(OTTER, 103.94, 103.94, 1.0, 0.5)
    assert right < left
    assert (force, moment) == pytest.approx((left + right, 0.395 * (right - left)), rel=1e-5)


@given(st.floats(-110.0, 110.0), st.floats(-110.0, 110.0), st.floats(-3.0, 3.0), st.floats(-1, 1))
def test_slopes_are_those_of_the_force(port: float, starboard: float, u: float, r: float) -> None:
    assume(min(abs(u - 0.395 * r), abs(u + 0.395 * r)) > 1e-3)  # off the kink at rest
    (more, _), (less, _) = (thruster_force(OTTER, port, starboard, u + h, r) for h in (1e-5, -1e-5))
    more_turn, less_turn = (
        thruster_force(OTTER, port, starboard, u, r + h)[1] for h in (1e-5, -1e-5)
    )
    surge, yaw = thruster_slope(OTTER, thrust(OTTER, port), thrust(OTTER, starboard), u, r)
    assert (less - more) / 2e-5 == pytest.approx(surge, rel=1e-4, abs=1e-5)
    assert (less_turn - more_turn) / 2e-5 == pytest.approx(yaw, rel=1e-4, abs=1e-5)


@given(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.sampled_from([0.02, 0.1, 1.0]))
def test_the_mean_thrust_of_a_step_is_that_of_the_lagged_command(
    command: float, start: float, step_s: float
) -> None:
    """Against the midpoint rule in 20,000 parts, whose jumps are off by at most one part each.

    Simpson's rule on the smooth part of the lagged command is off by (h / lag)^4 / 2880 of it.
    """
    ahead, middle, end = thrust_in_step(SCOUT, command, start, step_s)
    times = (np.arange(20_000) + 0.5) * step_s / 20_000
    lagged = command + (start - command) * np.exp(-times / SCOUT.lag)
    mean = float(np.where(np.abs(lagged) >= SCOUT.dead_zone, lagged, 0.0).mean())
    rule = (step_s / SCOUT.lag) ** 4 / 2880.0 * abs(start - command)
    assert (ahead + 4.0 * middle + end) / 6.0 == pytest.approx(mean, abs=2e-4 + rule)


def test_a_propeller_and_a_thruster_without_a_dead_zone_have_the_thrust_of_each_instant() -> None:
    """The command changes its sign within the step."""
    ideal = pack(load_vessel("ideal"))
    for vessel, command, start in ((OTTER, -50.0, 50.0), (ideal, -20.0, 20.0)):
        half = math.exp(-0.05 / vessel.lag)
        instants = [command + (start - command) * share for share in (1.0, half, half * half)]
        found = thrust_in_step(vessel, command, start, 0.1)
        assert found == pytest.approx([thrust(vessel, at) for at in instants])


def test_stages_of_runge_kutta_share_the_jump_at_the_dead_zones_edge() -> None:
    """From 5 N to 0 through the edge: the sum over steps is the impulse, wherever steps begin."""
    step_s, lag = 0.02, SCOUT.lag
    impulse = lag * (5.0 - 1.0)  # of 5 exp(-t / lag) until it is 1 N
    for begin in np.linspace(0.0, step_s, 7):
        lagged = 5.0 * np.exp(-(begin + step_s * np.arange(60)) / lag)
        pushes = [thrust_amid_step(SCOUT, 0.0, c, step_s) for c in lagged]
        before = 5.0 * lag * -math.expm1(-(begin - 0.5 * step_s) / lag)
        assert before + step_s * sum(pushes) == pytest.approx(impulse, abs=5e-4)


def test_inside_the_dead_zone_nothing_pushes() -> None:
    assert thrust_in_step(SCOUT, 0.5, -0.9, 0.1) == (0.0, 0.0, 0.0)
    assert thrust_in_step(SCOUT, 0.5, 0.5, 0.1) == (0.0, 0.0, 0.0)
