import math

import numpy as np
import pytest

from mjforage.physics.weather.profile import height_factor
from mjforage.physics.weather.settings import WeatherSettings


def factor(height_m: float, **settings: object) -> float:
    chosen = WeatherSettings(**settings)  # type: ignore[arg-type]
    return float(height_factor(chosen, np.array([height_m]))[0])


def test_uniform_wind_has_no_height() -> None:
    assert factor(0.0) == factor(0.3) == factor(50.0) == 1.0


def test_logarithmic_profile_by_hand() -> None:
    """Reference 10 m, z0 = 0.1 m: two decades; 1 m is one of them, a half."""
    assert factor(1.0, wind_profile="log", roughness_m=0.1) == pytest.approx(0.5, rel=1e-14)
    assert factor(10.0, wind_profile="log") == 1.0
    assert factor(0.3, wind_profile="log") == pytest.approx(
        math.log(1500) / math.log(50_000), rel=1e-14
    )
    assert factor(2e-4, wind_profile="log") == factor(0.0, wind_profile="log") == 0.0


def test_power_profile_by_hand() -> None:
    settings = {"wind_profile": "power", "wind_height_m": 16.0, "power_exponent": 0.25}
    assert factor(1.0, **settings) == pytest.approx(0.5, rel=1e-14)
    assert factor(0.0, **settings) == 0.0


@pytest.mark.parametrize("height_m", [-0.1, np.nan, np.inf])
def test_impossible_heights_are_refused(height_m: float) -> None:
    with pytest.raises(ValueError, match="height_m"):
        factor(height_m, wind_profile="log")
