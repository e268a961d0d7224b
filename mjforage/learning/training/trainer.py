"""The Double DQN's training: rounds of whole episodes side by side, with updates in between.

A run can be stopped and resumed between rounds, when no episode is under way; the same rounds give
the same weights whatever happened between them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from mjforage.graph_planner.encodings import Shapes
from mjforage.learning.training.algorithm import Algorithm, teacher_label
from mjforage.learning.training.files import part_of
from mjforage.learning.training.hyperparameters import Hyperparameters
from mjforage.learning.training.learner import Learner
from mjforage.learning.training.progress import Row
from mjforage.learning.training.replay_memory import FINAL, NOTHING, PLAYED, memory_bytes
from mjforage.learning.training.rounds import Played
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.sizes import check_memory

if TYPE_CHECKING:
    from mjforage.graph_planner.networks.q_network import DuelingNetwork


class Trainer(Algorithm[Hyperparameters]):
    """One training run.

    Attributes
    ----------
    learners : team of `TEAMS` -> its learner; a team without agents has none
    """

    settings = Hyperparameters
    learned = ("loss", "value", "error")

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        hyperparameters: Hyperparameters,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        """Make a trainer as `Algorithm` does; refuse also unknown teachers or too large replays."""
        teacher = teacher_label(hyperparameters.teacher)
        hyperparameters = replace(hyperparameters, teacher=teacher)
        super().__init__(scenarios, hyperparameters, seed, device)
        _check_memory(self.shapes, self.agents, hyperparameters)
        self.learners = {
            team: Learner(
                self.shapes,
                hyperparameters.num_envs * ids.size,
                self.hyperparameters,
                seed + i,
                device,
            )
            for i, (team, ids) in enumerate(self.agents.items())
            if ids.size
        }

    @property
    def networks(self) -> "dict[str, DuelingNetwork]":
        """Team -> network to play: the average over the run, without the swings of the last."""
        return {team: learner.average for team, learner in self.learners.items()}

    @property
    def copies(self) -> "dict[str, Sequence[DuelingNetwork]]":
        """Team -> its average, online and target network."""
        return {team: learner.networks for team, learner in self.learners.items()}

    def play_round(self) -> Row:
        """Play one episode in every sub-environment to its end, and learn on the way."""
        self.start_round()
        taught = self.teach(self.hyperparameters.teacher, self.hyperparameters.teacher_updates)
        returns = np.zeros((self.round.num_envs, self.round.agents))
        learned: list[dict[str, float]] = []
        self._present = np.zeros(self.round.num_envs, np.bool_)
        while self.round.active.any():
            outcome = self._step(taught)
            returns += outcome.rewards
            learned += self._learn()
        self._open(np.where(self._present, FINAL, NOTHING))
        for learner in self.learners.values():
            learner.memory.finish()
        return self.end_round(returns, learned) | {"explore": self._explore}

    def tensors(self) -> dict[str, Tensor]:
        """Networks, optimisers and replays of both teams."""
        return {
            f"{team}.{name}": value
            for team, learner in self.learners.items()
            for name, value in learner.tensors().items()
        }

    def restore(self, state: Mapping[str, Tensor]) -> None:
        """Restore the state that `tensors` gave."""
        for team, learner in self.learners.items():
            learner.restore(part_of(state, team))

    def _step(self, taught: NDArray[np.bool_] | None) -> Played:
        before, self._present = self._present, self.round.active.copy()
        self._open(np.where(self._present, PLAYED, np.where(before, FINAL, NOTHING)))
        preferences = self._preferences()
        demonstrated = np.zeros(preferences.shape, np.bool_)
        if taught is not None:
            theirs, demonstrated = self.round.demonstrated()
            preferences[taught] = theirs[taught]
        outcome = self.round.play(preferences)
        for team, learner in self.learners.items():
            ids = self.agents[team]
            learner.memory.close(
                outcome.taken[:, ids].reshape(-1).astype(np.int64),
                demonstrated[:, ids].reshape(-1, 9),
                outcome.rewards[:, ids].reshape(-1),
                np.repeat(outcome.terminated, ids.size),
            )
        return outcome

    def _open(self, kind: NDArray[np.int64]) -> None:
        """Show the learners what there is now, kind (env,) of row."""
        envs = np.flatnonzero(kind != NOTHING)
        self._levels = self.round.see(envs)
        self._legal = self.round.masks.astype(np.bool_)
        for team, learner in self.learners.items():
            ids = self.agents[team]
            levels = {n: v[:, ids].reshape(-1, *v.shape[2:]) for n, v in self._levels.items()}
            rows = np.repeat(kind, ids.size).astype(np.uint8)
            legal = self._legal[:, ids].reshape(-1, 9)
            learner.memory.open(levels, legal, rows)

    @property
    def _explore(self) -> float:
        """Share of random moves now."""
        hyperparameters = self.hyperparameters
        part = min(1.0, self.progress.updates / hyperparameters.explore_updates)
        return hyperparameters.explore_from + part * (
            hyperparameters.explore_to - hyperparameters.explore_from
        )

    def _preferences(self) -> NDArray[np.float64]:
        """(env, agent, 9) values, or random numbers where a move is explored."""
        shape = (self.round.num_envs, self.round.agents)
        explored = self.random.random(shape) < self._explore
        preferences = self.random.random((*shape, 9))
        for team, learner in self.learners.items():
            ids = self.agents[team]
            wanted = self._present[:, None] & ~explored[:, ids]
            env, number = np.nonzero(wanted)
            if env.size:
                levels = {name: v[env, ids[number]] for name, v in self._levels.items()}
                preferences[env, ids[number]] = learner.values(levels)
        return preferences

    def _learn(self) -> list[dict[str, float]]:
        """The updates that this step has earned."""
        hyperparameters, progress = self.hyperparameters, self.progress
        learners = self.learners.values()
        if not all(learner.memory.warm(hyperparameters.warmup) for learner in learners):
            return []
        progress.due += hyperparameters.updates_per_step * float(self._present.mean())
        learned = []
        beta = hyperparameters.correction + (1.0 - hyperparameters.correction) * min(
            1.0, progress.updates / (10 * hyperparameters.explore_updates)
        )
        while progress.due >= 1.0:
            progress.due -= 1.0
            progress.updates += 1
            learned += [self.update(learner, beta) for learner in learners]
        return learned

    def update(self, learner: Learner, beta: float) -> dict[str, float]:
        """Draw, learn, and put the new priorities back."""
        memory, settings = learner.memory, self.hyperparameters
        batch = memory.draw(settings.batch, beta, self.random)
        facts, errors = learner.learn(batch)
        memory.reprioritise(batch.rows, errors, settings.priority)
        return facts


def _check_memory(
    shapes: Shapes, agents: dict[str, NDArray[np.int64]], settings: Hyperparameters
) -> None:
    """Refuse replays that do not fit into this machine."""
    wanted = sum(
        memory_bytes(shapes, settings.num_envs * ids.size, settings.capacity, settings.n_step)
        for ids in agents.values()
        if ids.size
    )
    check_memory(
        f"learning settings: a replay of capacity = {settings.capacity} for each team, with "
        f"num_envs = {settings.num_envs},",
        wanted,
        "give less capacity, or fewer environments",
    )
