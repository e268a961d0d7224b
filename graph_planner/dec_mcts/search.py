"""Options, context and draws of the searches of `dec-mcts`."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.randomness import Stream, UInt64Array, bits, mix, stream_key, to_uniform
from mjforage.mission.task import Observation

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


class TreeOptions(NamedTuple):
    """Options of the policy as kernels read them; counts, never time."""

    rounds: int  # in which distributions are exchanged
    simulations: int  # of each agent per round
    candidates: int  # sequences in a distribution
    samples: int  # of the others' sequences by which a distribution is updated
    discount: float  # worth of an item a decision later
    look_discount: float  # worth of a view a decision later
    explore: float  # factor of the confidence bound
    forget: float  # worth of a simulation one simulation later
    heat: float  # temperature at first, in ranges of the utility
    cool: float  # factor of the temperature from round to round
    rate: float  # of the gradient steps
    roam: float  # how much rollouts differ from the greedy one
    depth: int  # most stops, and moves, in a sequence
    trust: float  # decisions unheard of after which an agent is counted on half of the time


@dataclass
class DecisionContext:
    """Owner of a decided row, its time, and the chance that each team-mate follows its plan.

    Attributes
    ----------
    key, step : of the draws
    follows : (agent,) chance that each follows its known plan: half of it every `trust` decisions
        without a scan from it
    """

    trust: float
    key: np.uint64 = np.uint64(0)  # noqa: RUF009  a number
    step: int = 0
    follows: NDArray[np.float64] = field(default_factory=lambda: np.ones(0))

    def is_of(self, seen: Observation, e: int) -> None:
        """Take over a row of an observation."""
        self.key = np.uint64(stream_key(seen.keys[e], Stream.POLICY))
        self.step = int(seen.step[e])
        age = np.maximum(0, self.step - 1 - seen.agent_seen[e])
        self.follows = np.array([0.5 ** (steps / self.trust) for steps in age.tolist()])


@kernel
def begin(key: np.uint64, index: int, step: int) -> UInt64Array:
    """State (1,) of the draws of (stream key, index, step)."""
    state = np.empty(1, np.uint64)
    state[0] = bits(key, index, step)
    return state


@inlined
def draw(state: UInt64Array) -> float:
    """The next float64 in [0, 1): the steps of SplitMix64, see `randomness`."""
    state[0] += _GOLDEN
    return to_uniform(mix(state[0]))
