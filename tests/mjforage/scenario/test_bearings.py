"""Directions are signed or not: a bearing of -90 is one of 270, to the bit."""

from dataclasses import replace

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.forcing import LEEWAY, Forcing
from mjforage.mission.setup import Setup
from mjforage.mission.trajectory import TrajectoryRecorder
from mjforage.physics.manoeuvre import parse_flow
from mjforage.physics.worlds import create_mission
from mjforage.scenario.bearings import direction
from mjforage.scenario.place import Place
from mjforage.scenario.scenario import Weather
from mjforage.scenario.scenario_file import load_scenario

SAME = [(-90.0, 270.0), (-180.0, 180.0), (-37.5, 322.5), (-360.0, 0.0), (360.0, 0.0)]


@pytest.mark.parametrize(("signed", "plain"), SAME)
def test_a_bearing_is_one_direction_however_it_is_written(signed: float, plain: float) -> None:
    assert direction(signed) == direction(plain) == np.radians(plain)
    assert parse_flow(f"8@{signed}", "--wind") == parse_flow(f"8@{plain}", "--wind")
    keys = episode_keys(0, np.arange(2))
    states, fields = [], []
    for degrees in (signed, plain):
        keys_ = (f"weather.wind_from_deg={degrees}", f"weather.current_to_deg={degrees}")
        wind = ("weather.wind_speed_mps=5", "weather.current_speed_mps=0.1")
        setup = Setup.of(load_scenario("open-bay", (*wind, *keys_)))
        states.append(setup.create_initial_state(keys))
        weather = setup.scenario.weather
        fields.append(Forcing.create(weather, keys, setup.graph, 10.0))
    assert np.array_equal(states[0].drift_rc, states[1].drift_rc)
    assert np.array_equal(fields[0].mean_wind_mps, fields[1].mean_wind_mps)
    assert np.array_equal(fields[0].mean_current_mps, fields[1].mean_current_mps)


def test_an_oblique_flow_is_counter_clockwise_from_east() -> None:
    """2 m/s at 30 degrees: the root of 3 to the east, 1 to the north."""
    assert parse_flow("2@30", "--wind") == pytest.approx((np.sqrt(3.0), 1.0))
    assert parse_flow("2@-60", "--current") == pytest.approx((1.0, -np.sqrt(3.0)))


def test_a_rotated_place_turns_bearings_once() -> None:
    """Columns point to 30 degrees: a wind from there comes from straight up, water to 120 goes
    right, and by compass both are what they were.
    """
    setup = Setup.of(load_scenario("open-bay", ("weather.wind_speed_mps=5", "horizon=4")))
    place = Place(50.0, 8.0, 4.0, 1, 1, rotation_deg=30.0)
    weather = Weather(5.0, 30.0, current_speed_mps=0.1, current_to_deg=120.0)
    scenario = replace(setup.scenario, weather=weather)
    turned = Setup.of(scenario, setup.grid.navigable, "turned", place)
    keys = episode_keys(0, np.arange(1))
    down = LEEWAY * 5.0 * scenario.period_s / 4.0
    np.testing.assert_allclose(turned.create_initial_state(keys).drift_rc, [[down, 0]], atol=1e-12)
    for world in ("graph", "physics"):
        recorder = TrajectoryRecorder()
        mission = create_mission(turned, world, recorder)
        mission.reset(0, np.arange(1))
        np.testing.assert_allclose(recorder.frames.wind, [[0, -5.0]], atol=1e-6)
    forcing = Forcing.create(weather, keys, turned.graph, 10.0, place)
    np.testing.assert_allclose(forcing.mean_current_mps, [[0.1, 0.0]], atol=1e-15)
