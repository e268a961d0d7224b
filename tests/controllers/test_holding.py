"""Keeping position with free heading: within 0.5 m RMS after 30 s."""

import numpy as np
import pytest

from mjforage.physics.vessels import load_vessel
from mjforage.scenario.scenario import Weather
from tests.controllers.plant import beam_gusts, cross_current, sail
from tests.mjforage.mission.by_hand import CALM

SETTLED = 300  # ticks
YAWS = np.linspace(-np.pi, np.pi, 9)[:-1]
TARGET = (0.0, 0.0)


@pytest.mark.parametrize("name", ["scout", "forager", "ideal"])
@pytest.mark.parametrize(
    ("weather", "noise_m"),
    [
        (CALM, 0.0),
        (cross_current(), 0.0),
        (beam_gusts(), 0.0),
        (beam_gusts(current=True), 0.0),
        (beam_gusts(), 0.3),
    ],
    ids=["calm", "current", "gusts", "both", "gusts and noise"],
)
def test_station_keeping(name: str, weather: Weather, noise_m: float) -> None:
    track = sail(load_vessel(name), YAWS, TARGET, 60.0, stay=True, weather=weather, noise_m=noise_m)
    off = track.off(TARGET)[SETTLED:]
    assert np.sqrt((off**2).mean(axis=0)).max() <= 0.5


def test_in_calm_water_it_lies_still() -> None:
    track = sail(load_vessel("scout"), YAWS, TARGET, 20.0, stay=True)
    assert track.off(TARGET).max() < 0.01
    assert np.abs(track.pose[..., 2] - YAWS).max() < 0.01
