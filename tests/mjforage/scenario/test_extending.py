"""Scenario files that extend another scenario."""

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest

from mjforage.base.errors import UserError
from mjforage.cli.schemas import schema_text
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario, scenario_to_tree


def written(folder: Path, name: str, text: str) -> str:
    path = folder / f"{name}.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_what_is_not_given_is_as_in_the_other_scenario(tmp_path: Path) -> None:
    mine = written(
        tmp_path,
        "mine",
        'extends = "comb-port"\nhorizon = 40\n[team.scouts]\ncount = 3\n'
        "[weather]\nwind_speed_mps = 5",
    )
    found, base = (scenario_to_tree(load_scenario(one)) for one in (mine, "comb-port"))
    assert found["name"] == "mine"
    assert found["team"]["scouts"] == base["team"]["scouts"] | {"count": 3}
    base |= {key: found[key] for key in ("name", "horizon")}
    base["team"]["scouts"]["count"], base["weather"]["wind_speed_mps"] = 3, 5.0
    assert found == base


def test_a_chain_of_files_has_paths_from_each_of_their_folders(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "pond.csv").write_text("1,1,1\n1,1,1\n")
    below = 'extends = "open-bay"\nname = "pond"\n[map]\nfile = "pond.csv"\npitch_m = 3.0\n'
    written(tmp_path / "maps", "pond", below)
    found = load_scenario(
        written(tmp_path, "top", 'extends = "maps/pond.toml"\n[team.foragers]\ncount = 0')
    )
    assert (found.name, found.map.file) == ("top", str(tmp_path / "maps" / "pond.csv"))
    assert (found.map.pitch_m, found.map.starts) == (3.0, None)  # none of the bay
    assert found.team["foragers"].count == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("extends = 3", "scenario mine: extends = 3, expected the name"),
        ('extends = "comb-prot"', "scenario .*comb-prot"),
        ('extends = "mine.toml"', "scenario mine: extends = 'mine.toml': leads back to mine.toml"),
        ('extends = "other.toml"', "scenario other: extends = 'mine.toml': leads back"),
        ('extends = "comb-port"\nhorizn = 3', "scenario mine: unknown key horizn"),
        ('extends = "comb-port"\nteam = 3', "scenario mine: team = 3"),
    ],
)
def test_what_cannot_be_extended_is_one_line(tmp_path: Path, text: str, words: str) -> None:
    written(tmp_path, "other", 'extends = "mine.toml"')
    with pytest.raises(UserError, match=words) as told:
        load_scenario(written(tmp_path, "mine", text))
    assert "\n" not in str(told.value)


def test_the_schema_asks_for_less_where_a_file_extends() -> None:
    schema = json.loads(schema_text("scenario", Scenario))
    short = 'extends = "comb-port"\n[team.scouts]\ncount = 3'
    jsonschema.validate(tomllib.loads(short), schema)
    for lacking in (short.partition("\n")[2], 'extends = "comb-port"\n[team.scouts]\ncounts = 3'):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(tomllib.loads(lacking), schema)
