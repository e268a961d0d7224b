"""The paper's figures may stand beside runs of its own mission only."""

from pathlib import Path

import numpy as np
import pytest

from mjforage.base.atomic_files import write_json
from mjforage.metrics import marginal_contribution
from mjforage.mission.scoring import describe
from mjforage.mission.setup import Setup
from mjforage.runs.identity import run_info
from mjforage.runs.run_info import RunInfo, load_run
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.report.published import PAPER, comparable, elsewhere, published_for


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
    setup = Setup.of(load_scenario(preset, overrides, map_file))
    write_json(tmp_path / "run.json", run_info(setup, ["greedy"], ["graph"], 1, 0))
    run = load_run(tmp_path / "run.json")
    assert comparable(run) is expected
    assert (published_for(run, "greedy") is not None) is expected
    assert published_for(run, "lawnmower") is None


@pytest.mark.parametrize("policy", list(PAPER))
@pytest.mark.parametrize("team", ["scouts", "foragers"])
def test_its_contributions_follow_from_its_ablations(policy: str, team: str) -> None:
    paper = PAPER[policy]
    for key, value in paper.contribution[team].items():
        full, without = paper.printed.mean[key], paper.ablated[team][key]
        better = describe(key).better > 0
        again = float(marginal_contribution(full, without, higher_is_better=better))
        assert again == pytest.approx(value, abs=1e-4), key


def test_its_map_is_another_only_where_ours_is_known_to_be(tmp_path: Path) -> None:
    run = _run_on(tmp_path, None)
    assert elsewhere(run) == " (its own map)"
    mine = tmp_path / "harbour.csv"
    grid = load_map("comb_port").navigable.astype(int)
    np.savetxt(mine, grid, fmt="%d", delimiter=",")
    run = _run_on(tmp_path, str(mine))
    assert comparable(run) and elsewhere(run) == ""


def _run_on(folder: Path, map_file: str | None) -> RunInfo:
    setup = Setup.of(load_scenario("published", (), map_file))
    write_json(folder / "run.json", run_info(setup, ["greedy"], ["graph"], 1, 0))
    return load_run(folder / "run.json")


def test_the_papers_network_stands_beside_its_like() -> None:
    assert PAPER["ddqn-reward"].algorithm == "DRL"
    assert "ddqn" not in PAPER
