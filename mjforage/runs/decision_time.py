"""Time of a policy's decisions, without the mission around them."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import UInt64Array
from mjforage.mission.policy import Policy, UpperBound
from mjforage.mission.task import GroundTruth, Observation, Task


@dataclass
class Timer:
    """Time of the decisions of a batch, without the first, which loads and compiles.

    Attributes
    ----------
    cpu_s : processor time of this process in `set_ground_truth` and `act`
    decisions : fleet decisions made in that time: one per episode that is not over and step
    """

    clock: Callable[[], float] = time.process_time
    cpu_s: float = 0.0
    decisions: int = 0
    _calls: int = 0

    @contextmanager
    def running(self) -> Iterator[None]:
        """Context that counts the time of its block."""
        before = self.clock()
        yield
        if self._calls:
            self.cpu_s += self.clock() - before

    def decided(self, episodes: int) -> None:
        """Note that so many episodes were decided for."""
        if self._calls:
            self.decisions += episodes
        self._calls += 1


class _Timed:
    """A policy that is timed; all else of it shows through."""

    def __init__(self, policy: Policy, timer: Timer, episodes: int) -> None:
        self._policy, self._timer, self._episodes = policy, timer, episodes

    def __getattr__(self, name: str) -> Any:
        return getattr(self._policy, name)

    def reset(self, task: Task, keys: UInt64Array) -> None:
        self._holders = max(1, keys.size // self._episodes)
        self._policy.reset(task, keys)

    def act(self, observation: Observation) -> NDArray[np.float64]:
        with self._timer.running():
            answer = self._policy.act(observation)
        self._timer.decided(int(np.count_nonzero(observation.active)) // self._holders)
        return answer


class _TimedBound(_Timed):
    def set_ground_truth(self, truth: GroundTruth) -> None:
        assert isinstance(self._policy, UpperBound)
        with self._timer.running():
            self._policy.set_ground_truth(truth)


def timed(policy: Policy, timer: Timer, episodes: int) -> Policy:
    """The policy, whose decisions are timed.

    `episodes`: of its batch; a policy that decides for every owner has a row for each.
    """
    kind = _TimedBound if isinstance(policy, UpperBound) else _Timed
    made = type(type(policy).__name__, (kind,), {})  # messages name the class
    proxy: Policy = made(policy, timer, episodes)
    return proxy
