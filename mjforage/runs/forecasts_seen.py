"""How a policy's forecasts came true in an episode, copied while it is played again."""

import numpy as np
from numpy.typing import NDArray

from mjforage.mission.mission import Mission, Observer


class ForecastsSeen(Observer):
    """Adds up what was forecast in the first episodes of batches.

    Attributes
    ----------
    sums : (bin, 4) of all episodes that it saw, see `mjforage.metrics.calibration`
    """

    def __init__(self) -> None:
        self._now: NDArray[np.float64] | None = None
        self._before: NDArray[np.float64] | float = 0.0

    def see(self, mission: Mission) -> None:
        """Copy the sums of the episode so far; step 0 begins another one."""
        if mission.step[0] == 0 and self._now is not None:
            self._before = self.sums
        self._now = mission.forecasts.sums[0].copy()

    @property
    def sums(self) -> NDArray[np.float64]:
        """(bin, 4) so far."""
        assert self._now is not None
        return np.asarray(self._before + self._now)
