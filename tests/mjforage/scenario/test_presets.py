"""The scenarios that ship."""

from dataclasses import replace
from pathlib import Path

import pytest

from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import (
    load_scenario,
    preset_names,
    scenario_path,
)


@pytest.mark.parametrize("name", preset_names())
def test_preset_loads_onto_its_map_and_is_described(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description
    assert len(Setup.of(scenario).fleet) == 4


def test_default_preset_has_the_numbers_of_the_paper() -> None:
    scenario = load_scenario("comb_port")
    scouts, foragers = scenario.team["scouts"], scenario.team["foragers"]
    assert list(scenario.team) == ["scouts", "foragers"]
    assert (scouts.count, scouts.moves, scouts.radius, scouts.collects) == (2, 2, 4.0, False)
    assert (foragers.count, foragers.moves, foragers.radius, foragers.collects) == (2, 1, 1.0, True)
    assert (scenario.items.mean, scenario.items.std, scenario.items.covariance_node2) == (
        75,
        10,
        20,
    )
    assert (scenario.weather.drift_node_per_step, scenario.horizon) == (0.1, 150)
    assert (scenario.rules.stay, scenario.map.corner_cutting) == (True, False)


def test_published_preset_has_the_rules_of_the_published_experiments() -> None:
    scenario = load_scenario("published")
    assert (scenario.rules.stay, scenario.rules.shorten, scenario.map.corner_cutting) == (
        *(False, False),
        True,
    )
    assert scenario.map.starts == ((10, 7), (12, 7), (14, 7), (16, 7))


@pytest.mark.parametrize("speed", [5, 8])
def test_windy_presets_are_the_weather_with_another_wind(speed: int) -> None:
    calm, windy = load_scenario("comb-port-weather"), load_scenario(f"comb-port-wind-{speed}")
    assert (windy.weather.wind_speed_mps, windy.weather.wind_from_deg) == (speed, None)
    assert windy.prior.drift_node_per_step == pytest.approx(0.03 * speed * 2.5, abs=0.03)
    same = replace(
        windy,
        name=calm.name,
        description=calm.description,
        weather=replace(windy.weather, wind_speed_mps=None),
        prior=calm.prior,
    )
    assert same == calm


def test_preset_wins_over_a_file_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("channels").write_text("nonsense")
    assert scenario_path("channels").suffix == ".toml"
