"""Settings of multi-agent PPO.

Yu: Yu et al. (2022), *The Surprising Effectiveness of PPO in Cooperative Multi-Agent Games*,
NeurIPS 35, section 5 and the tables of its appendix.
"""

from dataclasses import dataclass
from typing import Annotated

from mjforage.base.fields import Within, source
from mjforage.learning.training.hyperparameters import CommonHyperparameters


@dataclass(frozen=True)
class MappoHyperparameters(CommonHyperparameters):
    """Hyper-parameters of multi-agent PPO; those of Yu et al. (2022) where they state them."""

    num_envs: Annotated[int, Within(1, 4096)] = 32
    """Episodes side by side in a round, from all of which it then learns."""
    evaluate_every: Annotated[int, Within(1, 1_000_000_000)] = 400
    """Updates between two evaluations."""
    gamma: Annotated[float, Within(0, 1), source("Yu")] = 0.99
    """Discount per step."""
    gae: Annotated[float, Within(0, 1), source("Yu")] = 0.95
    """Lambda of the generalised advantage estimate (Schulman et al. 2016)."""
    shared: Annotated[float, Within(0, 1)] = 0.0
    """Share of every reward that all agents get the mean of; the rest is an agent's own. Yu has 1;
    here terms such as `team_removed` are for all already."""
    learning_rate: Annotated[float, Within(0, 1)] = 2e-3
    """Learning rate of actors and critic, at first; Yu has 5e-4."""
    rate_updates: Annotated[int, Within(1, 1_000_000_000)] = 5000
    """Updates over which the learning rate falls to a tenth, in a straight line; Yu keeps it."""
    gain: Annotated[float, Within(1e-6, 100)] = 1.0
    """Gain of the actors' last layer at first; Yu has 0.01."""
    epochs: Annotated[int, Within(1, 100)] = 4
    """Passes over a round's decisions; Yu has 5 to 15, fewer for harder tasks."""
    batch: Annotated[int, Within(1, 1_000_000)] = 256
    """Steps of an update, each with all agents; Yu takes whole rounds or halves."""
    clip: Annotated[float, Within(0, 1), source("Yu")] = 0.2
    """Limit of an update's change of the ratio of probabilities, and of the normalised value."""
    entropy_from: Annotated[float, Within(0, 1), source("Yu")] = 0.01
    """Weight of the policy's entropy at first."""
    entropy_to: Annotated[float, Within(0, 1)] = 0.001
    """Weight of the policy's entropy in the end; Yu keeps it."""
    entropy_updates: Annotated[int, Within(1, 1_000_000_000)] = 4000
    """Updates over which the weight goes from `entropy_from` to `entropy_to`."""
    gradient_limit: Annotated[float, Within(0, 1e6), source("Yu")] = 10.0
    """Norm of an update's gradients at most, of the actors and of the critic."""
    teacher: str = ""
    """Policy that demonstrates moves at first; empty: reward alone, as Yu has it."""
    teacher_updates: Annotated[int, Within(0, 1_000_000_000)] = 0
    """Updates of a warm start, in which actors learn demonstrated moves and the critic values them;
    the share of episodes that the teacher plays falls to 0."""
