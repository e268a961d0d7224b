"""A policy's forecasts of the items, compared with the truth at every decision.

A policy that has a method `forecast`, which gives the items expected in each node as of its last
answer (row, node), forecasts for every node whether it holds an item: f = 1 - exp(-items). See
`mjforage.metrics.calibration`.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage import metrics
from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError
from mjforage.base.rows import scatter_rows

_ROUNDING = 1e-9


@kernel
def _add(
    expected: NDArray[np.float64],
    truth: NDArray[np.int16],
    active: NDArray[np.bool_],
    sums: NDArray[np.float64],
) -> bool:
    """Add forecasts (row, node) of episodes that go on to their sums (row, bin, 4); False if one is
    no number of items.
    """
    owners, bins = expected.shape[0] // max(1, active.size), sums.shape[1]
    for row in range(expected.shape[0]):
        e = row // max(1, owners)
        if not active[e]:
            continue
        for node in range(expected.shape[1]):
            sure = 1.0 - np.exp(-expected[row, node])
            if not sure > -_ROUNDING:
                return False
            there = 1.0 if truth[e, node] > 0 else 0.0
            place = min(int(sure * bins), bins - 1)
            sums[row, place, 0] += 1.0
            sums[row, place, 1] += sure
            sums[row, place, 2] += there
            sums[row, place, 3] += (sure - there) ** 2
    return True


class Forecasts:
    """Calibration sums of the forecasts of a batch of episodes so far."""

    def __init__(self, episodes: int) -> None:
        self._by_row = np.zeros((episodes, 1, metrics.BINS, 4))  # (episode, owner, bin, 4)

    @property
    def sums(self) -> NDArray[np.float64]:
        """(episode, bin, 4) sums over all forecasters, see `mjforage.metrics.calibration`."""
        return np.asarray(self._by_row.sum(axis=1))

    def take(
        self,
        expected: NDArray[np.float64],
        truth: NDArray[np.int16],
        active: NDArray[np.bool_],
        who: str = "policy",
    ) -> None:
        """Compare forecasts with the truth.

        Raises `UserError` if it is no array of numbers of that shape, or one is negative or NaN.

        Parameters
        ----------
        expected : (row, node) items, in one row or more per episode
        truth : (episode, node) items
        active : (episode,) False once it is over
        who : name of the forecaster, for messages
        """
        shape, kind = np.shape(expected), getattr(getattr(expected, "dtype", None), "kind", "")
        whole = len(shape) == 2 and shape[0] and shape[0] % max(1, active.size) == 0
        if not whole or shape[1] != truth.shape[1] or kind not in tuple("fiub"):
            was = f"{expected.dtype} {shape}" if kind else type(expected).__name__
            raise UserError(
                f"{who}: forecast gave {was}, expected numbers of shape (row, node), with "
                f"{truth.shape[1]} nodes and as many rows as it was asked about"
            )
        self._widen(shape[0] // max(1, active.size))
        sums = self._by_row.reshape(-1, *self._by_row.shape[2:])
        if not _add(np.ascontiguousarray(expected, np.float64), truth, active, sums):
            raise UserError(f"{who}: forecast gives items that are negative or NaN; give 0 or more")

    def replace_episodes(self, rows: NDArray[np.int64], other: "Forecasts") -> None:
        """Replace episodes (row,) of the batch by those of another."""
        self._widen(other._by_row.shape[1])
        self._by_row = scatter_rows(self._by_row, rows, other._by_row)

    def _widen(self, owners: int) -> None:
        """Make room for so many that forecast in an episode."""
        if self._by_row.shape[1] < owners:
            wider = np.zeros((len(self._by_row), owners, *self._by_row.shape[2:]))
            wider[:, : self._by_row.shape[1]] = self._by_row
            self._by_row = wider
