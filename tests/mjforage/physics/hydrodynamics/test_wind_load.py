import pytest

from mjforage.physics.hydrodynamics.parameters import pack
from mjforage.physics.hydrodynamics.wind_load import wind_force, wind_slope
from mjforage.physics.vessels import load_vessel

FORAGER, OTTER = pack(load_vessel("forager")), pack(load_vessel("otter"))
FRONT, SIDE, LENGTH = 0.45, 0.85, 2.0


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
