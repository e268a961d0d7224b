import json
import math
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mjforage.core.assets import models_folder
from mjforage.core.errors import UserError
from mjforage.core.maps import load_map
from mjforage.core.scenario import Scenario
from mjforage.core.scenario_file import (
    canonical_json,
    load_scenario,
    preset_names,
    scenario_from_tree,
    scenario_path,
    scenario_to_tree,
)
from mjforage.core.setup import Setup
from mjforage.physics.vessels import load_vessel

TEAMS = """
[team.pilots]
count = 1
moves = 3
radius = 6
collects = false

[team.skimmers]
count = 2
moves = 1
radius = 1.5
collects = true
capacity = 30
"""
MINIMAL = f'name = "mine"\n[map]\nfile = "open_bay"\n{TEAMS}'

ROLE = "{count=1, moves=1, radius=1, collects=true}"


def write(folder: Path, text: str) -> str:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def error_of(reference: str, *overrides: str, map_file: str | None = None) -> str:
    with pytest.raises(UserError) as caught:
        load_scenario(reference, overrides, map_file)
    return str(caught.value)


@pytest.mark.parametrize("name", preset_names())
def test_preset_loads_onto_its_map_and_is_described(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description
    assert len(Setup.of(scenario).fleet) == 4


def test_presets_are_those_of_the_project() -> None:
    assert preset_names() == [
        "channels",
        "comb-port",
        "comb-port-radio",
        "comb-port-weather",
        "comb-port-wind-5",
        "comb-port-wind-8",
        "open-bay",
        "published",
    ]


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


@pytest.mark.parametrize("name", preset_names())
def test_canonical_json_comes_back_as_the_same_scenario(name: str) -> None:
    scenario = load_scenario(name, ["team.scouts.energy=80", "map.pitch_m=2"])
    text = canonical_json(scenario_to_tree(scenario))
    again = scenario_from_tree(json.loads(text), "again")
    assert again == scenario
    assert list(again.team) == list(scenario.team)
    assert canonical_json(scenario_to_tree(again)) == text


@pytest.mark.parametrize("speed", [5, 8])
def test_windy_presets_are_the_weather_with_another_wind(speed: int) -> None:
    calm, windy = load_scenario("comb-port-weather"), load_scenario(f"comb-port-wind-{speed}")
    assert (windy.weather.wind_speed_mps, windy.weather.wind_from_deg) == (speed, None)
    assert windy.belief.drift_node_per_step == pytest.approx(0.03 * speed * 2.5, abs=0.03)
    same = replace(
        windy,
        name=calm.name,
        description=calm.description,
        weather=replace(windy.weather, wind_speed_mps=None),
        belief=calm.belief,
    )
    assert same == calm


def test_canonical_json_tells_the_order_of_teams(tmp_path: Path) -> None:
    one = write(tmp_path, MINIMAL)
    text = canonical_json(scenario_to_tree(load_scenario(one)))
    first, second = TEAMS.split("\n\n")
    swapped = write(tmp_path, f'name = "mine"\n[map]\nfile = "open_bay"\n{second}\n{first}')
    assert canonical_json(scenario_to_tree(load_scenario(swapped))) != text


def test_absent_tables_take_their_defaults_and_teams_have_any_name(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path, MINIMAL))
    assert list(scenario.team) == ["pilots", "skimmers"]
    assert scenario.team["skimmers"].capacity == 30
    assert scenario.team["pilots"].radius == 6.0
    assert isinstance(scenario.team["pilots"].radius, float)
    assert (scenario.horizon, scenario.map.starts) == (150, None)
    assert Setup.of(scenario).fleet.names == ("pilots-0", "skimmers-0", "skimmers-1")


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


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("team.scouts.cuont=3", "unknown key team.scouts.cuont; did you mean team.scouts.count?"),
        ("horzion=3", "unknown key horzion; did you mean horizon?"),
        ("map.qqqq=1", "unknown key map.qqqq; known: file, pitch_m"),
        ("team.pilots.count=2", "missing team.pilots.moves, team.pilots.radius, team.pilots.colle"),
        ("team.scouts.count=two", "team.scouts.count = 'two', expected an integer"),
        ("team.scouts.count=2.0", "team.scouts.count = 2.0, expected an integer"),
        ("team.scouts.count=true", "team.scouts.count = True, expected an integer"),
        ("team.scouts.radius=true", "team.scouts.radius = True, expected a number"),
        ("rules.stay=1", "rules.stay = 1, expected true or false"),
        ("name=5", "name = 5, expected text"),
        ("horizon=1979-05-27", "horizon = datetime.date(1979, 5, 27), expected an integer"),
        ("team.scouts.count=-1", "team.scouts.count = -1 is out of range; give 0 to 255"),
        ("team.scouts.count=256", "team.scouts.count = 256 is out of range; give 0 to 255"),
        ("team.scouts.moves=0", "team.scouts.moves = 0 is out of range; give 1 to 100"),
        ("horizon=0", "horizon = 0 is out of range; give 1 to 30000"),
        ("items.mean=-1", "items.mean = -1 is out of range"),
        ("items.std=nan", "items.std = nan is out of range"),
        ("weather.drift_node_per_step=inf", "weather.drift_node_per_step = inf is out of range"),
        (
            "weather.wind_from_deg=90",
            "weather.wind_from_deg = 90 without a wind; give weather.wind_speed_mps too",
        ),
        ("weather.wind_speed_mps=-1", "weather.wind_speed_mps = -1 is out of range; give 0 to 30"),
        ("map.pitch_m=0", "map.pitch_m = 0 is out of range"),
        ("items.mean=1" + "0" * 400, "0000... is out of range; give 0 to 20000"),
        ("horizon=0x" + "f" * 9000, "horizon = a number of thousands of digits is out of range"),
        ("horizon=" + "9" * 9000, "horizon = '9999"),
        ("map.starts=[[1,2,3]]", "map.starts[0] = [1, 2, 3], expected 2 values"),
        ("map.starts=[[1.5,2]]", "map.starts[0][0] = 1.5, expected an integer"),
        ("map.starts=4", "map.starts = 4, expected a list"),
        ("map.starts=[[99999999999999999999,2]]", "map.starts[0][0] = 99999999999999999999 is out"),
        ("team=4", "team = 4, expected tables such as [team.NAME]"),
        ("team.scouts=4", "team.scouts = 4, expected a table"),
        ("items=[1]", "items = [1], expected a table"),
        ("corruption.team=scuots", "corruption.team = 'scuots'; choose scouts, foragers"),
        ("corruption.epsilon=0.5", "corruption.team = ''; choose scouts, foragers"),
        ("rules.order=['scouts']", "rules.order = ['scouts']; give every team once: scouts, forag"),
        ("rules.order=['scouts','x']", "rules.order = ['scouts', 'x']; give every team once"),
        ("name=''", "name = '' names the run folder"),
        (f"team={{'a/b'={ROLE}}}", "team.'a/b' names files; give letters, digits and dashes"),
        (f"team={{'..'={ROLE}}}", "team.'..' names files; give letters, digits and dashes"),
        ("name='a/b'", "name = 'a/b' names the run folder"),
        ("name='..'", "name = '..' names the run folder"),
        ('name="a\\u0000"', "names the run folder"),
    ],
)
def test_what_does_not_fit_is_named(override: str, words: str) -> None:
    message = error_of("comb-port", override)
    assert message.startswith("scenario comb-port: ")
    assert words in message
    assert len(message) < 200


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("horizon", "--set horizon: expected KEY=VALUE"),
        ("=3", "--set =3: expected KEY=VALUE"),
        ("team..count=3", "--set team..count=3: expected KEY=VALUE"),
        ("horizon.x=3", "--set horizon.x=3: horizon is a value, not a table"),
        ("horizon=3\nname='x'", "expected one value"),
        ("name=\udcff", "is not UTF-8"),
    ],
)
def test_overrides_that_are_none_are_named(override: str, words: str) -> None:
    assert words in error_of("comb-port", override)


def test_deeply_nested_override_is_a_word_and_no_crash() -> None:
    assert "expected an integer" in error_of("comb-port", "horizon=" + "[" * 100_000)


def test_agents_are_counted_over_all_teams() -> None:
    nobody = ("team.scouts.count=0", "team.foragers.count=0")
    assert "0 agents in all; give 1 to 255" in error_of("comb-port", *nobody)
    many = ("team.scouts.count=128", "team.foragers.count=128")
    assert "256 agents in all; give 1 to 255" in error_of("comb-port", *many)


def test_missing_keys_are_all_named(tmp_path: Path) -> None:
    assert "missing name, map, team" in error_of(write(tmp_path, "horizon = 3\n"))


@pytest.mark.parametrize(
    ("reference", "words"),
    [
        ("comb-prot", "did you mean comb-port?"),
        (
            "zzz",
            "choose channels, comb-port, comb-port-radio, comb-port-weather, comb-port-wind-5, "
            "comb-port-wind-8, open-bay, published",
        ),
        ("missing.toml", "neither a preset nor a TOML file"),
        ("a" * 5000 + ".toml", "cannot be opened"),
    ],
)
def test_unknown_scenario_is_named(reference: str, words: str) -> None:
    message = error_of(reference)
    assert reference in message
    assert words in message


@pytest.mark.parametrize("content", [b"name = ", b"\xff\xfe", b"a = " + b"[" * 50_000])
def test_a_file_that_is_not_toml_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(content)
    assert error_of(str(path)).startswith("scenario bad.toml: not readable as TOML")


def test_map_cannot_replace_the_grid_of_a_value(tmp_path: Path) -> None:
    reference = write(tmp_path, f'name = "mine"\nmap = 3\n{TEAMS}')
    assert "--map open_bay: map is a value" in error_of(reference, map_file="open_bay")


def test_preset_wins_over_a_file_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("channels").write_text("nonsense")
    assert scenario_path("channels").suffix == ".toml"


KEYS = st.sampled_from(
    (
        *("horizon", "name", "map", "map.starts", "map.file", "team", "team.scouts", "items.mean"),
        *("team.scouts.count", "team.x.count", "rules.stay", "corruption.epsilon", "weather"),
    )
) | st.text(max_size=8)
VALUES = (
    st.integers().map(str)
    | st.floats().map(repr)
    | st.text(max_size=12)
    | st.sampled_from(("[]", "[[1,2]]", "{}", "{count=1}", "true", "nan", "-inf", "''", "0x1", '"'))
)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(KEYS, VALUES), max_size=3))
def test_any_override_gives_a_scenario_or_a_clear_error(pairs: list[tuple[str, str]]) -> None:
    try:
        scenario = load_scenario("comb-port", [f"{key}={value}" for key, value in pairs])
    except UserError as error:
        assert str(error)
        return
    assert isinstance(scenario, Scenario)
    assert math.isfinite(scenario.items.mean)
    assert (
        scenario_from_tree(json.loads(canonical_json(scenario_to_tree(scenario))), "") == scenario
    )


PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=8,
)


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(("map", "team", "items", "horizon", "corruption", "name", "?")), PLAIN)
def test_any_tree_gives_a_scenario_or_a_clear_error(key: str, value: object) -> None:
    tree = scenario_to_tree(load_scenario("comb-port")) | {key: value}
    try:
        scenario = scenario_from_tree(tree, "tree")
    except UserError as error:
        assert str(error).startswith("tree: ")
        return
    assert isinstance(scenario, Scenario)


def test_what_a_younger_key_has_by_default_leaves_the_hash_as_it_was() -> None:
    tree = scenario_to_tree(load_scenario("comb-port"))
    assert list(tree["rules"]) == ["stay", "shorten"]
    assert "relays" not in tree["team"]["scouts"]
    used = load_scenario("comb-port", ["rules.order=['scouts','foragers']"])
    assert scenario_to_tree(used)["rules"]["order"] == ["scouts", "foragers"]
    assert scenario_from_tree(scenario_to_tree(used), "again") == used


def test_a_default_that_changed_is_still_the_old_one_in_run_folders_without_the_key(
    tmp_path: Path,
) -> None:
    """`belief.look_discount` was 1 before it was a key: what was played so is called so."""
    old = scenario_to_tree(load_scenario("comb-port", ["belief.look_discount=1"]))
    assert "look_discount" not in old["belief"]
    assert scenario_from_tree(old, "old").belief.look_discount == 1.0
    now = load_scenario("comb-port")
    assert now.belief.look_discount == 0.9
    assert scenario_to_tree(now)["belief"]["look_discount"] == 0.9
    partly = load_scenario(write(tmp_path, MINIMAL + "\n[belief]\nhotspot = false\n"))
    assert partly.belief.look_discount == 0.9


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
    (folder / "shipped.toml").write_text(text.replace('"bay.csv"', '"open-bay"'))
    assert load_scenario(str(folder / "shipped.toml")).map.file == "open-bay"


def test_a_scenario_file_without_its_ending_is_offered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "breezy.toml").touch()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match=r"nor a TOML file; did you mean breezy.toml\?"):
        load_scenario("breezy")
