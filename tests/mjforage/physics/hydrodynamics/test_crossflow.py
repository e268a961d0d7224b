import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from mjforage.physics.hydrodynamics.crossflow import cross_flow, cross_flow_slope
from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.vessels import load_vessel

OTTER = load_vessel("otter")
STRIPS, INTEGRAL = pack(OTTER), pack(load_vessel("forager"))
FACTOR = 0.5 * 1025.0 * 1.0 * 0.195  # 1/2 rho Cd T
SPEEDS = st.floats(-3.0, 3.0)


@given(SPEEDS, SPEEDS)
def test_integral_agrees_with_quadrature(v: float, r: float) -> None:
    turns = [-v / r] if r and abs(v / r) < 1.0 else None

    def integral(power: int) -> float:
        def drag(x: float) -> float:
            return float(x**power * (v + x * r) * abs(v + x * r))

        return float(quad(drag, -1.0, 1.0, points=turns)[0])

    expected = (-FACTOR * integral(0), -FACTOR * integral(1))
    np.testing.assert_allclose(cross_flow(INTEGRAL, v, r), expected, rtol=1e-6, atol=1e-6)


@given(SPEEDS, SPEEDS)
def test_slopes_are_the_derivatives(v: float, r: float) -> None:
    step = 1e-5
    (side, _), (other, _) = (cross_flow(INTEGRAL, v + h, r) for h in (step, -step))
    (_, turn), (_, back) = (cross_flow(INTEGRAL, v, r + h) for h in (step, -step))
    expected = (other - side) / (2 * step), (back - turn) / (2 * step)
    slopes = cross_flow_slope(INTEGRAL, v, r)
    np.testing.assert_allclose(slopes, expected, rtol=1e-4, atol=1e-2)
    assert min(slopes) >= 0.0


@given(SPEEDS, SPEEDS)
def test_otter_sums_21_strips_of_a_tenth_of_a_metre(v: float, r: float) -> None:
    x = np.linspace(-1.0, 1.0, 21)
    drag = -FACTOR * np.abs(v + x * r) * (v + x * r) * 0.1
    expected = (drag.sum(), (x * drag).sum())
    np.testing.assert_allclose(cross_flow(STRIPS, v, r), expected, rtol=1e-9, atol=1e-9)


def test_pure_sway_by_hand_and_the_five_percent_of_the_strips() -> None:
    integrated, moment = cross_flow(INTEGRAL, 0.5, 0.0)
    assert integrated == pytest.approx(-FACTOR * 0.25 * 2.0)
    assert moment == 0.0
    strips, _ = cross_flow(STRIPS, 0.5, 0.0)
    assert strips == pytest.approx(1.05 * integrated)


def test_pure_yaw_by_hand() -> None:
    """N = -1/2 rho Cd T r^2 L^4 / 32, no force."""
    force, moment = cross_flow(INTEGRAL, 0.0, -0.4)
    assert force == pytest.approx(0.0, abs=1e-12)
    assert moment == pytest.approx(FACTOR * 0.16 * 2.0**4 / 32.0)


def test_no_table_no_drag() -> None:
    bare = pack(dataclasses.replace(OTTER, crossflow=None))
    assert cross_flow(bare, 1.0, 1.0) == cross_flow_slope(bare, 1.0, 1.0) == (0.0, 0.0)
