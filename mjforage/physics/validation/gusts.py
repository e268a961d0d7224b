"""Gusts are the Ornstein-Uhlenbeck process whatever the time step."""

import dataclasses
import math

import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.physics.validation.finding import Float64Array, Line, Measure, Panel, near, near_share
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.weather import Field, WeatherSettings

MEAN_MPS, INTENSITY, TAU_S = 6.0, 0.15, 2.0
SIGMA = INTENSITY * MEAN_MPS
ACROSS = 0.8
STEPS_S = (0.05, 0.2, 1.0)
EPISODES, SAMPLES = 1500, 256
_WINDOW = np.hanning(SAMPLES + 1)[:-1]


@check("gusts", "11", "Gusts do not depend on the time step")
def gusts() -> Parts:
    """Gusts of 0.15 of a wind of 6 m/s with a memory of 2 s, sampled every 0.05, 0.2 and 1 s.

    Standard deviation, correlation time from neighbouring samples, and spectrum, over 1,500
    episodes, against variance s^2, autocorrelation exp(-lag / tau) and the periodogram that the
    process has in closed form. Across the wind 0.8 of the deviation along it (IEC 61400-1, annex
    B), and nothing in common with it. Limits are four times the sampling error or more.
    """
    measures: list[Measure] = []
    memory: list[Line] = []
    spectra: list[Line] = []
    for colour, step in enumerate(STEPS_S):
        series, across = sampled(step)
        label = f"every {step:g} s"
        measures += _measures(label, step, series)
        shared = float((series * across).mean()) / (ACROSS * SIGMA**2)
        measures += [
            near_share(
                f"{label}: across the wind", float(across.std()), ACROSS * SIGMA, 0.04, "m/s"
            ),
            near(f"{label}: correlation of along and across", shared, 0.0, 0.04),
        ]
        memory.append(_autocorrelation(label, step, series, colour))
        spectra.append(_spectrum(label, step, periodogram(step, series), colour))
        form = _spectrum("closed form", step, expected_periodogram(step), 0)
        spectra.append(dataclasses.replace(form, points=False, expected=True))
    lags = np.linspace(0.0, 8.0, 200)
    memory.append(Line("exp(−lag / τ)", lags, np.exp(-lags / TAU_S), expected=True))
    return tuple(measures), (
        Panel("Autocorrelation", "lag (s)", "correlation", tuple(memory)),
        Panel("Spectrum", "frequency (Hz)", "m²/s² per Hz", tuple(spectra), log_x=True, log_y=True),
    )


def sampled(step_s: float) -> tuple[Float64Array, Float64Array]:
    """(episode, sample) gusts along and across the wind [m/s]."""
    settings = WeatherSettings(wind_speed_mps=MEAN_MPS, gust_intensity=INTENSITY, gust_tau_s=TAU_S)
    field = Field.create(settings, episode_keys(7, np.arange(EPISODES)))
    here = np.zeros((EPISODES, 1, 2))
    rows = [field.wind(30.0 + step_s * k, here)[:, 0] for k in range(SAMPLES)]
    along, across = np.moveaxis(np.stack(rows, axis=1), -1, 0)
    return along - MEAN_MPS, across


def _measures(label: str, step: float, series: Float64Array) -> list[Measure]:
    deviation = float(series.std())
    neighbours = float((series[:, 1:] * series[:, :-1]).mean() / (series**2).mean())
    time = -step / math.log(neighbours) if 0.0 < neighbours < 1.0 else math.nan
    ratio = float((periodogram(step, series) / expected_periodogram(step)).mean())
    return [
        near_share(f"{label}: standard deviation", deviation, SIGMA, 0.04, "m/s"),
        near_share(f"{label}: correlation time", time, TAU_S, 0.06, "s"),
        near_share(f"{label}: spectrum over closed form", ratio, 1.0, 0.10),
    ]


def _autocorrelation(label: str, step: float, series: Float64Array, colour: int) -> Line:
    most = min(SAMPLES - 1, round(8.0 / step))
    lags = np.unique(np.linspace(0, most, 17).astype(int))
    power = float((series**2).mean())
    values = [float((series[:, : SAMPLES - k] * series[:, k:]).mean()) / power for k in lags]
    return Line(label, step * lags, np.array(values), colour, points=True)


def periodogram(step: float, series: Float64Array) -> Float64Array:
    """(frequency,) one-sided power density under a Hann window, mean of the episodes [m2/s2 / Hz].

    The window keeps the slow gusts, which are strong, from leaking into the fast ones.
    """
    power = (np.abs(np.fft.rfft(series * _WINDOW)) ** 2).mean(axis=0)
    return np.asarray(2.0 * step / (_WINDOW @ _WINDOW) * power)


def expected_periodogram(step: float) -> Float64Array:
    """Mean of `periodogram` of the process: its autocovariance times that of the window."""
    overlap = np.correlate(_WINDOW, _WINDOW, "full")[SAMPLES - 1 :] / (_WINDOW @ _WINDOW)
    covariance = SIGMA**2 * np.exp(-step * np.arange(SAMPLES) / TAU_S) * overlap
    turns = np.outer(np.arange(SAMPLES // 2 + 1), np.arange(SAMPLES)) / SAMPLES
    cosines = np.cos(2.0 * np.pi * turns)
    return np.asarray(2.0 * step * (2.0 * cosines @ covariance - covariance[0]))


def _spectrum(label: str, step: float, power: Float64Array, colour: int) -> Line:
    """Means over bands of frequency that widen with it."""
    f, power = np.fft.rfftfreq(SAMPLES, step)[1:-1], power[1:-1]
    edges = np.unique(np.geomspace(1, f.size + 1, 22).astype(int)) - 1
    counts = np.diff(edges)
    middle = np.add.reduceat(f, edges[:-1]) / counts
    mean = np.add.reduceat(power, edges[:-1]) / counts
    return Line(label, middle, mean, colour, points=True)
