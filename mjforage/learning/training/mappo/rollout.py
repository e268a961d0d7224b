"""The decisions of a round, in the order in which they were made."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

Levels = dict[str, Tensor]  # uint8, on the device of the networks


class Decisions(NamedTuple):
    """All of a round: a row per step of an episode, agents side by side."""

    levels: Levels  # (row, agent, ...), of `CRITIC_FEATURES` (row, ...)
    legal: NDArray[np.bool_]  # (row, agent, 9)
    demonstrated: NDArray[np.bool_]  # (row, agent, 9) moves that a teacher would make
    moves: NDArray[np.int64]  # (row, agent) that were chosen
    chances: NDArray[np.float32]  # (row, agent) logarithm of their probability
    rewards: NDArray[np.float32]  # (row, agent)
    values: NDArray[np.float32]  # (row, agent)
    following: NDArray[np.float32]  # (row, agent) value of what came next
    done: NDArray[np.bool_]  # (row,) the episode's last
    terminated: NDArray[np.bool_]  # (row,) nothing came next, as no item was left
    step: NDArray[np.int64]  # (row,)
    env: NDArray[np.int64]  # (row,)


class Rollout:
    """Collects a round, step by step."""

    def __init__(self) -> None:
        self._levels: list[Levels] = []
        self._parts: list[tuple[NDArray[np.generic], ...]] = []

    def add(
        self,
        envs: NDArray[np.int64],
        levels: Mapping[str, Tensor],
        *parts: NDArray[np.generic],
    ) -> None:
        """Take a step of the episodes envs (row,).

        Parameters
        ----------
        levels : (env, ...) of all episodes
        parts : legal, demonstrated, moves, chances, rewards, values, terminated (row, ...)
        """
        step = np.full(envs.size, len(self._parts))
        self._levels.append({name: level[envs] for name, level in levels.items()})
        self._parts.append((*parts, step, envs))

    def finished(self, last: NDArray[np.float32]) -> Decisions:
        """All of the round.

        `last`: (env, agent) values of what was seen after each episode's last decision.
        """
        levels = {
            name: torch.cat([each.pop(name) for each in self._levels])
            for name in list(self._levels[0])
        }
        columns = [np.concatenate(column) for column in zip(*self._parts, strict=True)]
        legal, demonstrated, moves, chances, rewards, values, terminated, step, env = columns
        row = np.full((int(step.max()) + 2, len(last)), -1)  # of the step of an episode
        row[step, env] = np.arange(step.size)
        next_row = row[step + 1, env]
        done = next_row < 0
        following = np.where(done[:, None], last[env], values[next_row])
        return Decisions(
            levels,
            legal,
            demonstrated,
            moves,
            chances,
            rewards,
            values,
            following,
            done,
            terminated,
            step,
            env,
        )
