"""Keys of the table `[faults]`, and what is refused."""

import pytest

from mjforage.base.errors import UserError
from mjforage.scenario.faults import Faults
from mjforage.scenario.scenario_file import load_scenario, preset_names


@pytest.mark.parametrize("name", preset_names())
def test_shipped_scenarios_have_none(name: str) -> None:
    faults = load_scenario(name).faults
    assert faults == Faults() and not faults.any


def test_a_fault_has_a_vessel_or_a_rate() -> None:
    assert load_scenario("comb-port", ["faults.team=foragers", "faults.left=0.7"]).faults.any
    assert load_scenario("comb-port", ["faults.rate_per_h=0.1"]).faults.any
    assert not load_scenario("comb-port", ["faults.noticed=false"]).faults.any


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["faults.side=both"], "faults: no thruster fails; give faults.team or faults.rate_per_h"),
        (["faults.left=0.5"], "faults: no thruster fails; give faults.team or faults.rate_per_h"),
        (
            ["faults.rate_per_h=1", "faults.side=both"],
            "are of one vessel; give faults.team",
        ),
        (["faults.team=tugs"], "faults.team = 'tugs': no such team; known: scouts, foragers"),
        (["faults.team=scouts", "faults.vessel=2"], "vessel = 2: scouts has 2; count from 0"),
        (["faults.team=scouts", "faults.side=left"], "should be 'port', 'starboard' or 'both'"),
        (["faults.team=scouts", "faults.left=1.5"], "faults.left = 1.5 should be"),
        (["faults.team=scouts", "faults.from_s=-1"], "faults.from_s = -1 should be"),
        (["faults.rate_per_h=-1"], "faults.rate_per_h = -1 should be"),
        (["faults.weak=0.5"], "unknown"),
    ],
)
def test_what_is_refused(overrides: list[str], words: str) -> None:
    with pytest.raises(UserError) as caught:
        load_scenario("comb-port", overrides)
    assert words in str(caught.value) and "\n" not in str(caught.value)
