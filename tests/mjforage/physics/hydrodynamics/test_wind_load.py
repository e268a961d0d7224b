import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mjforage.physics.hydrodynamics import pack, wind_force
from mjforage.physics.hydrodynamics.wind_load import wind_slope
from mjforage.physics.vessels import load_vessel

FORAGER, OTTER = pack(load_vessel("forager")), pack(load_vessel("otter"))
Q = 0.5 * 1.224 * 25.0  # dynamic pressure of 5 m/s
FRONT, SIDE, LENGTH = 0.45, 0.85, 2.0


def test_head_wind_pushes_aft() -> None:
    x, y, n = wind_force(FORAGER, -5.0, 0.0)
    assert x == pytest.approx(-Q * FRONT * 0.55)
    assert (y, n) == (0.0, 0.0)


def test_following_wind_pushes_ahead_with_the_stern_coefficient() -> None:
    x, y, n = wind_force(FORAGER, 5.0, 0.0)
    assert x == pytest.approx(Q * FRONT * 0.60)
    assert (y, n) == (0.0, 0.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_beam_wind_pushes_to_leeward_without_turning(side: float) -> None:
    x, y, n = wind_force(FORAGER, 0.0, 5.0 * side)
    assert x == 0.0
    assert y == pytest.approx(side * Q * SIDE * 0.90)
    assert n == pytest.approx(0.0, abs=1e-12)


def test_wind_from_45_degrees_ahead_by_hand() -> None:
    """From ahead and port: aft, to starboard, and the bow falls off to starboard (N < 0)."""
    part = 5.0 / math.sqrt(2.0)
    x, y, n = wind_force(FORAGER, -part, -part)
    den = 1.0 - 0.5 * 0.60 * (1.0 - 0.55 / 0.90)
    assert x == pytest.approx(-Q * FRONT * 0.55 / math.sqrt(2.0) / den)
    assert y == pytest.approx(-Q * SIDE * 0.90 / math.sqrt(2.0) / den)
    assert n == pytest.approx(0.18 * math.pi / 4.0 * LENGTH * y)
    assert n < 0.0


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_mirrored_wind_gives_the_mirrored_load(u: float, v: float) -> None:
    x, y, n = wind_force(FORAGER, u, v)
    assert wind_force(FORAGER, u, -v) == (x, -y, -n)


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_wind_never_pushes_to_windward(u: float, v: float) -> None:
    x, y, _ = wind_force(FORAGER, u, v)
    assert x * u >= 0.0
    assert y * v >= 0.0


@pytest.mark.parametrize(("u", "v"), [(-5.0, 0.0), (5.0, 0.0), (0.0, 5.0), (0.0, -5.0)])
def test_slopes_are_the_derivatives_ahead_astern_and_abeam(u: float, v: float) -> None:
    """Of X by u and Y by v along the axes, where Blendermann's denominator is level."""
    step = 1e-5
    ahead, aside = wind_slope(FORAGER, u, v)
    if u:
        gain = wind_force(FORAGER, u + step, v)[0] - wind_force(FORAGER, u - step, v)[0]
        assert ahead == pytest.approx(gain / (2 * step), rel=1e-6)
    else:
        gain = wind_force(FORAGER, u, v + step)[1] - wind_force(FORAGER, u, v - step)[1]
        assert aside == pytest.approx(gain / (2 * step), rel=1e-6)


def test_no_area_or_no_wind_no_load() -> None:
    assert wind_slope(OTTER, 10.0, 10.0) == wind_slope(FORAGER, 0.0, 0.0) == (0.0, 0.0)
    assert wind_force(OTTER, 10.0, 10.0) == (0.0, 0.0, 0.0)
    assert wind_force(FORAGER, 0.0, 0.0) == (0.0, 0.0, 0.0)
