"""Models that have just learnt, as policies."""

from typing import Any

import gymnasium
import pytest

import mjforage as mf


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
