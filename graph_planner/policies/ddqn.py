"""Policies by weights, a network per team: any file, the Double DQN's (paper, "Experimental Study")
and multi-agent PPO's. Playing them needs torch, not TorchRL.
"""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import WeightsError
from mjforage.base.extras import require
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.encodings import create_encoder, encoder_class
from mjforage.graph_planner.networks.weights import (
    ACTOR,
    Q_NETWORK,
    TEAMS,
    load_networks,
    read_header,
    shipped_weights,
)
from mjforage.graph_planner.policies.registry import plays_weights, register
from mjforage.mission.plain import Plain
from mjforage.mission.task import Observation, Task

if TYPE_CHECKING:
    from mjforage.graph_planner.networks.q_network import MoveNetwork


@plays_weights
class QPolicy:
    """Preferences by the networks of a weight file: values, or logits.

    Raises `WeightsError` if the file is missing or of another kind; on `reset`, if it does not fit
    the task. Raises `UserError` if torch is not installed.
    """

    network_device = "cpu"  # of torch, where its networks decide; missions set it

    def __init__(self, path: Path) -> None:
        require(f"policy {path.stem}", "torch")
        self._path = path
        self.files = (path,)
        self._header = read_header(path)
        self._networks: dict[str, MoveNetwork] = {}

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._networks, self._plain = self._load(task), Plain(task, keys.size)
        if self.network_device != "cpu":  # others may have the same networks elsewhere
            each = copy.deepcopy(self._networks).items()
            self._networks = {team: network.to(self.network_device) for team, network in each}
        self._teams = (task.fleet.discoverers, task.fleet.collectors)
        self._encoder = create_encoder(self._header.encoding, task)
        self._encoder.reset(keys.size)
        self._preferences = np.zeros((keys.size, len(task.fleet), 9))

    @property
    def parts(self) -> tuple[Callable[..., Any], ...]:
        """The encoder that the weights were made for."""
        return (encoder_class(self._header.encoding),)

    def _load(self, task: Task) -> "dict[str, MoveNetwork]":
        return load_networks(self._path, task)  # and thereby torch

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Values or logits (episode, agent, 9) of all moves."""
        from mjforage.graph_planner.networks.inference import values_of

        observation = self._plain(observation)
        rows = np.flatnonzero(observation.active)
        levels = self._encoder.see(observation, rows)
        for team, agents in zip(TEAMS, self._teams, strict=True):
            if agents.size:
                index = np.ix_(rows, agents)
                flat = {n: v[index].reshape(-1, *v.shape[2:]) for n, v in levels.items()}
                values = values_of(self._networks[team], flat)
                self._preferences[index] = values.reshape(rows.size, agents.size, 9)
        return self._preferences


class ShippedPolicy(QPolicy):
    """A `QPolicy` with weights that ship.

    Raises `WeightsError` as `QPolicy`, and if the file holds networks of another algorithm.
    """

    weights: ClassVar[str]  # name of the file in `models/weights`
    told: ClassVar[str] = "their law, by training"
    kind: ClassVar[str] = Q_NETWORK  # of `mjforage.graph_planner.networks.weights.KINDS`

    def __init__(self) -> None:
        super().__init__(shipped_weights(self.weights))
        if self._header.format != self.kind:
            raise WeightsError(
                f"weights {self._path}: format {self._header.format!r}, expected {self.kind!r}; "
                "get the file again"
            )


@register("ddqn-reward")
class DdqnRewardPolicy(ShippedPolicy):
    """Double dueling DQN, trained from reward alone as in the paper."""

    weights = "ddqn-reward"


@register("ddqn")
class DdqnPolicy(ShippedPolicy):
    """Double dueling DQN, the best shipped weights: shown moves by the belief planner at first."""

    weights = "ddqn"


@register("ddqn-link")
class DdqnLinkPolicy(ShippedPolicy):
    """Double dueling DQN, trained as `ddqn` but over a link that every episode drew anew."""

    weights = "ddqn-link"


@register("mappo")
class MappoPolicy(ShippedPolicy):
    """Multi-agent PPO, actors shared per team, a critic that sees all in training."""

    weights, kind = "mappo", ACTOR
