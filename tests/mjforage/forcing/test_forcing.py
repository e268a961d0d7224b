"""Queries: determinism in any company, the paper's drift, directions, gust statistics."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from mjforage.base.errors import UserError
from mjforage.base.randomness import episode_keys
from mjforage.forcing import Forcing
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.initial_state import InitialState, create_initial_state
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario import Items, Weather
from tests.mjforage.mission.by_hand import CALM

PITCH, PERIOD = 4.0, 10.0
HARBOUR = navigation_graph(load_map("comb_port").navigable, PITCH, False)
OPEN = navigation_graph(np.ones((60, 60), np.bool_), PITCH, False)
EVERYTHING = replace(
    CALM,
    wind_speed_mps=4.0,
    wind_from_deg=None,
    gust_intensity=0.15,
    current_speed_mps=0.1,
    current_to_deg=None,
    current_wander_mps=0.05,
    circulation_mps=-0.2,
    noise_node_per_step=0.09,
)


def points(episodes: int, count: int) -> NDArray[np.float64]:
    return np.random.default_rng(5).uniform(-10, 260, (episodes, count, 2))


def field(settings: Weather, episodes: int, seed: int = 0) -> Forcing:
    return Forcing.create(settings, episode_keys(seed, np.arange(episodes)), HARBOUR, PERIOD)


def at_sea(settings: Weather, episodes: int) -> Forcing:
    return Forcing.create(settings, episode_keys(0, np.arange(episodes)))


def test_the_same_bits_in_any_company_and_order() -> None:
    whole, keys = field(EVERYTHING, 9), episode_keys(0, np.arange(9))
    xy, times = points(9, 79), np.linspace(0.0, 1500.0, 9)
    wind, current = whole.wind(times, xy), whole.current(times, xy)
    noise = whole.item_noise(times, 75)
    for e in (8, 3, 0):
        alone = Forcing.create(EVERYTHING, keys[e : e + 1], HARBOUR, PERIOD)
        some = np.array([70, 2, 41])
        here = xy[e : e + 1, some]
        assert (alone.wind(times[e], here)[0] == wind[e, some]).all()
        assert (alone.current(times[e], here)[0] == current[e, some]).all()
        assert (alone.item_noise(times[e], 4)[0] == noise[e, :4]).all()
    for now in np.arange(100)[::-1] * 0.17:
        whole.wind(now, xy), whole.current(now, xy)
    assert (whole.wind(times, xy) == wind).all()
    assert (whole.current(times, xy) == current).all()


def test_every_part_changes_with_what_it_should() -> None:
    whole, rng = field(EVERYTHING, 3), np.random.default_rng(2)
    node = rng.integers(len(HARBOUR), size=(3, 5))
    xy = HARBOUR.metres(np.stack((HARBOUR.rows[node], HARBOUR.cols[node]), axis=-1) + 0.2)
    wind, current = whole.wind(7.0, xy), whole.current(7.0, xy)
    assert np.unique(wind).size == 6 and np.unique(current).size == 30  # a gust is everywhere
    assert (whole.wind(7.1, xy) != wind).all() and (whole.current(7.1, xy) != current).all()
    assert (field(EVERYTHING, 3, seed=1).wind(7.0, xy) != wind).all()


def test_directions_are_where_air_and_water_flow_to() -> None:
    settings = replace(
        CALM, wind_speed_mps=2.0, wind_from_deg=180.0, current_speed_mps=0.3, current_to_deg=270.0
    )
    calm, xy = at_sea(settings, 2), points(2, 3)
    np.testing.assert_allclose(calm.wind(1.0, xy), np.broadcast_to([0, 2.0], xy.shape), atol=1e-15)
    still = np.broadcast_to([-0.3, 0], xy.shape)
    np.testing.assert_allclose(calm.current(1.0, xy), still, atol=1e-15)


@pytest.mark.parametrize("part", ["wind", "current"])
def test_a_drawn_direction_is_uniform_over_the_circle(part: str) -> None:
    options: dict[str, Any] = {f"{part}_speed_mps": 2.0}
    drawn = getattr(field(replace(CALM, **options), 3000), f"mean_{part}_mps")
    np.testing.assert_allclose(np.hypot(*drawn.T), 2.0, rtol=1e-14)
    angle = np.arctan2(drawn[:, 1], drawn[:, 0])
    assert stats.kstest(angle, "uniform", (-math.pi, 2 * math.pi)).pvalue > 0.01


@pytest.mark.parametrize("part", ["wind", "current"])
def test_drawn_speeds_are_uniform_about_the_mean_and_keep_their_directions(part: str) -> None:
    options: dict[str, Any] = {f"{part}_speed_mps": 2.0}
    steady = replace(CALM, **options)
    options = {f"{part}_spread": 0.4}
    spread = replace(steady, **options)
    one, other = (
        getattr(at_sea(given, 4000), part)(0.0, np.zeros((4000, 1, 2)))[:, 0]
        for given in (steady, spread)
    )
    speed = np.hypot(*other.T)
    assert stats.kstest(speed, stats.uniform(1.2, 1.6).cdf).pvalue > 0.01
    np.testing.assert_allclose(other / speed[:, None], one / 2.0, atol=1e-12)
    turned = np.arctan2(*one.T)
    assert abs(np.corrcoef(turned, speed)[0, 1]) < 0.05


def test_wind_and_current_are_drawn_each_for_itself() -> None:
    drawn = at_sea(replace(CALM, wind_speed_mps=1.0, current_speed_mps=1.0), 3000)
    cosine = (drawn.mean_wind_mps * drawn.mean_current_mps).sum(axis=1)
    assert abs(cosine.mean()) < 4 * math.sqrt(0.5 / 3000)


def test_gusts_wander_and_items_water_are_drawn_each_for_itself() -> None:
    weather = replace(EVERYTHING, circulation_mps=0.0, wind_from_deg=270.0, current_to_deg=90.0)
    drawn, here = at_sea(weather, 3000), np.zeros((3000, 1, 2))
    gust = drawn.wind(0.0, here)[:, 0] - drawn.mean_wind_mps
    wander = drawn.current(0.0, here)[:, 0] - drawn.mean_current_mps
    columns = np.concatenate((gust, wander, drawn.item_noise(0.0, 1)[:, 0]), axis=1)
    between = np.corrcoef(columns.T) - np.eye(6)
    assert np.abs(between).max() < 4.5 / math.sqrt(3000)


def paper_world(episodes: int) -> tuple[InitialState, Forcing]:
    keys = episode_keys(3, np.arange(episodes))
    nobody = np.empty(0, np.int32)
    world = create_initial_state(OPEN, Items(covariance_node2=4.0), Weather(), 0.4, nobody, 1, keys)
    return world, Forcing.create(Weather(), keys, OPEN, PERIOD)


def test_the_papers_drift_has_its_distribution_and_is_the_graphs() -> None:
    world, weather = paper_world(3000)
    drift = 0.03 * weather.mean_wind_mps
    for axis in range(2):
        assert stats.kstest(drift[:, axis], "uniform", (-0.04, 0.08)).pvalue > 0.01
    graphs = np.stack((world.drift_rc[:, 1], -world.drift_rc[:, 0]), axis=-1) * PITCH / PERIOD
    np.testing.assert_allclose(drift, graphs, rtol=1e-14)


def test_noise_is_held_for_a_period_even_if_time_was_summed_up() -> None:
    _, weather = paper_world(4)
    summed = sum([0.1] * 300)
    assert summed != 30.0 and summed == pytest.approx(30.0)
    third = weather.item_noise(30.0, 75)
    assert (weather.item_noise(np.array([summed, 30.1, 35.0, 39.99]), 75) == third).all()
    assert (weather.item_noise(29.9, 75) != third).all()
    assert (weather.item_noise(40.0, 75) != third).all()
    assert 0.035 < np.abs(weather.item_noise(0.0, 75)).max() <= 0.036


def test_a_circulation_needs_a_map() -> None:
    with pytest.raises(UserError, match=r"circulation_mps = 0\.2 without a map; give a map, or 0"):
        Forcing.create(replace(CALM, circulation_mps=0.2), episode_keys(0, np.arange(1)))


@pytest.mark.parametrize("name", ["current_speed_mps", "current_wander_mps"])
def test_a_stream_needs_an_open_border(name: str) -> None:
    pond = navigation_graph(np.pad(np.ones((4, 5), np.bool_), 1), PITCH, False)
    given: dict[str, Any] = {name: 0.3}
    settings, keys = replace(CALM, **given), episode_keys(0, np.arange(1))
    remedy = rf"{name} = 0\.3 on a map without water at its edge, .* open the edge, or set weather"
    with pytest.raises(UserError, match=remedy):
        Forcing.create(settings, keys, pond)
    turning = Forcing.create(replace(CALM, circulation_mps=0.3), keys, pond)
    assert turning.current(0.0, np.array([[[8.0, 10.0]]])).any()


def test_streams_are_the_free_stream_in_open_water_and_none_on_land() -> None:
    settings = replace(CALM, current_speed_mps=0.3, current_to_deg=60.0)
    bay = Forcing.create(settings, episode_keys(0, np.arange(1)), OPEN)
    free = 0.3 * np.array([math.cos(math.pi / 6), 0.5])
    inside = np.random.default_rng(3).uniform(-2, 237, (1, 20, 2))
    np.testing.assert_allclose(bay.current(1.0, inside), np.tile(free, (1, 20, 1)), atol=1e-9)
    land = HARBOUR.metres(np.argwhere(~HARBOUR.navigable).astype(np.float64))[None]
    assert np.abs(field(settings, 1).current(1.0, land)).max() < 1e-12
