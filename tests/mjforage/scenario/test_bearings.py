"""Directions are signed or not: a bearing of -90 is one of 270, to the bit."""

import numpy as np
import pytest

from mjforage.base.randomness import episode_keys
from mjforage.mission.setup import Setup
from mjforage.physics.manoeuvre import parse_flow
from mjforage.physics.weather.field import Field
from mjforage.physics.weather.settings import WeatherSettings
from mjforage.scenario.bearings import direction
from mjforage.scenario.scenario_file import load_scenario

SAME = [(-90.0, 270.0), (-180.0, 180.0), (-37.5, 322.5), (-360.0, 0.0), (360.0, 0.0)]


@pytest.mark.parametrize(("signed", "plain"), SAME)
def test_a_bearing_is_one_direction_however_it_is_written(signed: float, plain: float) -> None:
    assert direction(signed) == direction(plain) == np.radians(plain)
    assert parse_flow(f"8@{signed}", "--wind") == parse_flow(f"8@{plain}", "--wind")
    keys = episode_keys(0, np.arange(2))
    states, fields = [], []
    for degrees in (signed, plain):
        keys_ = (f"weather.wind_from_deg={degrees}", f"weather.current_toward_deg={degrees}")
        wind = ("weather.wind_speed_mps=5", "weather.current_speed_mps=0.1")
        setup = Setup.of(load_scenario("open-bay", (*wind, *keys_)))
        states.append(setup.create_initial_state(keys))
        weather = setup.scenario.weather
        fields.append(Field.create(WeatherSettings.of_scenario(weather, 4.0, 10.0), keys))
    assert np.array_equal(states[0].drift_rc, states[1].drift_rc)
    assert np.array_equal(fields[0].mean_wind_mps, fields[1].mean_wind_mps)
    assert np.array_equal(fields[0].mean_current_mps, fields[1].mean_current_mps)


def test_an_oblique_flow_is_counter_clockwise_from_east() -> None:
    """2 m/s at 30 degrees: the root of 3 to the east, 1 to the north."""
    assert parse_flow("2@30", "--wind") == pytest.approx((np.sqrt(3.0), 1.0))
    assert parse_flow("2@-60", "--current") == pytest.approx((1.0, -np.sqrt(3.0)))
