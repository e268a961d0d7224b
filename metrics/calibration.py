"""Skill and calibration of forecasts: Brier score, its parts, and calibration.

A forecast f of an event (here: that a node holds an item) is compared with the outcome, o = 0 or
1. Forecasts are gathered in bins; a bin is four sums, so that those of many steps
and episodes add up. Sources: G. W. Brier, Monthly Weather Review 78, 1950; A. H. Murphy, Journal of
Applied Meteorology 12, 1973 (its parts); M. P. Naeini, G. F. Cooper and M. Hauskrecht, AAAI 2015
(calibration error).
"""

import numpy as np
from numpy.typing import NDArray

BINS = 10
"""Bins of a forecast, of one width from 0 to 1."""
NUMBER, FORECAST, OUTCOME, SQUARED = range(4)
"""The sums of a bin: forecasts, of their values, of the events, of the squared errors."""

FloatArray = NDArray[np.float64]


def _shares(sums: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Share of all forecasts, mean forecast, and frequency of the event of each bin (..., bin)."""
    number = sums[..., NUMBER]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = number / number.sum(axis=-1, keepdims=True)
        forecast = np.where(number > 0, sums[..., FORECAST] / number, 0.0)
        outcome = np.where(number > 0, sums[..., OUTCOME] / number, 0.0)
    return share, forecast, outcome


def base_rate(sums: FloatArray) -> FloatArray:
    """Frequency of the event over all bins (...,), NaN without forecasts."""
    with np.errstate(invalid="ignore"):
        return np.asarray(sums[..., OUTCOME].sum(-1) / sums[..., NUMBER].sum(-1))


def brier(sums: FloatArray) -> FloatArray:
    """Mean of (f - o)^2 (...,); 0 is perfect.

    Parameters
    ----------
    sums : (..., bin, 4) as `NUMBER`, `FORECAST`, `OUTCOME`, `SQUARED` name them
    """
    with np.errstate(invalid="ignore"):
        return np.asarray(sums[..., SQUARED].sum(-1) / sums[..., NUMBER].sum(-1))


def brier_skill(sums: FloatArray) -> FloatArray:
    """1 - BS / (o (1 - o)) (...,): 1 is perfect, 0 no better than always saying the base rate.

    Undefined where the event always or never came true.
    """
    rate = base_rate(sums)
    with np.errstate(invalid="ignore", divide="ignore"):
        skill = 1.0 - brier(sums) / (rate * (1.0 - rate))
    return np.asarray(np.where((rate > 0.0) & (rate < 1.0), skill, np.nan))


def reliability(sums: FloatArray) -> FloatArray:
    """Mean squared difference of forecast and frequency over the bins (...,); 0 is calibrated.

    The first part of the Brier score, which is reliability - resolution + o (1 - o).
    """
    share, forecast, outcome = _shares(sums)
    return np.asarray((share * (forecast - outcome) ** 2).sum(-1))


def calibration_error(sums: FloatArray) -> FloatArray:
    """Mean absolute difference of forecast and frequency over the bins (...,)."""
    share, forecast, outcome = _shares(sums)
    return np.asarray((share * np.abs(forecast - outcome)).sum(-1))
