"""The lee: where it is, how long, and what it leaves of wind and gusts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.forcing import Forcing
from mjforage.forcing.shelter import CALM, shelter_of, upwind_land_m, wind_share
from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario import Weather

PITCH, HEIGHT = 4.0, 3.0
HARBOUR = navigation_graph(load_map("comb_port").navigable, PITCH, False)


def wall(columns: int = 60) -> NavigationGraph:
    """Open water with a block of land, rows 3 to 5 and columns 2 to 4."""
    water = np.ones((9, columns), np.bool_)
    water[3:6, 2:5] = False
    return navigation_graph(water, PITCH, False)


def test_the_calm_is_as_long_as_the_formula_has_it() -> None:
    """W = 1000 H and L = 3 H in Fackrell's formula: 5.37 H; the limit is 5.39 H."""
    whole = 1.8 * 1000 / (3.0**0.3 * (1 + 0.24 * 1000))
    assert pytest.approx(whole, rel=0.005) == CALM


@pytest.mark.parametrize("times", [1.0, 1.5, 2.0, 4.0, 9.0])
def test_wind_recovers_behind_land(times: float) -> None:
    graph = wall()
    shelter = shelter_of(graph, HEIGHT)
    edge, y = graph.metres(np.array([4.0, 4.5]))
    x = edge + times * CALM * HEIGHT
    assert upwind_land_m(shelter, x, y, 2.0, 0.0) == pytest.approx(x - edge, rel=1e-12)
    expected = 1.0 - times**-1.5
    assert wind_share(shelter, x, y, 2.0, 0.0) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("row", "column", "u", "share"),
    [
        (4.0, 6.0, 5.0, 0.0),  # behind
        (4.0, 0.0, 5.0, 1.0),  # before
        (4.0, 0.0, -5.0, 0.0),  # and behind, in the opposite wind
        (1.0, 6.0, 5.0, 1.0),  # beside
        (4.0, 6.0, 0.0, 1.0),  # no wind
        (math.nan, 6.0, 5.0, 1.0),
    ],
)
def test_there_is_a_lee_behind_land_only(row: float, column: float, u: float, share: float) -> None:
    graph = wall()
    x, y = graph.metres(np.array([row, column]))
    assert wind_share(shelter_of(graph, HEIGHT), x, y, u, 0.0) == share


@pytest.mark.parametrize("seed", range(4))
def test_land_upwind_is_found_as_by_small_steps(seed: int) -> None:
    rng, shelter = np.random.default_rng(seed), shelter_of(HARBOUR, HEIGHT)
    for _ in range(40):
        node, angle = rng.integers(len(HARBOUR)), rng.uniform(-math.pi, math.pi)
        off = rng.uniform(-0.49, 0.49, 2)
        rc = np.array([HARBOUR.rows[node], HARBOUR.cols[node]]) + off
        x, y = HARBOUR.metres(rc)
        found = upwind_land_m(shelter, x, y, 3.0 * math.cos(angle), 3.0 * math.sin(angle))
        ways = np.arange(0.0, 400.0, 0.01)
        cells = np.floor(
            rc + np.outer(ways / PITCH, [math.sin(angle), -math.cos(angle)]) + 0.5
        ).astype(int)
        inside = ((cells >= 0) & (cells < HARBOUR.shape)).all(axis=1)
        held = np.clip(cells, 0, np.array(HARBOUR.shape) - 1)
        land = inside & ~HARBOUR.navigable[held[:, 0], held[:, 1]]
        stepped = ways[np.argmax(land)] if land.any() else math.inf
        assert found == pytest.approx(stepped, abs=0.03)


def test_a_field_shelters_wind_and_gusts_and_does_not_without_height() -> None:
    graph, keys = wall(), episode_keys(0, np.arange(2))
    gusty = Weather(wind_speed_mps=5.0, wind_from_deg=270.0, gust_intensity=0.15)
    y = graph.metres(np.array([4.0, 0.0]))[1]
    xy = np.tile(np.array([[0.0, y], [18.5, y], [150.0, y]]), (2, 1, 1))
    bare = Forcing.create(gusty, keys, graph).wind(3.0, xy)
    lees = Forcing.create(replace(gusty, shelter_height_m=HEIGHT), keys, graph)
    share = 1.0 - (CALM * HEIGHT / (150.0 - 18.0)) ** 1.5
    expected = bare * np.array([1.0, 0.0, share])[:, None]
    np.testing.assert_allclose(lees.wind(3.0, xy), expected, rtol=1e-12)
    assert (bare == bare[:, :1]).all()
