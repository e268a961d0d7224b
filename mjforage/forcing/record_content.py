"""Content of a record's file, as its readers find it, and gusts from their strongest."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
MEANS_OVER_GUSTS = 600.0 / 3.0, 480.0 / 5.0
"""Time of a mean over that of a gust: 10 min and 3 s by WMO, 8 min and 5 s of NDBC's buoys."""
_STRONGEST = 0.5  # intensity of gusts


class Content(NamedTuple):
    """Content of a file, as a reader finds it; fields as those of `record_files.Recorded`."""

    times_s: FloatArray
    parts: dict[str, FloatArray]  # wind, current and gusts
    latitude: FloatArray = np.full(1, np.nan)
    longitude: FloatArray = np.full(1, np.nan)
    height_m: float | None = None


def intensity(gust_mps: FloatArray, wind: FloatArray, means_over_gusts: float) -> FloatArray:
    """(...) standard deviation of gusts over the speed of a wind (..., 2); NaN where unknown.

    The strongest gust is 1 + I / 2 ln(T / t) of the mean, by the intensity I and the times T of
    the mean and t of the gust (Ishizaki, "Wind profiles, turbulence intensities and gust factors
    for design in typhoon-prone regions", J. Wind Eng. Ind. Aerodyn. 13, 1983).
    """
    speed = np.hypot(wind[..., 0], wind[..., 1])
    factor = gust_mps / np.where(speed > 0.0, speed, np.nan)
    found: FloatArray = (factor - 1.0) / (0.5 * math.log(means_over_gusts))
    return found.clip(0.0, _STRONGEST)
