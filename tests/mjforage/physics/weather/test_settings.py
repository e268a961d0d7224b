from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.weather.settings import WeatherSettings
from mjforage.scenario.scenario import Weather
from mjforage.scenario.schema import rows


def test_every_number_has_a_range_and_keeps_to_it() -> None:
    for row in rows(WeatherSettings):
        low, high = map(float, row.range.split(" to "))
        for bound in (low, high):
            allowed: dict[str, Any] = {row.key: bound}
            assert getattr(WeatherSettings(**allowed), row.key) == bound
        beyond: dict[str, Any] = {row.key: np.nextafter(high, np.inf)}
        with pytest.raises(UserError, match=row.key):
            WeatherSettings(**beyond)


def test_the_papers_drift_in_metres_per_second() -> None:
    settings = WeatherSettings.of_scenario(Weather(), pitch_m=4.0, period_s=10.0)
    assert settings.drawn_drift_mps == pytest.approx(0.04, rel=1e-15)
    assert settings.item_noise_mps == pytest.approx(0.036, rel=1e-15)
    assert settings == WeatherSettings(
        drawn_drift_mps=0.1 * 0.4,
        item_noise_mps=0.09 * 0.4,
        item_noise_period_s=10.0,
        wind_toward_deg=None,
        current_toward_deg=None,
    )


def test_a_wind_comes_from_its_bearing_and_takes_the_drifts_place() -> None:
    weather = Weather(wind_speed_mps=5.0, wind_from_deg=270.0, shelter_height_m=4.0)
    settings = WeatherSettings.of_scenario(weather, pitch_m=4.0, period_s=10.0)
    assert (settings.wind_speed_mps, settings.drawn_drift_mps) == (5.0, 0.0)
    assert (settings.wind_toward_deg, settings.shelter_height_m) == (0.0, 4.0)
    for bearing, toward in ((0.0, 270.0), (90.0, 180.0), (180.0, 90.0), (360.0, 270.0)):
        weather = Weather(wind_speed_mps=5.0, wind_from_deg=bearing)
        settings = WeatherSettings.of_scenario(weather, 4.0, 10.0)
        assert settings.wind_toward_deg == pytest.approx(toward, abs=1e-12)


def test_ranges_of_the_drift_are_of_the_graph_world_alone() -> None:
    weather = Weather(drift_ranges_node_per_step=((0.01, 0.1), (-0.1, 0.1)))
    with pytest.raises(UserError, match="drift_ranges_node_per_step: hulls have no such wind"):
        WeatherSettings.of_scenario(weather, 4.0, 10.0)
