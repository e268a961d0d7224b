"""What a policy forecasts of the items, held against the truth as it decides.

A policy that has a `forecast`, (row, node) items expected in each node by what each row knows,
foretells for every node whether it holds an item: f = 1 - exp(-items). See `metrics.calibration`.
"""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

import metrics
from graph_planner.compiled import kernel


@runtime_checkable
class Forecaster(Protocol):
    """A policy that forecasts."""

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected, as of its last answer."""
        ...


@kernel
def _add(
    expected: NDArray[np.float64],
    truth: NDArray[np.int16],
    active: NDArray[np.bool_],
    sums: NDArray[np.float64],
) -> None:
    """Add forecasts (row, node) of episodes that go on to their sums (episode, bin, 4)."""
    holders, bins = expected.shape[0] // max(1, active.size), sums.shape[1]
    for row in range(expected.shape[0]):
        e = row // max(1, holders)
        if not active[e]:
            continue
        for node in range(expected.shape[1]):
            sure = 1.0 - np.exp(-expected[row, node])
            there = 1.0 if truth[e, node] > 0 else 0.0
            place = min(int(sure * bins), bins - 1)
            sums[e, place, 0] += 1.0
            sums[e, place, 1] += sure
            sums[e, place, 2] += there
            sums[e, place, 3] += (sure - there) ** 2


class Forecasts:
    """Sums of a batch of episodes so far: (episode, bin, 4), see `metrics.calibration`."""

    def __init__(self, episodes: int) -> None:
        self.sums = np.zeros((episodes, metrics.BINS, 4))

    def take(
        self, expected: NDArray[np.float64], truth: NDArray[np.int16], active: NDArray[np.bool_]
    ) -> None:
        """Hold forecasts against the truth.

        Parameters
        ----------
        expected : (row, node) items, in one row or more per episode
        truth : (episode, node) items
        active : (episode,) False once it is over
        """
        _add(np.ascontiguousarray(expected, np.float64), truth, active, self.sums)
