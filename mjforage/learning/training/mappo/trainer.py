"""Multi-agent PPO's training: a round of whole episodes side by side, then epochs over it.

Decentralised actors, one network for each team, draw moves from what each agent sees; a central
critic, dropped after training, values them by what all see and by the truth (Yu et al. 2022).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from mjforage.base.extras import require
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.networks.inference import one_thread
from mjforage.graph_planner.networks.q_network import MoveNetwork
from mjforage.graph_planner.networks.weights import ACTOR
from mjforage.learning.training.algorithm import Algorithm, teacher_label
from mjforage.learning.training.files import learner_state, restore_learner
from mjforage.learning.training.mappo.critic import Critic
from mjforage.learning.training.mappo.critic_features import critic_features
from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
from mjforage.learning.training.mappo.rollout import Rollout
from mjforage.learning.training.progress import Row
from mjforage.mission.moves import CHOSEN, OTHERWISE_STAY
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.sizes import check_memory

if TYPE_CHECKING:
    from mjforage.learning.training.mappo.updates import Updates


class MappoTrainer(Algorithm[MappoHyperparameters]):
    """One training run.

    Attributes
    ----------
    actors : team of `TEAMS` -> its network, which ships
    updates : the learner
    """

    settings = MappoHyperparameters
    weights_kind = ACTOR
    learned = (
        *("loss", "loss_objective", "loss_taught", "loss_critic"),
        *("entropy", "clip_fraction", "kl_approx"),
    )

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        hyperparameters: MappoHyperparameters,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        """Prepare a run; as `Algorithm`, and `UserError` without TorchRL."""
        updates = _torchrl()
        teacher = teacher_label(hyperparameters.teacher)
        super().__init__(scenarios, replace(hyperparameters, teacher=teacher), seed, device)
        self._check_memory()
        teams = {team: ids for team, ids in self.agents.items() if ids.size}
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.actors = {
                team: _actor(MoveNetwork(self.shapes), hyperparameters.gain) for team in teams
            }
            critic = Critic(self.shapes, list(self.agents.values()))
        both = updates.Actors(self.actors, teams)
        self.updates: Updates = updates.Updates(
            both, critic, list(self.shapes), self.hyperparameters, device
        )

    @property
    def networks(self) -> Mapping[str, MoveNetwork]:
        """Team -> actor."""
        return self.actors

    def play_round(self) -> Row:
        """Play one episode in every sub-environment to its end, then learn from all of them."""
        self.start_round()
        taught = self.teach(self.hyperparameters.teacher, self.hyperparameters.teacher_updates)
        returns = np.zeros((self.round.num_envs, self.round.agents))
        rollout, last = Rollout(), np.zeros(returns.shape, np.float32)
        present = self.round.active.copy()
        seen = self._see(present)
        while present.any():
            envs = np.flatnonzero(present)
            rewards = self._step(rollout, envs, seen, taught)
            returns += rewards
            now = self.round.active.copy()
            seen = self._see(present)
            ended = np.flatnonzero(present & ~now)
            if ended.size:
                last[ended] = self._values(seen, ended)
            present = now
        round = rollout.finished(last)
        learned = self.updates.learn(round, self.random, taught is not None)
        self.progress.updates += len(learned)
        return self.end_round(returns, learned)

    def _see(self, present: NDArray[np.bool_]) -> dict[str, Tensor]:
        """Levels of all episodes, those of `present` (env,) as they are now; live."""
        seen = {**self.round.see(np.flatnonzero(present)), **critic_features(self.round)}
        return {name: torch.as_tensor(level).to(self.device) for name, level in seen.items()}

    def _step(
        self,
        rollout: Rollout,
        envs: NDArray[np.int64],
        seen: dict[str, Tensor],
        taught: NDArray[np.bool_] | None,
    ) -> NDArray[np.float64]:
        """One decision of the episodes envs (row,): rewards (env, agent)."""
        legal = self.round.masks[envs].astype(np.bool_)
        values = self._values(seen, envs)
        moves, chances = drawn(self._logits(seen, envs), legal, self.random)
        preferences = np.zeros((self.round.num_envs, self.round.agents, 9))
        preferences[..., STAY] = OTHERWISE_STAY
        preferences[envs[:, None], np.arange(self.round.agents), moves] = CHOSEN
        demonstrated = np.zeros(preferences.shape, np.bool_)
        if taught is not None:
            theirs, demonstrated = self.round.demonstrated()
            preferences[taught] = theirs[taught]
        outcome = self.round.play(preferences)
        share = self.hyperparameters.shared
        own = outcome.rewards
        mean = own.mean(axis=1, keepdims=True)
        paid = ((1.0 - share) * own + share * mean)[envs].astype(np.float32)
        ends = outcome.terminated[envs]
        rollout.add(envs, seen, legal, demonstrated[envs], moves, chances, paid, values, ends)
        return own

    def _logits(self, seen: Mapping[str, Tensor], envs: NDArray[np.int64]) -> NDArray[np.float32]:
        """(row, agent, 9) of the episodes envs (row,)."""
        return self._asked(self.updates.actors, {n: seen[n] for n in self.shapes}, envs)

    def _values(self, seen: Mapping[str, Tensor], envs: NDArray[np.int64]) -> NDArray[np.float32]:
        """(row, agent) of the episodes envs (row,), in the reward's units."""
        return self._asked(self.updates.real, seen, envs)[..., 0]

    def _asked(
        self,
        network: nn.Module,
        seen: Mapping[str, Tensor],
        envs: NDArray[np.int64],
    ) -> NDArray[np.float32]:
        with torch.no_grad(), one_thread():
            own = {name: level[envs] for name, level in seen.items()}
            out: NDArray[np.float32] = network(own).cpu().numpy()
        return out

    def _check_memory(self) -> None:
        """Refuse rounds that do not fit into this machine."""
        each = sum(int(np.prod(shape)) for shape in self.shapes.values())
        steps = self.setup.scenario.horizon * self.hyperparameters.num_envs
        check_memory(
            f"learning settings: a round of num_envs = {self.hyperparameters.num_envs} episodes",
            2 * steps * len(self.setup.fleet) * each,  # while they are joined they are there twice
            "give fewer environments",
        )

    def tensors(self) -> dict[str, Tensor]:
        """Actors, critic, norm and optimiser."""
        made = self.updates
        return learner_state(self._modules, made.optimiser, made.updates)

    def restore(self, state: Mapping[str, Tensor]) -> None:
        """Restore the state that `tensors` gave."""
        made = self.updates
        made.updates = restore_learner(self._modules, made.optimiser, state)

    @property
    def _modules(self) -> dict[str, nn.Module]:
        made = self.updates
        return {"actors": made.actors, "critic": made.critic, "norm": made.norm}


def drawn(
    logits: NDArray[np.float32], legal: NDArray[np.bool_], random: np.random.Generator
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Moves (row, agent) drawn from masked logits (row, agent, 9), and log-probabilities.

    By the Gumbel trick: the largest of logits with Gumbel noise has the softmax's distribution.
    """
    masked = np.where(legal, logits.astype(np.float64), -np.inf)
    noise = random.gumbel(size=masked.shape)
    moves = (masked + noise).argmax(axis=-1)
    top = masked.max(axis=-1, keepdims=True)
    total = top + np.log(np.exp(masked - top).sum(axis=-1, keepdims=True))
    chances = np.take_along_axis(masked - total, moves[..., None], axis=-1)[..., 0]
    return moves, chances.astype(np.float32)


def _actor(network: MoveNetwork, gain: float) -> MoveNetwork:
    """A fresh actor: orthogonal weights, the last layer by a gain of its own (Yu et al. 2022)."""
    for module in network.modules():
        if isinstance(module, nn.Linear | nn.Conv2d):
            last = module is network.advantage
            nn.init.orthogonal_(module.weight, gain if last else nn.init.calculate_gain("relu"))
            if module.bias is not None:
                nn.init.zeros_(module.bias)
    return network


def _torchrl() -> ModuleType:
    """The module that needs TorchRL. Raises `UserError` if it is not installed."""
    require("train mappo", "torchrl")
    from mjforage.learning.training.mappo import updates

    return updates
