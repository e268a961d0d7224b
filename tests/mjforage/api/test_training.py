"""Trainings: weights that are a policy, progress, and what is refused."""

from pathlib import Path
from typing import Any

import pytest

import mjforage as mf

TINY: dict[str, Any] = {
    "num_envs": 2,
    "capacity": 1000,
    "batch": 4,
    "warmup": 4,
    "evaluate_episodes": 1,
    "evaluate_every": 4,
}


def test_weights_of_a_training_are_a_policy(bay: mf.Scenario, tmp_path: Path) -> None:
    how: dict[str, Any] = {"settings": TINY, "updates": 1, "also": bay, "evaluate": "comb-port"}
    weights = mf.train("ddqn", bay, folder=tmp_path / "learned", **how)
    assert weights == tmp_path / "learned" / "best.safetensors"
    run = mf.evaluate(bay, weights, episodes=1, progress=False)
    assert run.policies == (weights.stem,)


@pytest.mark.parametrize("end", [{"updates": 30}, {"hours": 1e-5}, {"updates": 30, "hours": 1.0}])
def test_progress_is_told_to_the_end(bay: mf.Scenario, tmp_path: Path, end: dict[str, Any]) -> None:
    told: list[tuple[int, int]] = []
    how: dict[str, Any] = {"settings": TINY, "folder": tmp_path / "learned", **end}
    mf.train("ddqn", bay, progress=lambda done, total: told.append((done, total)), **how)
    total = end.get("updates", 1)
    assert told == sorted(told) and told[-1] == (total, total)
    assert all(type(one) is int for pair in told for one in pair)


@pytest.mark.parametrize(
    ("algorithm", "changes", "words"),
    [
        ("ddqn", {}, "train: no end given"),
        ("ddqn", {"updates": 1, "settings": {"num_env": 2}}, "did you mean num_envs"),
        ("ddqn", {"updates": 1, "settings": {"teacher": "greedi"}}, "greedi"),
        ("ddqn", {"updates": 1, "settings": ["a"]}, r"settings is \['a'\]; give a dict of name"),
        ("ddqn", {"updates": 1, "settings": {3: 2}}, r"settings is \{3: 2\}; give a dict of name"),
        (3, {"updates": 1}, "algorithm is int; give a name"),
        ("ddqn", {"updates": 1, "also": [3]}, "also has int; give scenarios"),
        ("ddqn", {"updates": 1, "also": 3}, "also is int; give a list of scenarios"),
        ("ddqn", {"updates": 1, "also": "comb-prot"}, "did you mean comb-port"),
        ("ddqn", {"updates": 1, "evaluate": [None]}, "evaluate has NoneType; give"),
        ("ddqn", {"updates": 1, "report": 3}, "report is int; give a function"),
        ("ddqn", {"updates": 1, "progress": "yes"}, "progress is str; give True, False or a"),
        ("ddqn", {"updates": 1, "device": 3}, "device 3: choose auto"),
    ],
)
def test_trainings_refused(
    tmp_path: Path, algorithm: Any, changes: dict[str, Any], words: str
) -> None:
    with pytest.raises((mf.UserError, TypeError), match=words):
        mf.train(algorithm, "open-bay", folder=tmp_path / "learned", **changes)
    assert not (tmp_path / "learned").exists()
