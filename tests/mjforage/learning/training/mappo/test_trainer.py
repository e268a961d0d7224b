"""The training of multi-agent PPO itself, on a chain of two agents in two environments."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from mjforage.learning.training.hyperparameters import changed
from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
from mjforage.learning.training.mappo.rollout import Decisions
from mjforage.learning.training.mappo.trainer import MappoTrainer
from tests.mjforage.learning.training.chain import (
    ANY,
    EAST,
    GAMMA,
    PICTURES,
    RIGHT,
    SETTINGS,
    WEST,
    WHERE,
    again,
    channel,
    pond,
)

TINY: dict[str, object] = {"learning_rate": 5e-3, "rate_updates": 200, "batch": 64}


def settings(**changes: object) -> MappoHyperparameters:
    return changed(MappoHyperparameters(), SETTINGS | TINY | changes)


@pytest.mark.every_capability
def test_it_learns_the_moves_and_the_values_of_the_chain(tmp_path: Path) -> None:
    """At every step: with no end in sight a value is the same at the horizon as far from it."""
    trainer = MappoTrainer([channel(tmp_path)], settings(), seed=0)
    while trainer.progress.updates < 160:
        trainer.play_round()
    logits = trainer.actors["forager"]({"x": torch.from_numpy(PICTURES)}).detach().numpy()
    east = 1.0 / (1.0 + np.exp(logits[:, WEST] - logits[:, EAST]).reshape(2, 3))
    right = np.where(np.array(RIGHT)[:, None] == EAST, east, 1.0 - east)
    assert (right > 0.9).all()
    worth = -np.array([[1.0], [2.0]]) * (2.0 - right)  # of one move by this policy, (agent, kind)
    worth[:, 0] += GAMMA * worth[:, 1]
    worth[:, ANY] /= 1.0 - GAMMA
    kinds: set[tuple[int, int]] = set()
    while len(kinds) < 2 + 6:  # of an episode that ends, and of one that lasts
        trainer.start_round()
        step = 0
        while (present := trainer.round.active).any():
            seen, envs = trainer._see(present), np.flatnonzero(present)
            kind = seen["x"][envs].argmax(dim=2).numpy() % 3
            found = trainer._values(seen, envs)
            np.testing.assert_allclose(found / worth[np.arange(2), kind], 1.0, atol=0.12)
            kinds |= {(int(each), step) for each in kind[:, 0]}
            preferences = np.zeros((2, 2, 9))
            preferences[:, np.arange(2), RIGHT] = 1.0
            trainer.round.play(preferences)
            step += 1
        trainer.progress.episodes += 2


def in_a_pond(
    folder: Path, monkeypatch: pytest.MonkeyPatch, **changes: object
) -> tuple[MappoTrainer, Decisions]:
    """A round that was played, and what is learnt from it, before it is."""
    pond_only = {"observation": WHERE, "vary": {}, "reward": {"removed": 1.0}, "num_envs": 6}
    trainer, found = MappoTrainer([pond(folder, 1)], settings(**pond_only, **changes), seed=0), []

    def note(round: Decisions, *_: Any) -> list[dict[str, float]]:
        found.append(round)
        return []

    monkeypatch.setattr(trainer.updates, "learn", note)
    trainer.play_round()
    return trainer, found[0]


def test_a_round_is_learnt_from_as_it_was_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same moves in a mission of their own give what was seen, what was legal, the rewards, and
    how it ended; each value is that of its row, and followed by that of the next in its episode.
    """
    trainer, round = in_a_pond(tmp_path, monkeypatch)
    keys, ends = trainer.round.cores[0].mission.keys, set()
    for env in range(6):
        rows = np.flatnonzero(round.env == env)
        assert round.step[rows].tolist() == list(range(rows.size))
        one = again(pond(tmp_path, 1), keys[[env]], round.moves[rows])
        assert len(one.removed) == rows.size
        np.testing.assert_array_equal(round.levels["x"][rows], one.seen[:-1])
        np.testing.assert_array_equal(round.legal[rows], one.legal[:-1])
        np.testing.assert_array_equal(round.rewards[rows], one.removed)
        last = np.arange(rows.size) == rows.size - 1
        assert round.done[rows].tolist() == last.tolist()
        assert round.terminated[rows].tolist() == (last & one.over).tolist()
        np.testing.assert_array_equal(round.following[rows[:-1]], round.values[rows[1:]])
        ends.add((rows.size, one.over))
    assert len(ends) > 1, "they end apart"
    values = trainer._values(round.levels, np.arange(round.step.size))
    np.testing.assert_allclose(round.values, values, rtol=1e-4, atol=1e-5)
    logits = trainer._logits(round.levels, np.arange(round.step.size))
    chances = np.where(round.legal, np.exp(logits), 0.0)
    chances /= chances.sum(axis=-1, keepdims=True)
    taken = np.take_along_axis(chances, round.moves[..., None], axis=-1)[..., 0]
    np.testing.assert_allclose(np.exp(round.chances), taken, rtol=1e-4)
