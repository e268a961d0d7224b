"""The board: courses of several maps and worlds in one study, resumed, and who cannot play."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from mjforage.base.errors import UserError
from mjforage.graph_planner.policies.registry import POLICIES, policy_names
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.runs.studies.benchmark_tasks import benchmark_tasks
from mjforage.runs.studies.board import board
from mjforage.runs.studies.study import LeftOut, Study, StudyInfo, load_study_info, run_study
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.schema import json_schema

Command = Callable[..., Any]
Refused = Callable[..., str]
PLAYERS = ("random", "greedy", "oracle")
NAMES = ("comb-port", "open-bay", "comb-port@physics")
SMALL = ["horizon=5"]


def plan(**changes: Any) -> Study:
    return board(benchmark_tasks(NAMES, [], SMALL), PLAYERS, episodes=2, **changes)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a finished board that nobody may change."""
    folder = tmp_path_factory.mktemp("board") / "board"
    run_study(plan(), folder)
    return folder


def test_every_course_is_the_run_that_evaluate_makes(finished: Path, tmp_path: Path) -> None:
    setup = Setup.of(load_scenario("open-bay", SMALL))
    evaluate(setup, PLAYERS, tmp_path / "run", episodes=2)
    there = finished / "variants" / "open-bay"
    for name in ("summary.json", "episodes.parquet", "steps.parquet", "agents.parquet"):
        assert (there / name).read_bytes() == (tmp_path / "run" / name).read_bytes(), name
    runs = [json.loads((finished / "variants" / n / "run.json").read_text()) for n in NAMES]
    assert [run["map"]["name"] for run in runs] == ["comb_port", "open_bay", "comb_port"]
    assert [run["worlds"] for run in runs] == [["graph"], ["graph"], ["physics"]]


def test_study_json_says_what_is_played_where_and_follows_its_schema(finished: Path) -> None:
    content = json.loads((finished / "study.json").read_text())
    jsonschema.validate(content, json_schema(StudyInfo))
    info = load_study_info(finished / "study.json")
    assert info.worlds == ("graph", "physics")
    assert {name: one.worlds for name, one in info.variants.items()} == {
        "comb-port": ("graph",),
        "open-bay": ("graph",),
        "comb-port@physics": ("physics",),
    }
    assert info.left_out == ()


class Landlubber:
    """Plays no map that is wider than the comb port."""

    def reset(self, task: Any, keys: Any) -> None:
        """Refuse wide maps."""
        if task.graph.shape[1] > 50:
            raise UserError("policy landlubber: its weights do not fit; train it on wider maps")


def test_who_cannot_play_is_left_out_with_the_reason_or_refused_if_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    names = [*policy_names(), "landlubber"]
    monkeypatch.setattr("mjforage.runs.studies.board.policy_names", lambda: names)
    find = POLICIES.bound

    def bound(text: str) -> Any:
        if text != "landlubber":
            return find(text)
        from mjforage.base.references import Reference

        return Reference(text), Landlubber, {}

    monkeypatch.setattr(POLICIES, "bound", bound)
    monkeypatch.setattr(Landlubber, "act", lambda self, seen: None, raising=False)
    courses = benchmark_tasks(NAMES[:2], [], SMALL)
    study = board(courses, episodes=2)
    reason = "policy landlubber: its weights do not fit; train it on wider maps"
    assert study.left_out == (LeftOut("landlubber", "open-bay", reason),)
    assert "landlubber" in study.variants[0].policies
    assert set(study.variants[1].policies) == set(names) - {"landlubber"}
    with pytest.raises(UserError, match="course open-bay: policy landlubber: its weights do not"):
        board(courses, ("greedy", "landlubber"), episodes=2)


def test_one_command_computes_and_draws_the_board_and_another_writes_its_page(
    tmp_path: Path, command: Command, refused: Refused
) -> None:
    folder, page = tmp_path / "board", tmp_path / "docs" / "board.md"
    page.parent.mkdir()
    flags = ["--policy", "random", "--policy", "greedy", "--policy", "oracle", "--episodes", 3]
    flags += ["--set", "horizon=30", "--map", "open_bay"]
    outcome = command("study", "board", "comb-port", *flags, "--out", folder)
    assert outcome.code == 0, outcome
    assert "board of 3 policies: 2 variants, 3 episodes each" in outcome.out
    first = (folder / "report.html").read_bytes()
    assert command("report", folder, "--page", page).code == 0
    assert (folder / "report.html").read_bytes() == first
    text = page.read_text()
    for words in ("# The board", "small run of 3 episodes", "comb-port-on-open\\_bay", "| greedy"):
        assert words in text, words
    assert str(tmp_path) not in text, "no path of this machine"
    shown = {path.name for path in page.parent.glob("*.png")}
    assert shown == {"board-profiles.png", "board-frontier.png"}
    assert all(f"({name})" in text for name in shown)
    tables = {path.stem for path in (folder / "tables").glob("*.csv")}
    assert {"overall", "differences", "task-comb-port"} <= tables
    run = folder / "variants" / "comb-port"
    assert "--page" in refused("report", run, "--page", page)


def test_numbers_are_refused_before_anybody_is_asked_to_play(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "mjforage.runs.studies.board._why_not", lambda name, course: pytest.fail("asked")
    )
    with pytest.raises(UserError, match=r"episodes 0, seed 0: give at least 1"):
        board(benchmark_tasks(NAMES[:1], [], SMALL), episodes=0)
