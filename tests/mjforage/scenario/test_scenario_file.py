"""Scenario files: what is read, overridden, written and hashed."""

import json
import shutil
from pathlib import Path

import pytest

from mjforage.mission.setup import Setup
from mjforage.physics.vessels import load_vessel
from mjforage.scenario.assets import models_folder
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario_file import (
    canonical_json,
    load_scenario,
    preset_names,
    scenario_from_tree,
    scenario_to_tree,
)
from tests.mjforage.scenario.written_scenarios import MINIMAL, TEAMS, write


@pytest.mark.parametrize("name", preset_names())
def test_canonical_json_comes_back_as_the_same_scenario(name: str) -> None:
    scenario = load_scenario(name, ["team.scouts.energy=80", "map.pitch_m=2"])
    text = canonical_json(scenario_to_tree(scenario))
    again = scenario_from_tree(json.loads(text), "again")
    assert again == scenario
    assert list(again.team) == list(scenario.team)
    assert canonical_json(scenario_to_tree(again)) == text


def test_canonical_json_tells_the_order_of_teams(tmp_path: Path) -> None:
    one = write(tmp_path, MINIMAL)
    text = canonical_json(scenario_to_tree(load_scenario(one)))
    first, second = TEAMS.split("\n\n")
    swapped = write(tmp_path, f'name = "mine"\n[map]\nfile = "open_bay"\n{second}\n{first}')
    assert canonical_json(scenario_to_tree(load_scenario(swapped))) != text


def test_overrides_apply_in_order_and_create_tables() -> None:
    scenario = load_scenario(
        "comb-port",
        ["horizon=7", "horizon=9", "corruption.team=scouts", "corruption.epsilon=0.5", "name=x-1"],
    )
    assert (scenario.horizon, scenario.name) == (9, "x-1")
    assert (scenario.corruption.team, scenario.corruption.epsilon) == ("scouts", 0.5)


def test_overrides_take_lists_and_quoted_text() -> None:
    scenario = load_scenario("comb-port", ["map.starts=[[10,7], [12,7]]", "description='a = b'"])
    assert scenario.map.starts == ((10, 7), (12, 7))
    assert scenario.description == "a = b"
    assert load_scenario("comb-port", ["map.starts=[]"]).map.starts == ()


def test_map_replaces_only_the_grid() -> None:
    plain, other = load_scenario("published"), load_scenario("published", map_file="open_bay")
    tree = scenario_to_tree(plain)
    tree["map"]["file"] = "open_bay"
    assert scenario_to_tree(other) == tree


@pytest.mark.parametrize("team", ["scouts", "foragers"])
def test_a_team_may_be_empty(team: str) -> None:
    scenario = load_scenario("comb-port", [f"team.{team}.count=0"])
    assert len(Setup.of(scenario).fleet) == 2


def test_paths_in_a_file_start_from_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of overrides start from the working directory, and shipped names are no paths."""
    folder, elsewhere = tmp_path / "mine", tmp_path / "elsewhere"
    for place, cells in ((folder, "1,1,1\n"), (elsewhere, "1,1\n")):
        place.mkdir()
        (place / "bay.csv").write_text(cells)
    shutil.copy(models_folder() / "vessels" / "otter.toml", folder / "hull.toml")
    text = MINIMAL.replace('"open_bay"', '"bay.csv"')
    text += '[physics.vessels]\npilots = "hull.toml"\nskimmers = "otter"\n'
    (folder / "mine.toml").write_text(text)
    monkeypatch.chdir(elsewhere)
    for reference in (str(folder / "mine.toml"), "../mine/mine.toml"):
        scenario = load_scenario(reference)
        assert load_map(scenario.map.file).navigable.shape == (1, 3)
        assert load_vessel(scenario.physics.vessels["pilots"]).name == "hull"
        assert scenario.physics.vessels["skimmers"] == "otter"
    for overridden in (
        load_scenario(reference, ["map.file=bay.csv"]),
        load_scenario(reference, map_file="bay.csv"),
    ):
        assert load_map(overridden.map.file).navigable.shape == (1, 2)
    for name in ("open-bay", "harbour:basins:5:40x50"):
        (folder / "named.toml").write_text(text.replace("bay.csv", name))
        assert load_scenario(str(folder / "named.toml")).map.file == name
