"""Brier score, its parts and calibration, by hand."""

import numpy as np
import pytest

from mjforage import metrics


def sums(*pairs: tuple[float, int]) -> np.ndarray:
    """(bin, 4) of forecasts and what came true."""
    found = np.zeros((metrics.BINS, 4))
    for forecast, outcome in pairs:
        place = min(int(forecast * metrics.BINS), metrics.BINS - 1)
        found[place] += (1.0, forecast, outcome, (forecast - outcome) ** 2)
    return found


FOUR = sums((0.85, 1), (0.85, 0), (0.25, 0), (0.25, 0))


def test_four_forecasts_by_hand() -> None:
    """Two of .85 of which one came true, two of .25 of which none did."""
    assert metrics.base_rate(FOUR) == 0.25
    assert metrics.brier(FOUR) == pytest.approx((0.0225 + 0.7225 + 0.0625 + 0.0625) / 4)
    assert metrics.reliability(FOUR) == pytest.approx((0.35**2 + 0.25**2) / 2)
    assert metrics.calibration_error(FOUR) == pytest.approx((0.35 + 0.25) / 2)
    assert metrics.brier_skill(FOUR) == pytest.approx(1.0 - 0.2175 / 0.1875)
    apart = sums((0.85, 0), (0.25, 1))
    assert metrics.calibration_error(apart) == pytest.approx((0.85 + 0.75) / 2), "both ways"


def test_calibrated_forecasts_have_no_error_and_sure_ones_no_score() -> None:
    half = sums((0.5, 1), (0.5, 0))
    assert metrics.calibration_error(half) == metrics.reliability(half) == 0.0
    assert metrics.brier_skill(half) == 0.0, "no better than the base rate"
    sure = sums((1.0, 1), (0.0, 0))
    assert metrics.brier(sure) == 0.0 and metrics.brier_skill(sure) == 1.0


def test_without_forecasts_nothing_is_defined() -> None:
    nothing = np.zeros((2, metrics.BINS, 4))
    for score in (metrics.brier, metrics.brier_skill, metrics.reliability, metrics.base_rate):
        assert np.isnan(score(nothing)).all()
    assert np.isnan(metrics.calibration_error(nothing)).all()
    assert np.isnan(metrics.brier_skill(sums((0.3, 0)))), "what never happens cannot be skilled"
    assert np.isnan(metrics.brier_skill(sums((0.3, 1)))), "nor what always does"
