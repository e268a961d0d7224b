"""The independent hull against closed forms, and against figures that others have of it."""

import math

import pytest

from mjforage.physics.vessels import load_vessel
from tests.mjforage.physics.validation.momentum import wind_load
from tests.mjforage.physics.validation.motion_checks import leeway


@pytest.mark.parametrize(
    ("name", "shares"), [("forager", (0.56, 1.3, 2.2)), ("scout", (0.47, 1.1, 1.8))]
)
def test_drift_is_that_of_an_integration_by_others(name: str, shares: tuple[float, ...]) -> None:
    """Percent of winds of 2, 5 and 10 m/s; two digits."""
    for wind, share in zip((2.0, 5.0, 10.0), shares, strict=True):
        assert 100.0 * leeway(load_vessel(name), wind) == pytest.approx(share, rel=0.025)


@pytest.mark.parametrize("port", [1.0, -1.0])
def test_wind_from_45_degrees_ahead_by_hand(port: float) -> None:
    """Air that goes aft and to starboard comes from port ahead: the bow falls off to starboard."""
    part, pressure = 5.0 / math.sqrt(2.0), 0.5 * 1.224 * 25.0
    bent = 1.0 - 0.3 * (1.0 - 0.55 / 0.90)
    x, y, n = wind_load(load_vessel("forager"), -part, port * part)
    assert x == pytest.approx(-pressure * 0.45 * 0.55 / math.sqrt(2.0) / bent)
    assert y == pytest.approx(port * pressure * 0.85 * 0.90 / math.sqrt(2.0) / bent)
    assert n == pytest.approx(0.18 * math.pi / 4.0 * 2.0 * y)
