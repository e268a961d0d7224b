"""Progress of a training run, and CPU time of its rounds by part."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any

from mjforage.base.fields import Within
from mjforage.scenario.schema import OPEN

Count = Annotated[int, Within(0, 10**15)]
Row = dict[str, float]
"""Row of a log: name -> number."""


@dataclass
class Progress:
    """Counters of a run."""

    __pydantic_config__ = OPEN | {"allow_inf_nan": True}  # `best` before an evaluation

    rounds: Count = 0
    episodes: Count = 0
    decisions: Count = 0  # steps of all episodes
    updates: Count = 0  # of each team's network
    due: Annotated[float, Within(0, 1e15)] = 0.0  # updates that steps have earned
    seconds: Annotated[float, Within(0, 1e9)] = 0.0  # over all processes that worked on the run
    evaluated: Count = 0  # updates at the last evaluation that was due
    best: float = float("inf")  # of the evaluations' `rank`


@dataclass
class Clock:
    """CPU seconds by part."""

    seconds: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("environment", "network", "replay", "teacher"), 0.0)
    )

    def __call__(self, part: str, work: Callable[[], Any]) -> Any:
        """Do work and book its time."""
        started = time.process_time()
        result = work()
        self.seconds[part] += time.process_time() - started
        return result
