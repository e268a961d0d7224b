"""The paper's figures may stand beside runs of its own mission only."""

from pathlib import Path

import pytest

from mjforage.mission import Setting
from mjforage.report.published import comparable, published_for
from mjforage.run_info import load_run
from mjforage.scenario_file import load_scenario
from mjforage.storage import write_json
from mjforage.studies.identity import run_info


@pytest.mark.parametrize(
    ("preset", "overrides", "map_file", "expected"),
    [
        ("published", (), None, True),
        ("comb-port", (), None, True),
        ("comb-port", ("team.scouts.count=20",), None, False),
        ("published", ("horizon=100",), None, False),
        ("comb-port", ("map.starts=[]",), "open_bay", False),
        ("open-bay", (), None, False),
    ],
)
def test_only_an_unchanged_mission_on_a_map_of_the_same_size_is_comparable(
    tmp_path: Path, preset: str, overrides: tuple[str, ...], map_file: str | None, expected: bool
) -> None:
    setting = Setting.of(load_scenario(preset, overrides, map_file))
    write_json(tmp_path / "run.json", run_info(setting, ["greedy"], ["graph"], 1, 0))
    run = load_run(tmp_path / "run.json")
    assert comparable(run) is expected
    assert (published_for(run, "greedy") is not None) is expected
    assert published_for(run, "lawnmower") is None
