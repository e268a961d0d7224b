"""Ours pass every check of learning algorithms; each check rejects a bad one, its own."""

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import torch

from mjforage.graph_planner.networks.inference import values_of
from mjforage.graph_planner.networks.q_network import MoveNetwork
from mjforage.graph_planner.networks.weights import ACTOR
from mjforage.learning.training.algorithm import Algorithm
from mjforage.learning.training.hyperparameters import CommonHyperparameters
from mjforage.testing import ConformanceError, check_algorithm
from mjforage.testing.algorithm_checks import ALGORITHM_CHECKS
from tests.mjforage.learning.training.tiny_runs import TINY

SHORT = ("horizon=4",)


@dataclass(frozen=True)
class Settings(CommonHyperparameters):
    """Of a `Climber`."""


class Climber(Algorithm[Settings]):
    """Adds noise to its networks in every round, and counts the rounds."""

    settings, weights_kind = Settings, ACTOR

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        torch.manual_seed(self.seed)
        self.made = {t: self.network() for t, ids in self.agents.items() if ids.size}
        self.count = torch.tensor(0)

    def network(self) -> MoveNetwork:
        return MoveNetwork(self.shapes)

    @property
    def networks(self) -> Any:
        return self.made

    def play_round(self) -> Any:
        for network in self.made.values():
            for weight in network.parameters():
                weight.data += torch.from_numpy(self.noise(weight.shape)).float()
        self.start_round()
        returns = np.zeros((self.round.num_envs, self.round.agents))
        while self.on():
            returns += self.round.play(self.preferences()).rewards
        self.count = self.count + 1
        self.learn()
        return self.end_round(returns, [{"loss": float(self.count)}])

    def noise(self, shape: Any) -> Any:
        return self.random.normal(0.0, 0.02, shape)

    def on(self) -> bool:
        return bool(self.round.active.any())

    def learn(self) -> None:
        self.progress.updates += 1

    def preferences(self) -> Any:
        levels = self.round.see(np.flatnonzero(self.round.active))
        out = np.zeros((self.round.num_envs, self.round.agents, 9))
        for team, network in self.made.items():
            ids = self.agents[team]
            own = {n: v[:, ids].reshape(-1, *v.shape[2:]) for n, v in levels.items()}
            out[:, ids] = values_of(network, own).reshape(-1, ids.size, 9)
        return out

    def tensors(self) -> Any:
        parts = {t: network.state_dict() for t, network in self.made.items()}
        named = {f"{t}.{k}": v for t, part in parts.items() for k, v in part.items()}
        return {**named, "count": self.count}

    def restore(self, state: Any) -> None:
        for team, network in self.made.items():
            start = f"{team}."
            own = {k.removeprefix(start): v for k, v in state.items() if k.startswith(start)}
            network.load_state_dict(own)
        self.count = state["count"]


class OneTeam(Climber):
    @property
    def networks(self) -> Any:
        return {"scout": self.made["scout"]}


class KeepsNumbers(Climber):
    def tensors(self) -> Any:
        return {**super().tensors(), "count": int(self.count)}


class Lost(Climber):
    def network(self) -> MoveNetwork:
        made = super().network()
        next(made.parameters()).data.fill_(torch.nan)
        return made


class Still(Climber):
    def learn(self) -> None:
        """Nothing is learned."""


class Hasty(Climber):
    def on(self) -> bool:
        return bool((self.round.steps < 2).any())


class Uncounted(Climber):
    def end_round(self, returns: Any, learned: Any) -> Any:
        row = super().end_round(returns, learned)
        self.progress.rounds -= 1
        return row


class Twice(Climber):
    def end_round(self, returns: Any, learned: Any) -> Any:
        super().end_round(returns, learned)
        return super().end_round(returns, learned)


class Silent(Climber):
    def play_round(self) -> Any:
        super().play_round()


class Curt(Climber):
    def end_round(self, returns: Any, learned: Any) -> Any:
        super().end_round(returns, learned)
        return {"rounds": 1.0, "updates": 1.0}


class Chancy(Climber):
    def noise(self, shape: Any) -> Any:
        return np.random.default_rng().normal(0.0, 0.02, shape)


class Stubborn(Climber):
    def restore(self, state: Any) -> None:
        """Nothing is brought back."""


class Forgetful(Climber):
    momentum = 0.0

    def noise(self, shape: Any) -> Any:
        self.momentum += 0.001
        return super().noise(shape) + self.momentum


class Talkative(Climber):
    def end_round(self, returns: Any, learned: Any) -> Any:
        return super().end_round(returns, [{"loss": 0.0, "entropy": 1.0}])


class Shaken(MoveNetwork):
    def forward(self, levels: Any) -> Any:
        return super().forward(levels) + torch.arange(9)


class Unsaved(Climber):
    def network(self) -> MoveNetwork:
        return Shaken(self.shapes)


class Misshapen(Climber):
    def preferences(self) -> Any:
        return super().preferences()[:, :, :8]


class Wordy(MoveNetwork):
    def forward(self, levels: Any) -> Any:
        return super().forward(levels)[:, 0]


class Critical(Climber):
    def network(self) -> MoveNetwork:
        return Wordy(self.shapes)


class Live(Climber):
    """Learns from the first pictures, which are the last ones by then."""

    first: Any = None

    def preferences(self) -> Any:
        if self.first is None or not self.round.steps.any():
            self.first = self.round.see(np.flatnonzero(self.round.active))["own"]
        return super().preferences()

    def learn(self) -> None:
        super().learn()
        weight = next(self.made["scout"].parameters())
        weight.data += 1e-6 * float(self.first.astype(np.float64).sum())


class Apart(Climber):
    @property
    def networks(self) -> Any:
        return copy.deepcopy(self.made)


def test_one_that_keeps_the_rules_passes() -> None:
    check_algorithm(Climber, overrides=SHORT, rounds=1)


@pytest.mark.parametrize("ours", ["ddqn", "mappo"])
def test_ours_pass(ours: str) -> None:
    small = TINY if ours == "ddqn" else {"num_envs": 2, "epochs": 1}
    check_algorithm(ours, "published", overrides=("horizon=8",), settings=small)


@pytest.mark.parametrize(
    ("made", "check", "words"),
    [
        (OneTeam, "parts", "networks has nothing for forager, which has agents; give every such"),
        (KeepsNumbers, "parts", "has a int in count; make it a torch.Tensor"),
        (Lost, "networks", "has one of scout that gives .*nan.*; mend it"),
        (Still, "rounds", "made no update in 2 rounds; count them in self.progress.updates"),
        (Hasty, "rounds", "left episodes that go on; play until none is active"),
        (Uncounted, "rounds", "gave rounds = 1 where self.progress has 0; return what"),
        (Twice, "rounds", "counts 2 rounds after 1; call self.start_round and self.end_round"),
        (Curt, "rounds", "gave a row without episodes, seconds, pta_c; return what self.end_round"),
        (Silent, "rounds", "play_round gave NoneType; return what self.end_round gives"),
        (Critical, "networks", r"of scout that gives \(4,\) for 4 rows; `networks` has those that"),
        (Live, "copies", "gave weights scout.* by the arrays of self.round.see and once by copies"),
        (Apart, "beginning", "theirs and its; `networks` gives the modules that train"),
        (Talkative, "rounds", "updates report entropy; name them in its `learned`, or leave"),
        (Misshapen, "rounds", r"play was given float64 \(2, 4, 8\), expected numbers of shape"),
        (Chancy, "repeats", "of one seed gave weights scout.* and .*; draw from self.random alone"),
        (Stubborn, "resuming", "has weights scout.* before and after `restore`; bring back there"),
        (Forgetful, "resuming", "in one go and by a checkpoint on the way; keep in `tensors`"),
        (Unsaved, "weights", "by its networks and by their file; save what is played"),
    ],
)
def test_each_check_rejects_its_own(made: Any, check: str, words: str) -> None:
    with pytest.raises(ConformanceError, match=words) as caught:
        check_algorithm(made, overrides=SHORT, rounds=1)
    assert caught.value.check == check
    assert check in {each.__name__.removeprefix("check_") for each in ALGORITHM_CHECKS}
