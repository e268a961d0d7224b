"""Faulty scenarios: every fault is named, whatever is given."""

import json
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mjforage.base.errors import UserError
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import (
    canonical_json,
    load_scenario,
    scenario_from_tree,
    scenario_to_tree,
)
from tests.mjforage.scenario.written_scenarios import TEAMS, error_of, write

ROLE = "{count=1, moves=1, radius=1, collects=true}"


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("team.scouts.cuont=3", "unknown key team.scouts.cuont; did you mean team.scouts.count?"),
        ("horzion=3", "unknown key horzion; did you mean horizon?"),
        ("map.qqqq=1", "unknown key map.qqqq; known: file, pitch_m"),
        ("team.pilots.count=2", "missing team.pilots.moves, team.pilots.radius, team.pilots.colle"),
        ("team.scouts.count=two", "team.scouts.count = 'two' should be a valid integer"),
        ("weather.height_m=2", "weather.height_m without a record; give weather.file too"),
        ("link.latency=3", "link.latency = 3 without a link; give link.model"),
        (
            "link={model='disk', bytes=5}",
            "link.bytes = 5 is too little for any scan; give at least 6",
        ),
        ("link={model='disk', loss=0.6, burst=1.2}", "link.burst = 1.2 is too short to lose 60.0%"),
        ("horizon=1979-05-27", "horizon = datetime.date(1979, 5, 27) should be a valid integer"),
        ("team.scouts.count=-1", "team.scouts.count = -1 should be "),
        ("weather.drift_node_per_step=inf", "weather.drift_node_per_step = inf should be "),
        (
            "weather.drift_ranges_node_per_step=[[0.1,0.01],[-0.1,0.1]]",
            "weather.drift_ranges_node_per_step: [0.1, 0.01]; give the least drift first",
        ),
        (
            "weather.current_toward_deg=30",
            "weather.current_toward_deg = 30 counted from east; give weather.current_to_deg",
        ),
        (
            "weather.wind_from_deg=90",
            "weather.wind_from_deg = 90 without a wind; give weather.wind_speed_mps too",
        ),
        (
            "weather.wind_spread=0.3",
            "weather.wind_spread = 0.3 without a wind; give weather.wind_speed_mps too",
        ),
        (
            "weather.current_spread=0.3",
            "weather.current_spread = 0.3 without a current; give weather.current_speed_mps too",
        ),
        (
            "physics.intake_jam_items=3",
            "physics.intake_jam_items = 3 without a rate; give physics.intake_rate_per_s too, or 0",
        ),
        ("items.mean=1" + "0" * 400, "0000... should be "),
        ("horizon=0x" + "f" * 9000, "horizon = a number of thousands of digits should be "),
        ("horizon=" + "9" * 9000, "horizon = '9999"),
        ("map.starts=[[1,2,3]]", "map.starts[0] = [1, 2, 3]: Tuple should have at most 2 items"),
        ("map.starts=[[1.5,2]]", "map.starts[0][0] = 1.5 should be a valid integer"),
        (
            "map.starts=[[99999999999999999999,2]]",
            "map.starts[0][0] = 99999999999999999999 should be less",
        ),
        ("team.scouts=4", "team.scouts = 4 should be a table"),
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
        ("horizon", "set horizon: expected KEY=VALUE"),
        ("=3", "set =3: expected KEY=VALUE"),
        ("team..count=3", "set team..count=3: expected KEY=VALUE"),
        ("horizon.x=3", "set horizon.x=3: horizon is a value, not a table"),
        ("horizon=3\nname='x'", "expected one value"),
        ("name=\udcff", "is not UTF-8"),
    ],
)
def test_overrides_that_are_none_are_named(override: str, words: str) -> None:
    assert words in error_of("comb-port", override)


def test_deeply_nested_override_is_a_word_and_no_crash() -> None:
    assert "should be a valid integer" in error_of("comb-port", "horizon=" + "[" * 100_000)


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
            "choose channels, comb-port, comb-port-clusters, comb-port-few, comb-port-gnss, "
            "comb-port-radio, comb-port-weather, comb-port-wind-5, comb-port-wind-8, "
            "open-bay, published",
        ),
        ("missing.toml", "neither a shipped scenario nor a TOML file"),
        ("a" * 5000 + ".toml", "cannot be opened"),
    ],
)
def test_unknown_scenario_is_named(reference: str, words: str) -> None:
    message = error_of(reference)
    assert reference in message
    assert words in message


def test_a_file_as_large_as_no_scenario_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.truncate(2 * 10**9)
    assert "2,000,000,000 bytes are more than such a file has" in error_of(str(path))


@pytest.mark.parametrize("content", [b"name = ", b"\xff\xfe", b"a = " + b"[" * 50_000])
def test_a_file_that_is_not_toml_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(content)
    assert error_of(str(path)).startswith("scenario bad.toml: not readable as TOML")


def test_map_cannot_replace_the_grid_of_a_value(tmp_path: Path) -> None:
    reference = write(tmp_path, f'name = "mine"\nmap = 3\n{TEAMS}')
    assert "map open_bay: map is a value" in error_of(reference, map_file="open_bay")


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


def test_a_scenario_file_without_its_ending_is_offered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "breezy.toml").touch()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match=r"nor a TOML file; did you mean breezy.toml\?"):
        load_scenario("breezy")
