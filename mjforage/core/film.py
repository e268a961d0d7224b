"""Where bodies are from frame to frame of one episode, for replays."""

import numpy as np
from numpy.typing import NDArray


class Film:
    """Frames of the first episode of a batch, shot by its dynamics.

    Attributes
    ----------
    interval_s : time between two frames; a dynamics that shoots less often sets it to its own
    """

    def __init__(self, interval_s: float = 0.5) -> None:
        self.interval_s = interval_s
        self._pose: list[NDArray[np.float32]] = []
        self._items: list[NDArray[np.float32]] = []
        self._present: list[NDArray[np.bool_]] = []
        self._wind: list[NDArray[np.float32]] = []

    def shoot(
        self,
        pose: NDArray[np.float64],
        items: NDArray[np.float64],
        present: NDArray[np.bool_],
        wind: NDArray[np.float64],
    ) -> None:
        """Take a frame.

        Parameters
        ----------
        pose : (agent, 3) x, y [m], yaw [rad]
        items : (item, 2) x, y [m]
        present : (item,) False once removed
        wind : (2,) over ground [m/s]
        """
        self._pose.append(pose.astype(np.float32))
        self._items.append(items.astype(np.float32))
        self._present.append(present.copy())
        self._wind.append(wind.astype(np.float32))

    @property
    def pose(self) -> NDArray[np.float32]:
        """(frame, agent, 3) x, y [m], yaw [rad]."""
        return np.stack(self._pose)

    @property
    def items(self) -> NDArray[np.float32]:
        """(frame, item, 2) [m]."""
        return np.stack(self._items)

    @property
    def present(self) -> NDArray[np.bool_]:
        """(frame, item) False once removed."""
        return np.stack(self._present)

    @property
    def wind(self) -> NDArray[np.float32]:
        """(frame, 2) [m/s]."""
        return np.stack(self._wind)
