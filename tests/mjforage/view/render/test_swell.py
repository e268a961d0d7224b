import numpy as np
import pytest

from mjforage.view.render.swell import GRAVITY_MPS2, Swell


def test_slopes_are_those_of_one_real_surface() -> None:
    """Without curl: the slope along x changes along y as that along y does along x."""
    swell = Swell(10.0, 64, 0.1)
    sx, sy = np.moveaxis(swell.slopes(3.0).astype(np.float64), -1, 0)
    k = 2.0j * np.pi * np.fft.fftfreq(64, 10.0 / 64)
    dx_dy = np.fft.ifft(k[:, None] * np.fft.fft(sx, axis=0), axis=0).real
    dy_dx = np.fft.ifft(k[None, :] * np.fft.fft(sy, axis=1), axis=1).real
    np.testing.assert_allclose(dx_dy, dy_dx, atol=1e-4 * np.abs(dx_dy).max())


def test_slopes_have_the_asked_strength_and_no_mean() -> None:
    slopes = Swell(16.0, 128, 0.1).slopes(0.0)
    assert np.sqrt((slopes.astype(np.float64) ** 2).mean()) == pytest.approx(0.1, rel=1e-5)
    np.testing.assert_allclose(slopes.mean(axis=(0, 1)), 0.0, atol=1e-6)


def test_a_wave_comes_back_after_its_period() -> None:
    """A single wave of length L turns once in sqrt(2 pi L / g)."""
    swell = Swell(16.0, 64, 0.1)
    keep = np.zeros_like(swell._start)
    keep[5, 3] = swell._start[5, 3]
    swell._start = keep
    k = 2.0 * np.pi * np.hypot(5, 3) / 16.0
    period = 2.0 * np.pi / np.sqrt(GRAVITY_MPS2 * k)
    start = swell.slopes(0.0)
    np.testing.assert_allclose(swell.slopes(period), start, atol=1e-6)
    np.testing.assert_allclose(swell.slopes(0.5 * period), -start, atol=1e-6)
