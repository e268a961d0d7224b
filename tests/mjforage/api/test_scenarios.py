"""Scenarios and maps as objects: changed, drawn, written and read again."""

import copy
import dataclasses
import pickle
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import mjforage as mf
from mjforage.mission.setup import Setup
from mjforage.scenario.scenario_file import load_scenario


def test_a_shipped_name_is_the_command_lines_scenario() -> None:
    assert mf.load_scenario("comb-port").scenario == load_scenario("comb-port")


def test_changes_are_keys_and_tables_of_which_the_rest_stays() -> None:
    port = mf.load_scenario("comb-port", horizon=60, weather={"wind_speed_mps": np.float64(5)})
    by_text = load_scenario("comb-port", ["horizon=60", "weather.wind_speed_mps=5.0"])
    assert port.scenario == by_text
    assert port.replace(team={"scouts": {"count": 3}}).scenario.team["scouts"].moves == 2
    assert port.scenario.horizon == 60  # itself unchanged


def test_a_map_is_an_array_with_pitch_and_starts(bay: mf.Scenario) -> None:
    assert bay.map.water.shape == (12, 16) and bay.map.water.all()
    assert bay.map.pitch_m == bay.scenario.map.pitch_m == 4.0
    assert bay.map.starts == bay.start_cells == ((2, 5), (5, 5), (8, 5), (10, 5))
    with pytest.raises(ValueError, match="read-only"):
        bay.map.water[0, 0] = False


def test_a_map_by_name_brings_its_own_starts() -> None:
    open_bay = mf.load_scenario("comb-port", map="open-bay")
    assert open_bay.map.name == "open_bay"
    assert open_bay.start_cells == Setup.of(load_scenario("open-bay")).start_cells


def test_the_pitch_of_an_array_is_the_scenarios_unless_given() -> None:
    port = mf.load_scenario("comb-port", map=np.ones((9, 9), int))
    assert port.map.pitch_m == 4.0 and port.map.starts == ()
    wide = mf.load_scenario("comb-port", map=mf.Map(np.ones((9, 9), int), pitch_m=2.5))
    assert wide.graph.pitch_m == 2.5
    assert wide.replace(map=np.ones((5, 5), int)).graph.pitch_m == 2.5


def test_a_map_of_a_file_has_the_starts_beside_it(bay: mf.Scenario, tmp_path: Path) -> None:
    file = bay.map.to_file(tmp_path / "bay.csv")
    assert mf.Map(file).starts == bay.map.starts
    assert mf.Map(file, starts=()).starts == ()


def test_a_file_gives_the_same_scenario_anywhere(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changed = bay.replace(weather={"wind_speed_mps": 3.0}, link={"model": "disk", "range_m": 40.0})
    changed.to_file(tmp_path / "bay.toml")
    monkeypatch.chdir(tmp_path.parent)
    again = mf.load_scenario(tmp_path / "bay.toml")
    assert np.array_equal(again.map.water, changed.map.water)
    mine, theirs = (one.to_dict() for one in (changed, again))
    assert mine.pop("map").keys() == theirs.pop("map").keys()
    assert mine == theirs and again.start_cells == changed.start_cells


def test_a_shipped_map_is_named_in_the_file(tmp_path: Path) -> None:
    mf.load_scenario("channels", horizon=9).to_file(tmp_path / "mine.toml")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]
    assert repr(mf.load_scenario(tmp_path / "mine.toml")).startswith("Scenario(channels, ")


def test_what_a_user_changes_in_a_dict_changes_no_scenario(bay: mf.Scenario) -> None:
    bay.to_dict()["team"]["scouts"]["count"] = 9
    assert bay.to_dict()["team"]["scouts"]["count"] == 2


def test_a_vessel_is_an_object(bay: mf.Scenario) -> None:
    heavy = dataclasses.replace(mf.load_vessel("otter"), name="heavy", mass_kg=90.0)
    changed = bay.replace(physics={"vessels": {"foragers": heavy}})
    file = changed.scenario.physics.vessels["foragers"]
    assert mf.load_vessel(file) == heavy
    assert bay.replace(physics={"vessels": {"foragers": heavy}}).scenario == changed.scenario
    with pytest.raises(mf.UserError, match="vessel light: inertia_z_kgm2"):
        bay.replace(
            physics={
                "vessels": {"foragers": dataclasses.replace(heavy, name="light", cog_x_m=-0.9)}
            }
        )


def test_a_map_is_drawn_with_its_starts(bay: mf.Scenario) -> None:
    [axes] = bay.map.plot().axes
    [marks] = axes.lines
    marked = np.stack((marks.get_ydata(), marks.get_xdata()), axis=1)
    assert marked.tolist() == [list(cell) for cell in bay.map.starts]


@pytest.mark.parametrize("name", ["comb-port", "harbour:combs:7"])
def test_a_map_named_like_another_stays_its_own(
    bay: mf.Scenario, name: str, tmp_path: Path
) -> None:
    mine = bay.replace(map=mf.Map(bay.map.water, name=name))
    again = mf.load_scenario(mine.to_file(tmp_path / "mine.toml"))
    assert np.array_equal(again.map.water, bay.map.water)


def test_scenarios_are_equal_by_value_and_can_be_copied_and_sent(bay: mf.Scenario) -> None:
    sent, other = pickle.loads(pickle.dumps(bay)), bay.replace(horizon=7)  # noqa: S301
    assert copy.deepcopy(bay) == bay == sent != other
    assert len({bay, sent, other}) == 2
    env = gymnasium.make("mjforage/Foraging-v0", scenario=bay)
    assert env.spec is not None and env.spec.kwargs["scenario"] == bay


def test_keys_of_the_map_are_a_table_too(bay: mf.Scenario) -> None:
    assert bay.replace(map={"pitch_m": 3.0}).map.pitch_m == 3.0


def test_a_vessel_that_is_an_object_goes_with_the_scenario(tmp_path: Path) -> None:
    heavy = dataclasses.replace(mf.load_vessel("otter"), name="heavy", mass_kg=90.0)
    bay = mf.load_scenario("open-bay", physics={"vessels": {"foragers": heavy}})
    file = bay.to_file(tmp_path / "bay.toml")
    moved = tmp_path.rename(tmp_path.with_name("elsewhere")) / file.name
    name = mf.load_scenario(moved).to_dict()["physics"]["vessels"]["foragers"]
    assert mf.load_vessel(name).mass_kg == 90.0 and Path(name).parent == moved.parent
