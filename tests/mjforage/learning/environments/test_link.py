"""Environments over a link: every agent sees what it has seen and heard itself."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.learning.environments.game import Game
from mjforage.learning.environments.options import EnvironmentOptions


def game(*overrides: str, num_envs: int = 3) -> Game:
    return Game(EnvironmentOptions(set=("horizon=30", *overrides)), num_envs)


def played(link: str, steps: int = 12) -> tuple[Game, list[dict[str, NDArray[Any]]]]:
    """A game of random moves, and what everybody saw."""
    one, rng = game(link), np.random.default_rng(0)
    one.start(np.arange(3), np.array([3, 4, 5], np.uint64))
    seen = []
    for _ in range(steps):
        seen.append({name: level.copy() for name, level in one.see(np.arange(3)).items()})
        one.step(rng.integers(0, 9, (3, one.agents)))
    return one, seen


def test_over_a_perfect_link_all_see_what_they_see_without() -> None:
    (_, ideal), (_, linked) = played("link.model=ideal"), played("link.model=disk")
    for before, after in zip(ideal, linked, strict=True):
        for name, level in before.items():
            assert after[name].shape == level.shape
            np.testing.assert_array_equal(after[name], level)


def test_without_a_link_they_see_less_and_each_something_else() -> None:
    (_, ideal), (_, alone) = played("link.model=ideal"), played("link.model=none")
    assert any((ideal[-1][name] != alone[-1][name]).any() for name in ideal[-1])


@pytest.mark.parametrize("link", ["link.model=disk", "link.model=none"])
def test_a_restarted_episode_is_seen_as_from_its_start(link: str) -> None:
    one, _ = played(link, 5)
    one.start(np.array([1]), np.array([9], np.uint64))
    again = game(link)
    again.start(np.arange(3), np.array([3, 9, 5], np.uint64))
    for name, level in again.see(np.arange(3)).items():
        np.testing.assert_array_equal(one.see(np.arange(3))[name][1], level[1])
