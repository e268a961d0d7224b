"""Studies, boards and trainings: the command line's folders, without the command line."""

from pathlib import Path
from typing import Any

import pytest
from polars.testing import assert_frame_equal

import mjforage as mf
from tests.mjforage.api.conftest import nearest

TINY: dict[str, Any] = {"num_envs": 2, "capacity": 1000, "batch": 4, "warmup": 4}


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


@pytest.mark.parametrize(
    ("kind", "changes", "words"),
    [
        ("ablaton", {}, "study 'ablaton': unknown; did you mean ablation"),
        ("ablation", {"options": {"step": 1}}, "option 'step' of study ablation"),
        ("corruption", {"options": {"steps": 1}}, "did you mean step"),
        ("ablation", {"episodes": 0}, "episodes 0"),
        ("ablation", {"horizn": 3}, "unknown key horizn"),
    ],
)
def test_refusals(tmp_path: Path, kind: str, changes: dict[str, Any], words: str) -> None:
    with pytest.raises(mf.UserError, match=words):
        mf.study(kind, "open-bay", "levy", folder=tmp_path / "study", **changes)


def test_a_board_plays_each_task_in_its_world(tmp_path: Path) -> None:
    how: dict[str, Any] = {"overrides": ["horizon=3"], "episodes": 1, "progress": False}
    found = mf.board(["open-bay", "channels@physics"], "levy", folder=tmp_path / "board", **how)
    assert [found.run(one).worlds for one in found.variants] == [("graph",), ("physics",)]


def test_weights_of_a_training_are_a_policy(bay: mf.Scenario, tmp_path: Path) -> None:
    how: dict[str, Any] = {"settings": {**TINY, "evaluate_episodes": 1}, "updates": 1}
    weights = mf.train("ddqn", bay, folder=tmp_path / "learned", **how)
    assert weights == tmp_path / "learned" / "best.safetensors"
    run = mf.evaluate(bay, weights, episodes=1, progress=False)
    assert run.policies == (weights.stem,)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "train: no end given"),
        ({"updates": 1, "settings": {"num_env": 2}}, "did you mean num_envs"),
        ({"updates": 1, "settings": {"teacher": "greedi"}}, "greedi"),
    ],
)
def test_trainings_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    with pytest.raises(mf.UserError, match=words):
        mf.train("ddqn", "open-bay", folder=tmp_path / "learned", **changes)
