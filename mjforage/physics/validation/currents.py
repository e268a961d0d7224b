"""Water and wind that episodes draw, and a circulation that keeps to its harbour."""

import math

import numpy as np

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.physics.validation.finding import (
    Float64Array,
    Line,
    Measure,
    Panel,
    at_most,
    near,
    near_share,
)
from mjforage.physics.validation.known_checks import Parts, check
from mjforage.physics.weather import Field, WeatherSettings
from mjforage.physics.weather.flow import LAYER
from mjforage.scenario.maps import load_map

PITCH_M, PEAK_MPS = 4.0, 0.3
CHANNEL = (8, 70)  # nodes across and along
EPISODES, ITEMS = 4000, 20
WANDER_MPS, WANDER_S = 0.1, 600.0
NOISE_MPS, PERIOD_S = 0.036, 10.0
DRIFT_MPS, LEEWAY = 0.04, 0.03


@check("circulation", "15a", "The circulation keeps to its harbour")
def circulation() -> Parts:
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
    fastest = float(np.hypot(*_flow(port, port.metres(places)).T).max())
    at_quays = float(np.hypot(*_flow(port, _faces(port)).T).max())
    y, found, exact = _profile()
    scale = float(exact @ found / (exact @ exact))
    off = float(np.abs(found / scale - exact).max() / exact.max())
    panel = Panel(
        "Across a channel",
        "from the middle (m)",
        "current to the east (m/s)",
        (Line("found", y, found), Line("closed form", y, scale * exact, expected=True)),
    )
    return (
        at_most("port: at quays", at_quays, 1e-12, "m/s"),
        near_share("port: fastest", fastest, PEAK_MPS, 0.02, "m/s"),
        near_share("channel: fastest", scale * float(exact.max()), PEAK_MPS, 0.02, "m/s"),
        at_most("channel: off the closed form", off, 0.005),
    ), (panel,)


def _flow(graph: NavigationGraph, xy: Float64Array) -> Float64Array:
    """(point, 2) current at points [m/s]."""
    settings = WeatherSettings(circulation_mps=PEAK_MPS)
    field = Field.create(settings, episode_keys(0, np.arange(1)), graph)
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


def _profile() -> tuple[Float64Array, Float64Array, Float64Array]:
    """(point,) places across the channel, the current there to the east, the closed form."""
    graph = navigation_graph(np.ones(CHANNEL, np.bool_), PITCH_M, False)
    half, layer = 0.5 * CHANNEL[0] * PITCH_M, LAYER * PITCH_M
    y = np.linspace(-half, half, 101)
    middle = np.full(y.size, 0.5 * (CHANNEL[1] - 1) * PITCH_M)
    found = _flow(graph, np.stack((middle, y + half - 0.5 * PITCH_M), axis=-1))[:, 0]
    return y, found, half * np.sinh(y / layer) / math.sinh(half / layer) - y


@check("drawn-weather", "15b", "Wandering current, items' own water, drawn wind")
def drawn_weather() -> Parts:
    """Over 4,000 episodes: a current that wanders by 0.1 m/s with a memory of 600 s.

    Deviation per axis and correlation after 300 s, exp(-1/2). Items' own water, uniform in 0.036
    m/s either way: deviation 0.036 / sqrt(3), held for a period of 10 s, new in the next, another
    for each item. A wind that drives items of 3 % leeway at up to 0.04 m/s per axis. Limits are
    four times the sampling error or more.
    """
    settings = WeatherSettings(
        current_wander_mps=WANDER_MPS,
        item_noise_mps=NOISE_MPS,
        item_noise_period_s=PERIOD_S,
        drawn_drift_mps=DRIFT_MPS,
    )
    field = Field.create(settings, episode_keys(3, np.arange(EPISODES)))
    return (*_wander(field), *_noise(field), *_wind(field)), ()


def _wander(field: Field) -> list[Measure]:
    here = np.zeros((EPISODES, 1, 2))
    now, later = (field.current(t, here)[:, 0] for t in (1000.0, 1300.0))
    memory = float((now * later).mean() / (now * now).mean())
    return [
        near_share("wandering current, per axis", float(now.std()), WANDER_MPS, 0.04, "m/s"),
        near("its correlation after 300 s", memory, math.exp(-300.0 / WANDER_S), 0.04),
    ]


def _noise(field: Field) -> list[Measure]:
    first, held, later = (field.item_noise(t, ITEMS) for t in (40.0, 49.9, 50.0))
    spread = NOISE_MPS / math.sqrt(3.0)
    beside = float((first[:, 1:] * first[:, :-1]).mean()) / spread**2
    after = float((first * later).mean()) / spread**2
    return [
        near_share("items' own water, per axis", float(first.std()), spread, 0.01, "m/s"),
        at_most("its largest", float(np.abs(first).max()), NOISE_MPS, "m/s"),
        at_most("its change within a period", float(np.abs(held - first).max()), 0.0, "m/s"),
        near("its correlation between items", beside, 0.0, 0.02),
        near("its correlation with the next period", after, 0.0, 0.02),
    ]


def _wind(field: Field) -> list[Measure]:
    drift = LEEWAY * field.wind(0.0, np.zeros((EPISODES, 1, 2)))[:, 0]
    spread = DRIFT_MPS / math.sqrt(3.0)
    return [
        near_share("drift in the drawn wind, per axis", float(drift.std()), spread, 0.03, "m/s"),
        near("its mean", float(drift.mean()), 0.0, 0.03 * DRIFT_MPS, "m/s"),
        at_most("its largest", float(np.abs(drift).max()), DRIFT_MPS, "m/s"),
    ]
