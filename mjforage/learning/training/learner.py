"""The Double DQN of one team: its networks, its memory and one update of them.

Double DQN: van Hasselt, Guez and Silver (2016); dueling network: Wang et al. (2016); prioritised
replay: Schaul et al. (2016); large margin for demonstrated moves: Hester et al. (2018). Action
masks act before both argmaxes: that of the policy and that of the target.

Steps of one size leave the weights swinging for ever, and values with them by more than two moves
often differ. What is played in the end is therefore the average of the weights over the run, the
later ones counting more: polynomial-decay averaging (Shamir and Zhang, ICML 2013).
"""

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from mjforage.graph_planner.encodings import Shapes
from mjforage.graph_planner.networks.inference import one_thread, values_of
from mjforage.graph_planner.networks.q_network import DuelingNetwork
from mjforage.learning.training.files import learner_state, part_of, restore_learner
from mjforage.learning.training.hyperparameters import Hyperparameters
from mjforage.learning.training.replay_memory import Batch, ReplayMemory

NETWORKS = ("online", "target", "average")
GRADIENT_LIMIT = 10.0  # norm of a step's gradients at most; an estimate


def lead_lacking(values: Tensor, demonstrated: Tensor, margin: float) -> Tensor:
    """(row,) by how much the best demonstrated move fails to lead all others by the margin.

    `values`, `demonstrated`: (row, 9); rows without a demonstrated move give 0.
    """
    best = values.masked_fill(~demonstrated, -torch.inf).max(dim=1).values
    raised = (values + margin * ~demonstrated).max(dim=1).values
    return torch.where(demonstrated.any(dim=1), raised - best, 0.0)


class Learner:
    """Online and target network, their average, optimiser and replay of one team.

    Attributes
    ----------
    online : network that each update changes
    target : follows it, and values what comes next
    average : of the online network's weights over the run: what is evaluated and saved
    updates : number of updates so far
    """

    def __init__(
        self,
        shapes: Shapes,
        streams: int,
        hyperparameters: Hyperparameters,
        seed: int,
        device: str = "cpu",
    ) -> None:
        """Prepare.

        Parameters
        ----------
        shapes : of the team's pictures
        streams : agents of the team in all episodes side by side
        seed : of the first weights
        """
        self.hyperparameters, self.updates, self._device = hyperparameters, 0, torch.device(device)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.online = DuelingNetwork(shapes).to(self._device)
        self.target, self.average = copy.deepcopy(self.online), copy.deepcopy(self.online)
        for follower in (self.target, self.average):
            follower.requires_grad_(False)
        self.optimiser = torch.optim.Adam(self.online.parameters(), hyperparameters.learning_rate)
        settings = hyperparameters.capacity, hyperparameters.n_step, hyperparameters.gamma
        self.memory = ReplayMemory(shapes, streams, *settings, device)

    @property
    def networks(self) -> tuple[DuelingNetwork, ...]:
        """The one that learns and those that follow it."""
        return self.online, self.target, self.average

    @property
    def rate(self) -> float:
        """Learning rate of the next update."""
        settings = self.hyperparameters
        halvings = self.updates / settings.rate_halves if settings.rate_halves else 0.0
        return float(settings.learning_rate * 2.0**-halvings)

    def values(self, levels: Mapping[str, NDArray[np.uint8] | Tensor]) -> NDArray[np.float32]:
        """(row, 9) values of pictures (row, ...)."""
        return values_of(self.online, levels)

    def learn(self, batch: Batch) -> tuple[dict[str, float], NDArray[np.float32]]:
        """One update from a batch that was drawn from the replay.

        Returns: loss, mean value and mean size of the errors; and the errors (row,), the new
        priorities.
        """
        moves, demonstrated = self._tensor(batch.moves), self._tensor(batch.demonstrated)
        weights = self._tensor(batch.weights)
        with one_thread():
            goal = self._goal(batch)
            values = self.online(batch.levels)
            predicted = values.gather(1, moves[:, None])[:, 0]
            error = predicted - goal
            losses = torch.nn.functional.smooth_l1_loss(predicted, goal, reduction="none")
            losses = losses + self.hyperparameters.margin_weight * lead_lacking(
                values, demonstrated, self.hyperparameters.margin
            )
            loss = (weights * losses).mean()
            self.optimiser.zero_grad(set_to_none=True)
            loss.backward()  # type: ignore[no-untyped-call]
            torch.nn.utils.clip_grad_norm_(self.online.parameters(), GRADIENT_LIMIT)
            for group in self.optimiser.param_groups:
                group["lr"] = self.rate
            self.optimiser.step()
            self.updates += 1
            self._follow()
        errors: NDArray[np.float32] = error.detach().cpu().numpy()
        facts = {
            "loss": float(loss.detach()),
            "value": float(predicted.detach().mean()),
            "error": float(np.abs(errors).mean()),
        }
        return facts, errors

    @torch.no_grad()
    def _goal(self, batch: Batch) -> Tensor:
        """(row,) what the values of the moves taken should be."""
        following, legal = batch.following, self._tensor(batch.following_legal)
        best = self.online(following).masked_fill(~legal, -torch.inf).argmax(dim=1)
        hoped: Tensor = self.target(following).gather(1, best[:, None])[:, 0]
        return self._tensor(batch.rewards) + self._tensor(batch.discount) * hoped

    @torch.no_grad()
    def _follow(self) -> None:
        """The target network comes a step nearer, and the average takes in the online weights."""
        eta = self.hyperparameters.averaging
        share = min(1.0, (eta + 1.0) / (self.updates + eta))
        for follower, part in (
            (self.target, self.hyperparameters.target_rate),
            (self.average, share),
        ):
            for mine, its in zip(follower.parameters(), self.online.parameters(), strict=True):
                mine.lerp_(its, part)

    def _tensor(self, array: NDArray[Any]) -> Tensor:
        return torch.from_numpy(array).to(self._device)

    def tensors(self) -> dict[str, Tensor]:
        """Everything that later updates depend on, for a checkpoint; `restore` takes it back."""
        memory = self.memory.arrays().items()
        return learner_state(self._modules, self.optimiser, self.updates) | {
            f"memory.{key}": torch.from_numpy(np.ascontiguousarray(one)) for key, one in memory
        }

    def restore(self, state: Mapping[str, Tensor]) -> None:
        """Restore the state that `tensors` gave."""
        self.updates = restore_learner(self._modules, self.optimiser, state)
        memory = part_of(state, "memory").items()
        self.memory.restore({name: value.numpy() for name, value in memory})

    @property
    def _modules(self) -> dict[str, DuelingNetwork]:
        return dict(zip(NETWORKS, self.networks, strict=True))
