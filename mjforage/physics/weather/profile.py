"""Wind over height: the factor on the wind at the reference height."""

import math

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from mjforage.physics.weather.settings import PROFILES, WeatherSettings

_LOG, _POWER = PROFILES.index("log"), PROFILES.index("power")


@kernel
def _factors(
    height_m: NDArray[np.float64],
    profile: int,
    reference_m: float,
    roughness_m: float,
    exponent: float,
) -> NDArray[np.float64]:
    result = np.ones(height_m.size)
    for i in range(height_m.size):
        height = height_m[i]
        if profile == _LOG:
            above = max(math.log(height / roughness_m), 0.0) if height > 0.0 else 0.0
            result[i] = above / math.log(reference_m / roughness_m)
        elif profile == _POWER:
            result[i] = (height / reference_m) ** exponent
    return result


def height_factor(settings: WeatherSettings, height_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Wind at a height over wind at the reference height.

    The logarithmic profile is ln(z/z0) / ln(ref/z0), and 0 below the roughness length z0; the
    power profile is (z/ref)^p (Stull, An Introduction to Boundary Layer Meteorology, section 9.7).

    Parameters
    ----------
    height_m : (point,) above the water

    Returns
    -------
    (point,) factor

    Raises
    ------
    ValueError
        If a height is negative or not finite.
    """
    heights = np.ascontiguousarray(height_m, np.float64)
    if not (heights >= 0.0).all() or np.isinf(heights).any():
        raise ValueError(f"height_m = {heights}: heights above water are finite and at least 0")
    return _factors(
        heights,
        PROFILES.index(settings.wind_profile),
        settings.wind_height_m,
        settings.roughness_m,
        settings.power_exponent,
    )
