"""Progress of a training run."""

from dataclasses import dataclass
from typing import Annotated

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
