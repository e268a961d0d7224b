"""Gusts, currents and wind that episodes draw, and a circulation that keeps to its harbour."""

import math
from dataclasses import replace

import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.forcing import Forcing
from mjforage.forcing.flow import LAYER
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.physics.vessel_checks import Float64Array
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario import Weather
from tests.mjforage.mission.by_hand import CALM
from tests.mjforage.physics.validation.measures import Measures, at_most, check, near, near_share

PITCH_M, PEAK_MPS = 4.0, 0.3
CHANNEL = (8, 70)  # nodes across and along
EPISODES, ITEMS, HELD_S = 4000, 20, 10.0
WANDER_MPS, WANDER_S, NOISE_MPS, DRIFT_MPS, LEEWAY = 0.1, 600.0, 0.036, 0.04, 0.03
MEAN_MPS, INTENSITY, TAU_S = 6.0, 0.15, 2.0
SIGMA, ACROSS = INTENSITY * MEAN_MPS, 0.8
GUSTS, SAMPLES = 1500, 256
_WINDOW = np.hanning(SAMPLES + 1)[:-1]


@check("gusts", "11")
def gusts() -> Measures:
    """Gusts of 0.15 of a wind of 6 m/s with a memory of 2 s, sampled every 0.05, 0.2 and 1 s.

    Standard deviation, correlation time from neighbouring samples, and spectrum, over 1,500
    episodes, against variance s^2, autocorrelation exp(-lag / tau) and the periodogram that the
    process has in closed form. Across the wind 0.8 of the deviation along it (IEC 61400-1, annex
    B), and nothing in common with it. Limits are four times the sampling error or more.
    """
    found: Measures = []
    for step in (0.05, 0.2, 1.0):
        series, across = _sampled(step)
        shared = (series * across).mean() / (ACROSS * SIGMA**2)
        neighbours = float((series[:, 1:] * series[:, :-1]).mean() / (series**2).mean())
        time = -step / math.log(neighbours) if 0.0 < neighbours < 1.0 else math.nan
        ratio = (_periodogram(step, series) / _expected_periodogram(step)).mean()
        label = f"every {step:g} s"
        found += [
            near_share(f"{label}: standard deviation", series.std(), SIGMA, 0.04, "m/s"),
            near_share(f"{label}: correlation time", time, TAU_S, 0.06, "s"),
            near_share(f"{label}: spectrum over closed form", ratio, 1.0, 0.10),
            near_share(f"{label}: across the wind", across.std(), ACROSS * SIGMA, 0.04, "m/s"),
            near(f"{label}: correlation of along and across", shared, 0.0, 0.04),
        ]
    return found


def _sampled(step_s: float) -> tuple[Float64Array, Float64Array]:
    """(episode, sample) gusts along and across the wind [m/s]."""
    settings = Weather(MEAN_MPS, 270.0, gust_intensity=INTENSITY, gust_tau_s=TAU_S)
    field = Forcing.create(settings, episode_keys(7, np.arange(GUSTS)))
    here = np.zeros((GUSTS, 1, 2))
    rows = [field.wind(30.0 + step_s * k, here)[:, 0] for k in range(SAMPLES)]
    along, across = np.moveaxis(np.stack(rows, axis=1), -1, 0)
    return along - MEAN_MPS, across


def _periodogram(step: float, series: Float64Array) -> Float64Array:
    """(frequency,) one-sided power density under a Hann window, mean of the episodes [m2/s2 / Hz].

    The window keeps the slow gusts, which are strong, from leaking into the fast ones.
    """
    power = (np.abs(np.fft.rfft(series * _WINDOW)) ** 2).mean(axis=0)
    return np.asarray(2.0 * step / (_WINDOW @ _WINDOW) * power)


def _expected_periodogram(step: float) -> Float64Array:
    """Mean of `_periodogram` of the process: its autocovariance times that of the window."""
    overlap = np.correlate(_WINDOW, _WINDOW, "full")[SAMPLES - 1 :] / (_WINDOW @ _WINDOW)
    covariance = SIGMA**2 * np.exp(-step * np.arange(SAMPLES) / TAU_S) * overlap
    turns = np.outer(np.arange(SAMPLES // 2 + 1), np.arange(SAMPLES)) / SAMPLES
    cosines = np.cos(2.0 * np.pi * turns)
    return np.asarray(2.0 * step * (2.0 * cosines @ covariance - covariance[0]))


@check("circulation", "15a")
def circulation() -> Measures:
    """A circulation of 0.3 m/s in the default port and in a closed channel of 32 x 280 m.

    At all quays of the port nothing flows through or along; its fastest water has 0.3 m/s. Amid the
    channel the flow is that of friction, viscosity and wind stress of curl 1 in closed form,
    u = h sinh(y/L) / sinh(h/L) - y, counter-clockwise.
    """
    port = navigation_graph(load_map("comb_port").navigable, PITCH_M, False)
    rng = np.random.default_rng(0)
    node = rng.integers(len(port), size=40_000)
    places = np.stack((port.rows[node], port.cols[node]), axis=-1) + rng.uniform(
        -0.5, 0.5, (node.size, 2)
    )
    fastest = np.hypot(*_flow(port, port.metres(places)).T).max()
    at_quays = np.hypot(*_flow(port, _faces(port)).T).max()
    found, exact = _profile()
    scale = float(exact @ found / (exact @ exact))
    off = np.abs(found / scale - exact).max() / exact.max()
    return [
        at_most("port: at quays", at_quays, 1e-12, "m/s"),
        near_share("port: fastest", fastest, PEAK_MPS, 0.02, "m/s"),
        near_share("channel: fastest", scale * exact.max(), PEAK_MPS, 0.02, "m/s"),
        at_most("channel: off the closed form", off, 0.005),
    ]


def _flow(graph: NavigationGraph, xy: Float64Array) -> Float64Array:
    """(point, 2) current at points [m/s]."""
    settings = replace(CALM, circulation_mps=PEAK_MPS)
    field = Forcing.create(settings, episode_keys(0, np.arange(1)), graph)
    return np.asarray(field.current(0.0, xy[None])[0])


def _faces(graph: NavigationGraph) -> Float64Array:
    """(point, 2) along every face between water and land, the map's rim included [m]."""
    water, points = np.pad(graph.navigable, 1), []
    along = np.linspace(-0.5, 0.5, 17)
    for down, right in ((0, 1), (1, 0), (0, -1), (-1, 0)):
        land = ~np.roll(water, (-down, -right), (0, 1))
        for row, col in np.argwhere(water & land) - 1:
            rows = row + 0.5 * down + along * abs(right)
            points.append(graph.metres(np.stack((rows, col + 0.5 * right + along * abs(down)), -1)))
    return np.concatenate(points)


def _profile() -> tuple[Float64Array, Float64Array]:
    """(point,) current to the east across the channel, and the closed form."""
    graph = navigation_graph(np.ones(CHANNEL, np.bool_), PITCH_M, False)
    half, layer = 0.5 * CHANNEL[0] * PITCH_M, LAYER * PITCH_M
    y = np.linspace(-half, half, 101)
    middle = np.full(y.size, 0.5 * (CHANNEL[1] - 1) * PITCH_M)
    found = _flow(graph, np.stack((middle, y + half - 0.5 * PITCH_M), axis=-1))[:, 0]
    return found, half * np.sinh(y / layer) / math.sinh(half / layer) - y


@check("drawn-weather", "15b")
def drawn_weather() -> Measures:
    """Over 4,000 episodes: a current that wanders by 0.1 m/s with a memory of 600 s.

    Deviation per axis and correlation after 300 s, exp(-1/2). Items' own water, uniform in 0.036
    m/s either way: deviation 0.036 / sqrt(3), held for a period of 10 s, new in the next, another
    for each item. A wind that drives items of 3 % leeway at up to 0.04 m/s per axis. Limits are
    four times the sampling error or more.
    """
    settings = replace(
        CALM,
        current_wander_mps=WANDER_MPS,
        noise_node_per_step=NOISE_MPS * HELD_S,
        drift_node_per_step=DRIFT_MPS * HELD_S,
    )
    field = Forcing.create(settings, episode_keys(3, np.arange(EPISODES)), period_s=HELD_S)
    return [*_wander(field), *_noise(field), *_wind(field)]


def _wander(field: Forcing) -> Measures:
    here = np.zeros((EPISODES, 1, 2))
    now, later = (field.current(t, here)[:, 0] for t in (1000.0, 1300.0))
    memory = (now * later).mean() / (now * now).mean()
    return [
        near_share("wandering current, per axis", now.std(), WANDER_MPS, 0.04, "m/s"),
        near("its correlation after 300 s", memory, math.exp(-300.0 / WANDER_S), 0.04),
    ]


def _noise(field: Forcing) -> Measures:
    first, held, later = (field.item_noise(t, ITEMS) for t in (40.0, 49.9, 50.0))
    spread = NOISE_MPS / math.sqrt(3.0)
    beside = (first[:, 1:] * first[:, :-1]).mean() / spread**2
    after = (first * later).mean() / spread**2
    return [
        near_share("items' own water, per axis", first.std(), spread, 0.01, "m/s"),
        at_most("its largest", np.abs(first).max(), NOISE_MPS, "m/s"),
        at_most("its change within a period", np.abs(held - first).max(), 0.0, "m/s"),
        near("its correlation between items", beside, 0.0, 0.02),
        near("its correlation with the next period", after, 0.0, 0.02),
    ]


def _wind(field: Forcing) -> Measures:
    drift = LEEWAY * field.wind(0.0, np.zeros((EPISODES, 1, 2)))[:, 0]
    spread = DRIFT_MPS / math.sqrt(3.0)
    return [
        near_share("drift in the drawn wind, per axis", drift.std(), spread, 0.03, "m/s"),
        near("its mean", drift.mean(), 0.0, 0.03 * DRIFT_MPS, "m/s"),
        at_most("its largest", np.abs(drift).max(), DRIFT_MPS, "m/s"),
    ]
