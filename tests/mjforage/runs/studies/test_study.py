"""Studies: resumable, every variant a run folder, one report, named errors."""

import contextlib
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from mjforage.base.errors import UserError
from mjforage.mission.setup import Setup
from mjforage.runs.costs import load_costs
from mjforage.runs.evaluate import evaluate
from mjforage.runs.studies import variants
from mjforage.runs.studies.study import Study, StudyInfo, run_study
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.schema import json_schema
from mjforage.view.report.studies import write_study_report

Command = Callable[..., Any]
Refused = Callable[..., str]
SMALL = ("--episodes", 3, "--set", "horizon=12")
COSTS = "variants/complete/costs"
PAPER = ("study", "paper", "--policy", "greedy", "--policy", "levy", "--step", 0.25, *SMALL)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a finished study of the paper that nobody may change."""
    folder = tmp_path_factory.mktemp("study") / "paper"
    run_study(plan(), folder)
    return folder


def plan(episodes: int = 3) -> Study:
    setup = Setup.of(load_scenario("published", ["horizon=12"]))
    varied = variants.paper(setup.scenario, ("greedy", "levy"), 0.25, True)
    options = {"step": 0.25, "whole_team": True}
    return Study("paper", setup, varied, episodes=episodes, options=options)


@pytest.fixture
def folder(finished: Path, tmp_path: Path) -> Path:
    """Return a finished study to spoil."""
    return Path(shutil.copytree(finished, tmp_path / "study"))


def test_a_variant_is_the_run_that_evaluate_makes(finished: Path, tmp_path: Path) -> None:
    corrupted = ["corruption.team=scouts", "corruption.epsilon=0.5", "corruption.whole_team=true"]
    overrides = ["horizon=12", *corrupted]
    setup = Setup.of(load_scenario("published", overrides))
    evaluate(setup, ["greedy", "levy"], tmp_path / "run", episodes=3)
    here, there = tmp_path / "run", finished / "variants" / "scouts-0.5"
    assert {path.name for path in there.iterdir()} == {path.name for path in here.iterdir()}
    for name in ("summary.json", "episodes.parquet", "steps.parquet", "agents.parquet"):
        assert (there / name).read_bytes() == (here / name).read_bytes(), name
    keys = ("hash", "scenario", "seed", "policies")
    told = [json.loads((path / "run.json").read_text()) for path in (here, there)]
    assert {key: told[0][key] for key in keys} == {key: told[1][key] for key in keys}


def test_a_stopped_study_goes_on_where_it_was(finished: Path, tmp_path: Path) -> None:
    def stop(done: int, _: int) -> None:
        if done >= 30:
            raise KeyboardInterrupt

    folder = tmp_path / "study"
    with contextlib.suppress(KeyboardInterrupt):
        run_study(plan(), folder, progress=stop)
    assert not (folder / "summary.json").exists()
    finished_runs = {p: p.stat().st_mtime_ns for p in folder.glob("variants/*/episodes.parquet")}
    assert len(finished_runs) == 4
    seen: list[int] = []
    run_study(plan(), folder, progress=lambda done, total: seen.append(done))
    assert seen[0] == 30, "finished chunks were computed again"
    assert {p: p.stat().st_mtime_ns for p in finished_runs} == finished_runs
    assert (folder / "summary.json").read_bytes() == (finished / "summary.json").read_bytes()
    costs = [one for path in folder.glob("variants/*/costs.json") for one in load_costs(path)]
    calls = sorted({cost.started for cost in costs})
    counted = [sum(c.episodes for c in costs if c.started == call) for call in calls]
    assert counted == [30, 36], "what the stopped call computed is counted as its own"


def test_a_finished_study_goes_on_to_more_episodes(folder: Path, tmp_path: Path) -> None:
    seen: list[int] = []
    run_study(plan(4), folder, progress=lambda done, total: seen.append(done))
    assert seen[0] == 66, "finished chunks were computed again"
    run_study(plan(4), tmp_path / "whole")
    assert (folder / "summary.json").read_bytes() == (tmp_path / "whole/summary.json").read_bytes()
    assert json.loads((folder / "study.json").read_text())["episodes"] == 4
    with pytest.raises(UserError, match="episodes is 4 there and 3 here, and a run"):
        run_study(plan(3), folder)


def test_another_kind_and_other_folders_are_named(
    folder: Path, tmp_path: Path, refused: Refused
) -> None:
    ablation = ("study", "ablation", "--policy", "greedy", *SMALL, "--out")
    assert "kind is " in refused(*ablation, folder)
    run = folder / "variants" / "complete"
    assert "holds agents.parquet but no study.json, so it is no study folder" in refused(
        *ablation, run
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (("--policy", "gredy"), "policy gredy: unknown; did you mean greedy?"),
        (("--step", 0.3), "step 0.3: give 1/N"),
        (("--scheduler", "tcp://node7"), "is no address"),
    ],
)
def test_bad_input_is_named_before_anything_is_written_or_printed(
    changes: tuple[object, ...], words: str, tmp_path: Path, command: Command
) -> None:
    outcome = command("study", "paper", *changes, "--out", tmp_path / "new")
    assert outcome.code == 2
    assert words in outcome.err
    assert outcome.out == ""
    assert not (tmp_path / "new").exists()


def test_the_report_is_whole_and_the_same_twice(folder: Path, command: Command) -> None:
    first = write_study_report(folder).read_bytes()
    assert command("report", folder).code == 0
    assert (folder / "report.html").read_bytes() == first
    page = first.decode()
    for words in ("Table 5", "Table 6", "Sensitivity slopes", "Corruption of scouts", "Throughput"):
        assert words in page, words
    names = {path.name for path in (folder / "figures").glob("*.png")}
    assert {"corruption-scouts.png", "corruption-foragers.png"} <= names
    assert not re.search(r'(?:src|href)="https?:', page)


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        (COSTS, lambda read: read.clear(), "missing chunks"),
        (COSTS, lambda read: read["chunks"][0].pop("wall_s"), "missing chunks[0].wall_s"),
        ("study", lambda read: read["options"].pop("step"), "options: missing step"),
        (
            "study",
            lambda read: read["variants"]["complete"].pop("title"),
            "missing variants.compl",
        ),
    ],
)
def test_what_a_study_lacks_is_named(
    name: str, change: Callable[[Any], object], words: str, folder: Path, refused: Refused
) -> None:
    path = folder / f"{name}.json"
    read = json.loads(path.read_text())
    change(read)
    path.write_text(json.dumps(read))
    assert words in refused("report", folder)


def test_study_json_follows_its_schema(folder: Path) -> None:
    jsonschema.validate(json.loads((folder / "study.json").read_text()), json_schema(StudyInfo))


def test_an_unfinished_study_has_no_report(folder: Path, refused: Refused) -> None:
    (folder / "summary.json").unlink()
    words = "the study is not finished; run what made this folder again, it completes"
    assert words in refused("report", folder)


def test_communication_is_one_page_made_from_its_logs(tmp_path: Path, command: Command) -> None:
    folder = tmp_path / "communication"
    small = ("--episodes", 2, "--set", "horizon=6", "--policy", "greedy")
    assert command("study", "communication", *small, "--out", folder).code == 0
    first = (folder / "report.html").read_bytes()
    for words in ("Performance over the link", "Value of a relay"):
        assert words in first.decode(), words
    names = {path.stem for path in (folder / "figures").glob("*.png")}
    assert names == {"scenario", "axes-graph"}
    assert write_study_report(folder).read_bytes() == first


def test_sensing_asks_the_planner_alone_what_it_assumes(tmp_path: Path, command: Command) -> None:
    folder = tmp_path / "sensing"
    small = ("--episodes", 2, "--set", "horizon=3", "--policy", "greedy")
    assert command("study", "sensing", *small, "--out", folder).code == 0
    page = (folder / "report.html").read_text()
    assert 'id="table-minus-graph-greedy"' in page
    assert not list((folder / "figures").glob("assumed*")), "the planner did not play"
    assert {path.name for path in (folder / "variants").iterdir()} >= {"fov-75", "ghosts-0.002"}
    assert not list((folder / "variants").glob("*-for-*"))
