"""Models that have just learnt, as policies."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import mjforage as mf


class Constant:
    """Model that has learnt one move."""

    def __init__(self, env: Any, move: int) -> None:
        self.observation_space, self.action_space = env.observation_space, env.action_space
        self.move = move

    def predict(self, seen: Any, deterministic: bool) -> tuple[Any, None]:
        return np.full(len(seen["moves"]), self.move), None


def test_a_model_of_other_weights_is_another_run(tmp_path: Path) -> None:
    bay = mf.load_scenario("open-bay", horizon=4)
    env: Any = gymnasium.make("mjforage/SharedPolicy-v0", scenario=bay)
    how: dict[str, Any] = {"episodes": 1, "folder": tmp_path / "run", "progress": False}
    for _ in range(2):
        mf.evaluate(bay, {"learnt": Constant(env, 2)}, **how)
    with pytest.raises(mf.UserError, match="run: holds another run"):
        mf.evaluate(bay, {"learnt": Constant(env, 6)}, **how)


def test_a_model_that_has_just_learnt_from_some_of_the_arrays_plays() -> None:
    """It holds tensors with a gradient, and sees less than the environment shows."""
    contrib = pytest.importorskip("sb3_contrib")
    bay = mf.load_scenario("open-bay", horizon=10)
    env: Any = gymnasium.make("mjforage/SharedPolicy-v0", scenario=bay)
    env = gymnasium.wrappers.FilterObservation(env, ["moves", "own"])
    how: dict[str, Any] = {"n_steps": 40, "batch_size": 40, "n_epochs": 1, "device": "cpu"}
    model = contrib.MaskablePPO("MultiInputPolicy", env, seed=0, **how)
    model.learn(40)
    run = mf.evaluate(bay, {"learnt": model}, episodes=2)
    assert run.episodes["policy"].to_list() == ["learnt", "learnt"]
