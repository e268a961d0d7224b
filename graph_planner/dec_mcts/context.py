"""Context of the decision at hand, for the searches."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import Stream, stream_key
from mjforage.mission.task import Observation


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
        self.follows = 0.5 ** (age / self.trust)
