import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.thruster import (
    command_for,
    force_of_sides,
    thrust,
    thrust_amid_step,
    thrust_in_step,
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
    assert force_of_sides(OTTER, 27.7, 0.0) == pytest.approx((27.7, -27.7 * 0.395))
    assert force_of_sides(OTTER, 0.0, 27.7) == pytest.approx((27.7, 27.7 * 0.395))
    assert force_of_sides(OTTER, 80.0, 80.0) == (160.0, 0.0)


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
