"""Updates by TorchRL: advantages (GAE), the clipped loss with its value norm, optimiser steps.

Yu et al. (2022); Schulman et al. (2016, 2017). Needs TorchRL, an extra, imported only here.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from tensordict import TensorDict
from tensordict.nn import (
    ProbabilisticTensorDictModule,
    ProbabilisticTensorDictSequential,
    TensorDictModule,
)
from torch import Tensor, nn
from torchrl.modules import MaskedCategorical, PopArtValueNorm
from torchrl.objectives.multiagent import MAPPOLoss
from torchrl.objectives.value.functional import vec_generalized_advantage_estimate

from mjforage.graph_planner.networks.inference import one_thread
from mjforage.learning.training.mappo.critic import Critic
from mjforage.learning.training.mappo.hyperparameters import MappoHyperparameters
from mjforage.learning.training.mappo.rollout import Decisions

LOSSES = ("loss_objective", "loss_taught", "loss_critic", "loss_entropy")
FACTS = ("loss_objective", "loss_taught", "loss_critic", "entropy", "clip_fraction", "kl_approx")


class Actors(nn.Module):
    """The teams' actors side by side: logits (row, agent, 9) of levels (row, agent, ...)."""

    def __init__(
        self, networks: Mapping[str, nn.Module], agents: Mapping[str, NDArray[np.int64]]
    ) -> None:
        super().__init__()
        self.networks = nn.ModuleDict(dict(networks))
        self.ids = {team: torch.from_numpy(agents[team].astype(np.int64)) for team in networks}

    def forward(self, levels: Mapping[str, Tensor]) -> Tensor:
        """Each agent by its team's network, and by what it sees itself alone."""
        first = next(iter(levels.values()))
        logits = first.new_zeros((*first.shape[:2], 9), dtype=torch.float32)
        for team, network in self.networks.items():
            ids = self.ids[team].to(first.device)
            own = {name: level[:, ids].flatten(0, 1) for name, level in levels.items()}
            logits[:, ids] = network(own).view(first.shape[0], len(ids), 9)
        return logits


class _Keyed(nn.Module):
    """A network of arrays by name, as TorchRL calls it: with the arrays in a fixed order."""

    def __init__(self, network: nn.Module, names: list[str]) -> None:
        super().__init__()
        self.network, self.names = network, names

    def forward(self, *arrays: Tensor) -> Tensor:
        found: Tensor = self.network(dict(zip(self.names, arrays, strict=True)))
        return found


class _Real(nn.Module):
    """The critic's values in the reward's units."""

    def __init__(self, critic: Critic, norm: PopArtValueNorm) -> None:
        super().__init__()
        self.critic, self.norm = critic, norm

    def forward(self, levels: Mapping[str, Tensor]) -> Tensor:
        found: Tensor = self.norm.denormalize(self.critic(levels))
        return found


class Updates:
    """Learns from rounds.

    Attributes
    ----------
    actors, critic : networks that it changes
    norm : mean and spread of the returns, by which values are normalised
    updates : number of updates so far
    """

    def __init__(
        self,
        actors: Actors,
        critic: Critic,
        names: list[str],
        settings: MappoHyperparameters,
        device: str = "cpu",
    ) -> None:
        """Prepare; `names`: of the arrays that an agent sees; the others are the critic's alone."""
        self.actors, self.critic = actors.to(device), critic.to(device)
        self.settings, self.updates, self._device = settings, 0, device
        self.names, self.norm = names, PopArtValueNorm(shape=1).to(device)
        self.real = _Real(critic, self.norm)
        every = sorted({*names, *critic.pictures, "truth.facts"})
        actor = ProbabilisticTensorDictSequential(
            TensorDictModule(_Keyed(actors, names), in_keys=list(names), out_keys=["logits"]),
            ProbabilisticTensorDictModule(
                in_keys={"logits": "logits", "mask": "legal"},
                out_keys=["action"],
                distribution_class=MaskedCategorical,
            ),
        )
        value = TensorDictModule(
            _Keyed(self.real, every), in_keys=list(every), out_keys=["state_value"]
        )
        self.loss = MAPPOLoss(
            actor,
            value,
            value_norm=self.norm,
            clip_epsilon=settings.clip,
            clip_value=settings.clip,
            entropy_coeff=settings.entropy_from,
            normalize_advantage=False,  # of a whole round below, as Yu et al. do
            functional=False,
        )
        self.loss.set_keys(sample_log_prob="chance")
        self.loss.to(device)
        self.optimiser = torch.optim.Adam(self.parameters(), settings.learning_rate, eps=1e-5)

    def parameters(self) -> list[nn.Parameter]:
        """All that is learned, the actors' first."""
        return [*self.actors.parameters(), *self.critic.parameters()]

    def learn(
        self, round: Decisions, random: np.random.Generator, taught: bool = False
    ) -> list[dict[str, float]]:
        """Some epochs over a round; the losses of each update.

        `taught`: True if actors learn the moves that a teacher has demonstrated, instead of by PPO.
        """
        settings = self.settings
        with one_thread():
            data = self._data(round)
            found = []
            for _ in range(settings.epochs):
                order = torch.from_numpy(random.permutation(len(data)))
                for rows in torch.split(order, settings.batch):
                    found.append(self._update(data[rows], taught))
        return found

    def _data(self, round: Decisions) -> TensorDict:
        """Input of the loss."""
        advantage, target = advantages(round, self.settings.gamma, self.settings.gae)
        columns: dict[str, Any] = {
            **round.levels,
            "legal": torch.from_numpy(round.legal),
            "demonstrated": torch.from_numpy(round.demonstrated),
            "action": torch.from_numpy(round.moves),
            "chance": torch.from_numpy(round.chances),
            "state_value": torch.from_numpy(round.values)[..., None],
            "advantage": (advantage - advantage.mean()) / (advantage.std() + 1e-5),
            "value_target": target,
        }
        there = {name: column.to(self._device) for name, column in columns.items()}
        return TensorDict(there, batch_size=[len(round.step)])

    def _update(self, batch: TensorDict, taught: bool) -> dict[str, float]:
        self._schedule()
        found = self._taught(batch) if taught else self.loss(batch)
        loss = torch.stack([found[name] for name in LOSSES if name in found]).sum()
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        for part in (self.actors, self.critic):
            torch.nn.utils.clip_grad_norm_(part.parameters(), self.settings.gradient_limit)
        self.optimiser.step()
        self.updates += 1
        facts = {name: float(found[name].detach()) for name in FACTS if name in found}
        return {"loss": float(loss.detach())} | facts

    def _schedule(self) -> None:
        """Learning rate and weight of the entropy, now."""
        settings = self.settings
        gone = min(1.0, self.updates / settings.entropy_updates)
        weight = settings.entropy_from + gone * (settings.entropy_to - settings.entropy_from)
        self.loss.entropy_coeff.fill_(weight)
        late = min(1.0, self.updates / settings.rate_updates)
        self.optimiser.param_groups[0]["lr"] = settings.learning_rate * (1.0 - 0.9 * late)

    def _taught(self, batch: TensorDict) -> dict[str, Tensor]:
        """Losses of a warm start: minus the log-probability of demonstrated moves; the critic's."""
        logits = self.actors({name: batch[name] for name in self.names})
        loss = lacking(logits, batch["legal"], batch["demonstrated"])
        return {"loss_taught": loss, "loss_critic": self.loss.loss_critic(batch)[0].mean()}


def lacking(logits: Tensor, legal: Tensor, demonstrated: Tensor) -> Tensor:
    """Mean of -log(probability of any demonstrated move), where there is one; all are (..., 9)."""
    chances = logits.masked_fill(~legal, -torch.inf).log_softmax(dim=-1)
    some = (demonstrated & legal).any(dim=-1)
    demonstrated_chances = chances.masked_fill(~(demonstrated & legal), -torch.inf)[some]
    return -demonstrated_chances.logsumexp(dim=-1).mean()


def advantages(round: Decisions, gamma: float, gae: float) -> tuple[Tensor, Tensor]:
    """Generalised advantage estimates of a round's decisions, and the critic's targets.

    (row, agent, 1) each, by TorchRL. At the horizon the value of what came next counts; where no
    item is left there is nothing next.
    """
    steps, envs, agents = int(round.step.max()) + 1, int(round.env.max()) + 1, round.moves.shape[1]

    def laid(column: NDArray[Any]) -> Tensor:
        """(agent, env, step, 1) of a column (row, agent), 0 after an episode's end."""
        out = np.zeros((agents, envs, steps, 1), column.dtype)
        out[:, round.env, round.step, 0] = column.T
        return torch.from_numpy(out)

    def every(column: NDArray[np.bool_]) -> Tensor:
        return laid(np.repeat(column[:, None], agents, axis=1))

    found = vec_generalized_advantage_estimate(
        gamma,
        gae,
        laid(round.values),
        laid(round.following),
        laid(round.rewards),
        every(round.done),
        every(round.terminated),
    )
    env, step = torch.from_numpy(round.env), torch.from_numpy(round.step)
    advantage, target = (each[:, env, step].transpose(0, 1).contiguous() for each in found)
    return advantage, target
