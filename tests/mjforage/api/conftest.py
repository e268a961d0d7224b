"""Scenarios small enough for tests, and policies in the forms that users have them."""

import numpy as np
import pytest
from numpy.typing import NDArray

import mjforage as mf
from mjforage.mission.task import Observation, Task


def nearest(view: mf.View) -> dict[str, str | None]:
    """Collectors go to the nearest known item."""
    return {agent: view.toward_nearest_item(agent) for agent in view.collectors}


def drawn(view: mf.View) -> dict[str, str]:
    """Every agent draws one of its legal moves."""
    return {agent: str(view.rng.choice(view.legal_moves(agent))) for agent in view.agents}


class Eastward:
    """Batched policy: every agent prefers one direction, by default east."""

    def __init__(self, move: int = 2) -> None:
        self.move = move

    def reset(self, task: Task, keys: "NDArray[np.uint64]") -> None:
        self.preferences = np.zeros((keys.size, len(task.fleet), 9))
        self.preferences[..., 8], self.preferences[..., self.move] = 0.5, 1.0

    def act(self, observation: Observation) -> "NDArray[np.float64]":
        return self.preferences


@pytest.fixture(scope="session")
def bay() -> mf.Scenario:
    """Open water of 12 x 16 nodes, with two scouts and two foragers for 12 decisions."""
    water = mf.Map(np.ones((12, 16), bool), pitch_m=4.0, starts=((2, 5), (5, 5), (8, 5), (10, 5)))
    return mf.load_scenario("open-bay", map=water, horizon=12)
