"""Settings of a training run. With the scenario and the seed they decide a run."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Annotated, Any, TypeVar

from mjforage.base.errors import UserError
from mjforage.base.fields import Within, source
from mjforage.learning.environments.rewards import DDQN, checked_weights
from mjforage.scenario.schema import check, check_fields

WHERE = "learning settings"  # where settings come from, for messages


@dataclass(frozen=True)
class CommonHyperparameters:
    """Settings of every algorithm."""

    observation: str = "egocentric"
    """Observation that networks read."""
    world: str = "graph"
    """World in which episodes and evaluations are played: graph or physics, or one between."""
    initial: str = ""
    """Policy, or FILE.safetensors, whose weights the networks begin with; empty: random ones."""
    num_envs: Annotated[int, Within(1, 4096)] = 16
    """Episodes side by side in a round."""
    evaluate_every: Annotated[int, Within(1, 1_000_000_000)] = 2000
    """Updates between two evaluations."""
    evaluate_episodes: Annotated[int, Within(1, 100_000)] = 48
    """Episodes of an evaluation."""
    reward: Mapping[str, float] = field(default_factory=lambda: MappingProxyType(DDQN))
    """Weight of each term of the reward."""
    vary: Mapping[str, tuple[Any, ...]] = field(default_factory=lambda: MappingProxyType({}))
    """Keys of the scenario, each with values: an episode draws one of each, all equally likely."""

    def __post_init__(self) -> None:
        check_fields(self, WHERE)
        checked_weights(self.reward)
        if hasattr(self, "teacher") and hasattr(self, "teacher_updates"):
            check_teacher(self.teacher, self.teacher_updates)

    def tree(self) -> dict[str, Any]:
        """Hyperparameters as plain values."""
        plain = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return plain | {"reward": dict(self.reward), "vary": dict(self.vary)}


Settings = TypeVar("Settings", bound=CommonHyperparameters)


@dataclass(frozen=True)
class Hyperparameters(CommonHyperparameters):
    """Hyper-parameters of the Double DQN, the paper's where stated (definitions, section 3)."""

    gamma: Annotated[float, Within(0, 1), source("paper")] = 0.99
    """Discount per step."""
    n_step: Annotated[int, Within(1, 50)] = 3
    """Steps of a return before the target network takes over."""
    batch: Annotated[int, Within(1, 65536), source("paper")] = 128
    """Decisions of an update."""
    learning_rate: Annotated[float, Within(0, 1)] = 3e-4
    """Learning rate of the optimiser; the paper has 1e-4."""
    rate_halves: Annotated[int, Within(0, 1_000_000_000)] = 0
    """Updates N after which the learning rate is half as large, again and again: after n it is
    2^(-n / N) of itself, so all steps together are N / ln 2 of the first; 0: it is constant."""
    capacity: Annotated[int, Within(1000, 10_000_000)] = 60_000
    """Decisions in the replay of each team."""
    priority: Annotated[float, Within(0, 1)] = 0.6
    """Exponent alpha by which the replay prefers large errors."""
    correction: Annotated[float, Within(0, 1)] = 0.4
    """Exponent beta by which the replay corrects for that."""
    target_rate: Annotated[float, Within(0, 1)] = 0.005
    """Share by which the target network follows at each update."""
    averaging: Annotated[float, Within(0, 1000)] = 1.0
    """Exponent eta of the average of weights that is evaluated and saved: after n updates they are
    n / (eta + 2) updates old on average."""
    updates_per_step: Annotated[float, Within(1e-3, 1000)] = 1.0
    """Updates of each team's network per step of the whole batch of episodes."""
    warmup: Annotated[int, Within(0, 10_000_000)] = 4000
    """Decisions in a team's replay before its first update; a full replay will do with fewer."""
    explore_from: Annotated[float, Within(0, 1)] = 1.0
    """Share of random moves at first."""
    explore_to: Annotated[float, Within(0, 1)] = 0.05
    """Share of random moves in the end."""
    explore_updates: Annotated[int, Within(1, 1_000_000_000)] = 8000
    """Updates over which the share of random moves falls from `explore_from` to `explore_to`."""
    teacher: str = ""
    """Policy that demonstrates moves; empty: reward alone."""
    teacher_updates: Annotated[int, Within(0, 1_000_000_000)] = 0
    """Updates with demonstrated moves; the share of episodes that the teacher plays falls to 0."""
    margin: Annotated[float, Within(0, 100)] = 0.3
    """Least margin of a demonstrated move over the others (Hester et al. 2018)."""
    margin_weight: Annotated[float, Within(0, 100)] = 3.0
    """Weight of the demonstrated moves' loss."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.warmup > self.capacity:
            raise UserError(
                f"warmup = {self.warmup}: the replay holds only capacity = {self.capacity} "
                "decisions; give less, or more capacity"
            )


def check_teacher(teacher: str, updates: int) -> None:
    """Refuse a teacher without time to teach, and the other way round."""
    if bool(teacher) != bool(updates):
        raise UserError(
            f"teacher = {teacher!r}, teacher_updates = {updates}: give both, "
            "such as teacher = belief and teacher_updates = 6000, or neither"
        )


def changed(hyperparameters: Settings, changes: Mapping[str, Any]) -> Settings:
    """Hyperparameters with some values replaced; `reward.TERM` and `vary.KEY` replace one entry.

    Raises `UserError` if a name is not known, or a value has the wrong type or is out of range.
    """
    tree = hyperparameters.tree()
    for name, value in changes.items():
        table, _, key = name.partition(".")
        if table in ("reward", "vary") and key:
            tree[table][key] = value
        else:
            tree[name] = value
    return check(type(hyperparameters), tree, WHERE)
