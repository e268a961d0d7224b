"""Thrust under way against momentum theory solved numerically."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from mjforage.controllers.propulsion import moored_thrust, thrust_slope, thrust_under_way

DISC = 2.0 * 1025.0 * math.pi / 4.0 * 0.2**2  # 2 rho A of the Otter's propellers [kg/m]
NEWTON = st.floats(1e-3, 500.0)
SPEED = st.floats(0.0, 6.0)


def power(thrust: float, inflow: float) -> float:
    """Power that a disc gives the water, T (u + w) with the w of T = 2 rho A w (u + w)."""

    def rest(w: float) -> float:
        return DISC * w * (inflow + w) - thrust

    return thrust * (inflow + float(brentq(rest, 0.0, 50.0, xtol=1e-14, rtol=1e-14)))


@given(NEWTON, SPEED)
def test_the_water_gets_the_same_power_at_any_speed(moored: float, speed: float) -> None:
    thrust = thrust_under_way(moored, speed, DISC)
    assert power(thrust, speed) == pytest.approx(power(moored, 0.0), rel=1e-9)
    assert thrust_under_way(-moored, -speed, DISC) == -thrust
    assert moored_thrust(thrust, speed, DISC) == pytest.approx(moored, rel=1e-9)
    assert moored_thrust(-thrust, -speed, DISC) == pytest.approx(-moored, rel=1e-9)


@given(NEWTON, st.floats(0.01, 6.0))
def test_the_slope_is_that_of_the_thrust(moored: float, speed: float) -> None:
    less, more = (thrust_under_way(moored, speed + h, DISC) for h in (1e-5, -1e-5))
    slope = thrust_slope(moored, speed, DISC)
    assert (more - less) / 2e-5 == pytest.approx(slope, rel=1e-4, abs=1e-6)
    assert thrust_slope(-moored, -speed, DISC) == slope


@pytest.mark.parametrize(("moored", "speed"), [(40.0, -1.0), (-40.0, 2.0), (40.0, 0.0), (0.0, 2.0)])
def test_an_inflow_from_astern_counts_as_none(moored: float, speed: float) -> None:
    assert thrust_under_way(moored, speed, DISC) == moored
    assert moored_thrust(moored, speed, DISC) == moored
    assert thrust_slope(moored, speed, DISC) == 0.0


@pytest.mark.parametrize("moored", [5e-324, 1e-320, 1e-300, 1e-100, 1e-13])
def test_a_thrust_that_dies_away_does_so_at_any_speed(moored: float) -> None:
    """Squares of lagged commands become subnormal numbers."""
    assert 0.0 <= thrust_under_way(moored, 3.0, DISC) <= moored
    assert 0.0 <= thrust_slope(moored, 3.0, DISC) <= 1e-9
    assert moored_thrust(moored, 3.0, DISC) < 1e-6


def test_without_a_disc_thrust_does_not_fall() -> None:
    assert thrust_under_way(40.0, 3.0, 0.0) == moored_thrust(40.0, 3.0, 0.0) == 40.0
    assert thrust_slope(40.0, 3.0, 0.0) == 0.0


def test_thrust_of_the_otter_at_its_top_speed() -> None:
    """By hand: w0 = 1.363 m/s, w0 / y = 3.317 m/s, T = 119.7 y N."""
    assert thrust_under_way(119.7, 3.086, DISC) == pytest.approx(49.2, abs=0.05)
