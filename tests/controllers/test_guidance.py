import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.controllers.guidance import (
    along_and_across,
    ilos_course,
    ilos_integral,
    ilos_rate,
    stopping_distance,
    stopping_speed,
    striking_speed,
)


def test_distances_along_and_across_a_line() -> None:
    along, across = along_and_across(3.0, 5.0, 1.0, 1.0, 0.5 * math.pi)  # a line to the north
    assert along == pytest.approx(4.0)
    assert across == pytest.approx(-2.0)  # east of it is starboard


def test_ilos() -> None:
    """psi_d = path - atan((y_e + kappa y_int) / Delta); y_int' = Delta y_e / (Delta^2 + ( )^2)."""
    y_e, y_int, kappa, delta = 0.7, 1.5, 0.8, 3.0
    together = 0.7 + 0.8 * 1.5
    assert ilos_course(0.2, y_e, y_int, kappa, delta) == pytest.approx(
        0.2 - math.atan(together / 3)
    )
    assert ilos_rate(y_e, y_int, kappa, delta) == pytest.approx(3 * 0.7 / (9 + together**2))
    assert ilos_course(0.2, 3.0, 0.0, kappa, delta) == pytest.approx(0.2 - math.pi / 4.0)


@pytest.mark.parametrize("drift", [-0.5, 0.0, 0.3])
def test_integral_that_holds_the_line_in_a_drift(drift: float) -> None:
    """On the line, speed x sin(course steered - path) undoes the drift."""
    integral = ilos_integral(drift, 1.2, 0.7, 3.0)
    steer = ilos_course(0.0, 0.0, integral, 0.7, 3.0)
    assert 1.2 * math.sin(steer) == pytest.approx(-drift)


@given(st.floats(0.0, 5.0), st.floats(0.1, 3.0), st.floats(0.0, 0.5))
def test_stopping_speed_is_the_inverse_of_the_distance(
    speed: float, brake: float, reaction_s: float
) -> None:
    distance = stopping_distance(speed, brake, reaction_s)
    assert distance == pytest.approx(speed * reaction_s + speed**2 / (2.0 * brake))
    assert stopping_speed(distance, brake, reaction_s) == pytest.approx(speed, abs=1e-6)


def test_no_room_is_no_speed() -> None:
    assert stopping_speed(-0.3, 1.0, 0.2) == 0.0


@given(st.floats(0.0, 2.0), st.floats(0.5, 2.0), st.floats(0.1, 0.5), st.floats(0.0, 0.3))
def test_striking_speed_leaves_what_a_touch_may_have(
    distance: float, brake: float, reaction_s: float, touch: float
) -> None:
    """v^2 - 2 a (d - v t) = touch^2, or v = touch where the reaction alone takes the distance."""
    speed = striking_speed(distance, brake, reaction_s, touch)
    left = speed**2 - 2.0 * brake * (distance - speed * reaction_s)
    assert speed >= touch
    assert left == pytest.approx(touch**2, abs=1e-6) or speed == touch
    assert striking_speed(-0.1, brake, reaction_s, touch) == touch
