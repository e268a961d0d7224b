"""Small waves on harbour water: a periodic patch of the sea, from its spectrum at any time.

Sum of waves with the deep-water dispersion omega^2 = g k, made by one inverse Fourier transform
(J. Tessendorf, "Simulating Ocean Water", SIGGRAPH course notes, 2001). Only films use
it; nothing floats on it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import fft

GRAVITY_MPS2 = 9.81
_SEED = 11
_LONGEST, _SHORTEST = 0.22, 0.012  # wavelengths, in parts of the patch
_SPREAD = 1.5  # power of the cosine from the wind's direction
_WIND_RAD = 0.7  # the way that most waves run


class Swell:
    """Slopes of the surface of one patch of `side_m`, `size` points a side, as it moves."""

    def __init__(self, side_m: float, size: int, slope_rms: float) -> None:
        self.side_m, self.size = side_m, size
        wave = 2.0 * np.pi * fft.fftfreq(size, side_m / size)
        self._kx, self._ky = np.meshgrid(wave, wave)
        k = np.hypot(self._kx, self._ky)
        self._omega = np.sqrt(GRAVITY_MPS2 * k)
        random = np.random.Generator(np.random.PCG64(_SEED))
        phase = random.uniform(0.0, 2.0 * np.pi, k.shape)
        self._start = (self._spectrum(k) * np.exp(1j * phase)).astype(np.complex64)
        self._along = (1j * self._kx - self._ky).astype(np.complex64)
        slopes = self.slopes(0.0)
        self._start *= np.float32(slope_rms / float(np.sqrt((slopes**2).mean())))

    def _spectrum(self, k: NDArray[np.float64]) -> NDArray[np.float64]:
        """Amplitudes: slopes even over the wavelengths used, running mostly with the wind."""
        safe = np.where(k > 0.0, k, 1.0)
        along = (self._kx * np.cos(_WIND_RAD) + self._ky * np.sin(_WIND_RAD)) / safe
        length = 2.0 * np.pi / (safe * self.side_m)
        used = (k > 0.0) & (length < _LONGEST) & (length > _SHORTEST)
        with_wind = np.clip(0.5 + 0.5 * along, 0.0, 1.0) ** _SPREAD
        return np.where(used, with_wind / safe**2, 0.0)

    def slopes(self, time_s: float) -> NDArray[np.float32]:
        """(size, size, 2) slopes along x and y; row along y, column along x, from the corner."""
        phase = np.remainder(self._omega * time_s, 2.0 * np.pi).astype(np.float32)
        turned = self._start * (np.cos(phase) - 1j * np.sin(phase))
        # Both slopes of a real surface in one transform: x in the real, y in the imaginary part.
        height = turned + np.conj(np.roll(turned[::-1, ::-1], 1, axis=(0, 1)))
        both = fft.ifft2(self._along * height, norm="forward", overwrite_x=True)
        return both.view(np.float32).reshape(self.size, self.size, 2)
