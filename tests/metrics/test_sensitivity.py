"""Degradation curves with a known slope and break, and scipy's regression as oracle."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import optimize, stats

from mjforage.metrics import bootstrap_sensitivity, sensitivity_slope, two_segment_fit

LEVELS = np.linspace(0.0, 1.0, 21)  # the paper's eps: 0 to 1 by 0.05
SEEDS = st.integers(0, 10_000)


def test_slope_by_hand() -> None:
    # Points (0, 1), (1, 3), (2, 2): slope 1/2, intercept 3/2, residuals -1/2, 1, -1/2, so
    # sse 3/2; half width t(0.975, 1) x sqrt(sse / 1 / 2) = 12.7062 x 0.866025 = 11.0039.
    line = sensitivity_slope([0.0, 1.0, 2.0], [1.0, 3.0, 2.0])
    np.testing.assert_allclose([line.slope, line.intercept, line.sse], [0.5, 1.5, 1.5])
    np.testing.assert_allclose([line.low, line.high], [0.5 - 11.0039, 0.5 + 11.0039], rtol=1e-4)


@given(SEEDS)
def test_slope_agrees_with_scipy(seed: int) -> None:
    means = np.random.default_rng(seed).normal(size=(3, 21))
    line = sensitivity_slope(LEVELS, means)
    for row, values in enumerate(means):
        theirs = stats.linregress(LEVELS, values)
        half = stats.t.ppf(0.975, 19) * theirs.stderr
        np.testing.assert_allclose(line.slope[row], theirs.slope, atol=1e-10)
        np.testing.assert_allclose(line.intercept[row], theirs.intercept, atol=1e-10)
        np.testing.assert_allclose(line.high[row] - line.slope[row], half, atol=1e-10)


@pytest.mark.parametrize("at", [0.5, 0.62, 0.07, 0.95])
def test_two_segments_find_a_break_on_and_between_levels(at: float) -> None:
    curve = 99.0 - 4.0 * LEVELS - 60.0 * np.maximum(LEVELS - at, 0.0)
    fit = two_segment_fit(LEVELS, curve)
    np.testing.assert_allclose(fit.break_point, at)
    np.testing.assert_allclose([fit.slope_before, fit.slope_after], [-4.0, -64.0])
    np.testing.assert_allclose(fit.height, 99.0 - 4.0 * at)
    np.testing.assert_allclose(fit.sse, 0.0, atol=1e-18)


@settings(deadline=None, max_examples=30)
@given(SEEDS)
def test_two_segments_are_the_global_optimum(seed: int) -> None:
    curve = np.random.default_rng(seed).normal(size=9).cumsum()
    levels = np.linspace(0.0, 1.0, 9)
    fit = two_segment_fit(levels, curve)

    def sse(at: float) -> float:
        design = np.stack([np.ones(9), levels, np.maximum(levels - at, 0.0)], axis=-1)
        solution = np.linalg.lstsq(design, curve, rcond=None)[0]
        return float(np.sum((design @ solution - curve) ** 2))

    np.testing.assert_allclose(fit.sse, sse(float(fit.break_point)), rtol=1e-6, atol=1e-9)
    off = levels - fit.break_point
    drawn = fit.height + np.where(off < 0.0, fit.slope_before, fit.slope_after) * off
    np.testing.assert_allclose(np.sum((drawn - curve) ** 2), fit.sse, rtol=1e-6, atol=1e-9)
    on_grid = min(sse(at) for at in np.linspace(levels[1], levels[-2], 400))
    refined = optimize.minimize_scalar(sse, bounds=(levels[1], levels[-2]), method="bounded")
    assert fit.sse <= min(on_grid, refined.fun) + 1e-9
    assert fit.sse <= sensitivity_slope(levels, curve).sse + 1e-9
    assert levels[0] < fit.break_point < levels[-1]


@pytest.mark.parametrize(
    ("levels", "means", "message"),
    [
        (LEVELS[:2], np.zeros(2), "at least 3"),
        (LEVELS[::-1], np.zeros(21), "rising"),
        (LEVELS, np.zeros(20), "do not fit"),
        (LEVELS, np.where(LEVELS == 0.5, np.nan, 1.0), r"means\[10\] is nan"),
        (np.ones((2, 3)), np.zeros(3), "at least 3"),
    ],
)
def test_bad_curves_are_rejected(levels: Any, means: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sensitivity_slope(levels, means)


def test_two_segments_need_five_levels() -> None:
    with pytest.raises(ValueError, match="at least 5"):
        two_segment_fit(LEVELS[:4], np.zeros(4))


def noisy_curve(seed: int, episodes: int = 60) -> Any:
    rng = np.random.default_rng(seed)
    curve = 99.0 - 4.0 * LEVELS - 60.0 * np.maximum(LEVELS - 0.5, 0.0)
    luck = rng.normal(scale=20.0, size=episodes)  # an episode is easy or hard at every level
    return curve[:, None] + luck + rng.normal(scale=1.0, size=(21, episodes))


def test_bootstrap_covers_the_truth_and_uses_the_pairing() -> None:
    values = noisy_curve(1)
    paired = bootstrap_sensitivity(LEVELS, values, 3, resamples=500)
    loose = bootstrap_sensitivity(LEVELS, values, 3, same_episodes=False, resamples=500)
    assert paired.break_point[0] <= 0.5 <= paired.break_point[1]
    assert paired.slope_before[0] <= -4.0 <= paired.slope_before[1]
    assert paired.slope_after[0] <= -64.0 <= paired.slope_after[1]
    assert np.ptp(paired.slope) < 0.3 * np.ptp(loose.slope)
    assert bootstrap_sensitivity(LEVELS, values, 3, resamples=500) == paired


def test_bootstrap_leaves_undefined_episodes_out() -> None:
    values = noisy_curve(2)
    values[4, ::3] = np.nan
    low, high = bootstrap_sensitivity(LEVELS, values, 1, resamples=300).slope
    assert low < high


def test_a_single_episode_has_no_interval() -> None:
    found = bootstrap_sensitivity(LEVELS, np.linspace(1.0, 0.0, len(LEVELS))[:, None], 0)
    assert np.isnan([*found.slope, *found.break_point]).all()


def test_bootstrap_rejects() -> None:
    with pytest.raises(ValueError, match=r"\(level, episode\)"):
        bootstrap_sensitivity(LEVELS, np.zeros(21), 0)
    with pytest.raises(ValueError, match=r"means\[0\] is nan"):
        bootstrap_sensitivity(LEVELS, np.full((21, 3), np.nan), 0)
    with pytest.raises(ValueError, match="resamples 0"):
        bootstrap_sensitivity(LEVELS, np.zeros((21, 3)), 0, resamples=0)
