"""Everything that a training run can be told. With the scenario and the seed it decides a run."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from mjforage.core.errors import UserError
from mjforage.core.scenario import bounded
from mjforage.learning.environments.rewards import checked_weights

REWARD = MappingProxyType(
    {
        "removed": 0.5,
        "team_removed": 2.0,
        "discovered": 0.5,
        "idleness": 0.01,
        "approach": 0.05,
        "time": -0.02,
    }
)
"""Weights that we train with: items count, for all, and what leads to them; the clock ticks."""


@dataclass(frozen=True)
class Hyperparameters:
    """Hyper-parameters; the paper's where it states them (scenario section 3)."""

    observation: str = "egocentric"
    num_envs: int = field(default=16, metadata=bounded(1, 4096))  # episodes side by side in a round
    gamma: float = field(default=0.99, metadata=bounded(0, 1))  # paper
    n_step: int = field(default=3, metadata=bounded(1, 50))
    batch: int = field(default=128, metadata=bounded(1, 65536))  # paper
    learning_rate: float = field(default=3e-4, metadata=bounded(0, 1))  # paper: 1e-4
    rate_updates: int = field(default=30_000, metadata=bounded(1, 1_000_000_000))
    """Updates over which the learning rate falls to a tenth, in a straight line."""
    capacity: int = field(default=60_000, metadata=bounded(1000, 10_000_000))
    """Decisions in the replay of each team."""
    priority: float = field(default=0.6, metadata=bounded(0, 1))  # alpha of the replay
    correction: float = field(default=0.4, metadata=bounded(0, 1))  # beta of the replay
    target_rate: float = field(default=0.005, metadata=bounded(0, 1))
    """Share by which the target network follows at each update."""
    updates_per_step: float = field(default=1.0, metadata=bounded(1e-3, 1000))
    """Updates of each team's network per step of the whole batch of episodes."""
    warmup: int = field(default=4000, metadata=bounded(0, 10_000_000))
    """Decisions in a team's replay before its first update; a full replay will do with fewer."""
    explore_from: float = field(default=1.0, metadata=bounded(0, 1))
    explore_to: float = field(default=0.05, metadata=bounded(0, 1))
    explore_updates: int = field(default=8000, metadata=bounded(1, 1_000_000_000))
    """Updates over which the share of random moves falls from `explore_from` to `explore_to`."""
    teacher: str = ""
    """Policy that shows moves; empty: reward alone."""
    teacher_updates: int = field(default=0, metadata=bounded(0, 1_000_000_000))
    """Updates during which there are shown moves; the share of episodes it plays falls to 0."""
    margin: float = field(default=0.3, metadata=bounded(0, 100))
    """By how much a shown move has to be better than the others (Hester et al. 2018)."""
    margin_weight: float = field(default=3.0, metadata=bounded(0, 100))
    evaluate_every: int = field(default=2000, metadata=bounded(1, 1_000_000_000))  # updates
    evaluate_episodes: int = field(default=48, metadata=bounded(1, 100_000))
    reward: Mapping[str, float] = field(default_factory=lambda: REWARD)

    def __post_init__(self) -> None:
        for entry in dataclasses.fields(self):
            low, high = entry.metadata.get("low"), entry.metadata.get("high")
            value = getattr(self, entry.name)
            if low is not None and not low <= value <= high:
                raise UserError(f"{entry.name} = {value}: out of range; give {low:g} to {high:g}")
        if self.warmup > self.capacity:
            raise UserError(
                f"warmup = {self.warmup}: the replay holds only capacity = {self.capacity} "
                "decisions; give less, or more capacity"
            )
        if bool(self.teacher) != bool(self.teacher_updates):
            raise UserError(
                f"teacher = {self.teacher!r}, teacher_updates = {self.teacher_updates}: give both, "
                "such as --teacher belief --learning teacher_updates=6000, or neither"
            )
        checked_weights(self.reward)

    def tree(self) -> dict[str, Any]:
        """As plain values."""
        plain = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return plain | {"reward": dict(self.reward)}


def changed(hyperparameters: Hyperparameters, changes: Mapping[str, Any]) -> Hyperparameters:
    """Hyperparameters with some values replaced; `reward.TERM` replaces one weight.

    Raises
    ------
    UserError
        If a name is not known, or a value has the wrong type or is out of range.
    """
    known = {f.name: f for f in dataclasses.fields(Hyperparameters)}
    values: dict[str, Any] = {}
    reward = dict(hyperparameters.reward)
    for name, value in changes.items():
        first, _, term = name.partition(".")
        if first == "reward" and term:
            reward[term] = value
        elif name not in known or name == "reward":
            raise UserError(f"{name}: unknown setting; known: {', '.join(known)}, reward.TERM")
        else:
            kind = type(getattr(hyperparameters, name))
            if type(value) is not kind and not (kind is float and type(value) is int):
                raise UserError(f"{name} = {value!r}: expected {kind.__name__}")
            values[name] = kind(value)
    return dataclasses.replace(hyperparameters, **values, reward=MappingProxyType(reward))
