"""How far a training run has come, and what the time of its rounds went into."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mjforage.core.schema import OPEN

Row = dict[str, float]
"""Of a log: name -> number."""


@dataclass
class Progress:
    """How far a run has come."""

    __pydantic_config__ = OPEN | {"allow_inf_nan": True}  # `best` before an evaluation

    rounds: int = 0
    episodes: int = 0
    decisions: int = 0  # steps of all episodes
    updates: int = 0  # of each team's network
    due: float = 0.0  # updates that steps have earned
    seconds: float = 0.0  # since the start of the run, over all processes that worked on it
    evaluated: int = 0  # updates at the last evaluation that was due
    best: float = float("inf")  # of the evaluations' `rank`


@dataclass
class Clock:
    """CPU seconds by what they went into."""

    seconds: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("environment", "network", "replay", "teacher"), 0.0)
    )

    def __call__(self, part: str, work: Callable[[], Any]) -> Any:
        """Do work and book its time."""
        started = time.process_time()
        result = work()
        self.seconds[part] += time.process_time() - started
        return result
