"""Studies and boards: the command line's folders, without the command line."""

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from polars.testing import assert_frame_equal

import mjforage as mf
from mjforage.base.interrupted import WORDS
from tests.mjforage.api.conftest import nearest
from tests.mjforage.conftest import Command


def test_a_variant_is_the_run_of_its_scenario(bay: mf.Scenario, tmp_path: Path) -> None:
    few: dict[str, Any] = {"episodes": 2, "seed": 3, "progress": False}
    found = mf.study("ablation", bay, ["greedy", nearest], folder=tmp_path / "study", **few)
    one = found.run("scouts-less")
    smaller = bay.replace(team={"scouts": {"count": 1}})
    alone = mf.evaluate(smaller, ["greedy", nearest], record=(), **few)
    assert one.scenario.scenario.team == smaller.scenario.team
    assert_frame_equal(one.episodes, alone.episodes)
    assert found.summary["variant"].unique(maintain_order=True).to_list() == list(found.variants)
    assert found.report() == tmp_path / "study" / "report.html"


def test_options_reach_the_variants(bay: mf.Scenario, tmp_path: Path) -> None:
    few: dict[str, Any] = {"episodes": 1, "progress": False, "folder": tmp_path / "study"}
    half = mf.study("corruption", bay, "random", options={"step": 0.25}, **few)
    assert len(half.variants) == 9  # none, and four levels of each of two teams


def test_options_have_the_defaults_of_their_kind(bay: mf.Scenario, tmp_path: Path) -> None:
    plans: list[Any] = []

    def begin(words: str, plan: Any) -> None:
        plans.append(plan.options)
        raise mf.UserError("enough")

    for kind in ("corruption", "paper"):
        with pytest.raises(mf.UserError, match="enough"):
            mf.study(kind, bay, "random", folder=tmp_path / kind, begin=begin)
    assert plans == [{"step": 0.05, "whole_team": False}, {"step": 0.05, "whole_team": True}]


@pytest.mark.parametrize(
    ("kind", "changes", "words"),
    [
        ("ablaton", {}, "study 'ablaton': unknown; did you mean ablation"),
        ("ablation", {"options": {"step": 1}}, "option 'step' of study ablation"),
        ("corruption", {"options": {"steps": 1}}, "did you mean step"),
        ("corruption", {"options": {"step": "x"}}, "step is str; give a number"),
        ("corruption", {"options": {"step": 0}}, "step = 0: give a finite number above 0"),
        ("paper", {"options": {"whole_team": 1}}, "whole_team is int; give True or False"),
        ("paper", {"options": 3}, "options is 3; give a dict of name -> value"),
        ("paper", {"options": ["step"]}, r"options is \['step'\]; give a dict"),
        ("ablation", {"begin": 3}, "begin is int; give a function"),
        ("ablation", {"episodes": 0}, "episodes 0"),
        ("ablation", {"horizn": 3}, "unknown key horizn"),
    ],
)
def test_refusals(tmp_path: Path, kind: str, changes: dict[str, Any], words: str) -> None:
    given: dict[str, Any] = {"folder": tmp_path / "study", "policies": "levy"} | changes
    with pytest.raises((mf.UserError, TypeError), match=words):
        mf.study(kind, "open-bay", **given)
    assert not (tmp_path / "study").exists()


def test_a_board_calls_a_function_only(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="begin is int; give a function"):
        mf.board(["open-bay"], "levy", folder=tmp_path / "board", begin=3)  # type: ignore[arg-type]


def stop_at(count: int) -> Callable[[int, int], None]:
    """A function of progress that presses Ctrl-C once so many episodes are done."""

    def stop(done: int, total: int) -> None:
        if done >= count:
            raise KeyboardInterrupt

    return stop


def test_ctrl_c_returns_the_finished_runs(bay: mf.Scenario, tmp_path: Path) -> None:
    few: dict[str, Any] = {"episodes": 2, "folder": tmp_path / "study"}
    found = mf.study("ablation", bay, "random", progress=stop_at(4), **few)
    first, second, third = found.variants
    assert not found.complete and repr(found).endswith(", not complete)")
    assert found.run(first).complete and not found.run(third).complete
    assert found.summary["variant"].unique(maintain_order=True).to_list() == [first, second]
    with pytest.raises(mf.UserError, match="the study is not finished"):
        found.report()
    whole = mf.study("ablation", bay, "random", progress=False, **few)
    assert whole.complete and "not complete" not in repr(whole)
    assert whole.summary["variant"].unique(maintain_order=True).to_list() == [first, second, third]


def test_ctrl_c_in_a_board_returns_before_anything_is_finished(tmp_path: Path) -> None:
    how: dict[str, Any] = {"overrides": ["horizon=3"], "episodes": 1, "progress": stop_at(0)}
    found = mf.board(["open-bay"], "levy", folder=tmp_path / "board", **how)
    assert not found.complete
    with pytest.raises(mf.UserError, match="ended before any episode was finished"):
        _ = found.summary


def test_ctrl_c_before_the_folder_is_that_of_the_study_is_raised(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few: dict[str, Any] = {"episodes": 1, "folder": tmp_path / "study", "progress": False}
    mf.study("ablation", bay, "random", **few)

    def tired(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("mjforage.runs.studies.study.found_in", tired)
    with pytest.raises(KeyboardInterrupt):
        mf.study("ablation", bay, "levy", **few)


def test_ctrl_c_ends_the_command_of_a_study(
    command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("mjforage.cli.studying.bar", lambda words, unit: nullcontext(stop_at(1)))
    how = ("--policy", "levy", "--episodes", 1, "--set", "horizon=3", "--out", tmp_path / "study")
    ended = command("study", "ablation", "open-bay", *how)
    assert (ended.code, ended.err) == (130, f"mjforage: {WORDS}\n")
    assert "report" not in ended.out


def test_a_board_plays_each_task_in_its_world(tmp_path: Path) -> None:
    how: dict[str, Any] = {"overrides": ["horizon=3"], "episodes": 1, "progress": False}
    found = mf.board(["open-bay", "channels@physics"], "levy", folder=tmp_path / "board", **how)
    assert [found.run(one).worlds for one in found.variants] == [("graph",), ("physics",)]
