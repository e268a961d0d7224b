"""Places of bodies from frame to frame of one episode, for replays."""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


class TrajectoryRecorder:
    """Frames of the first episode of a batch, as its dynamics records them.

    Attributes
    ----------
    interval_s : time between two frames [s]
    """

    def __init__(self) -> None:
        self.start(0.5)

    def start(self, interval_s: float) -> None:
        """Begin anew, with a frame every `interval_s` seconds."""
        self.interval_s = interval_s
        self._pose: list[NDArray[np.float32]] = []
        self._items: list[NDArray[np.float32]] = []
        self._present: list[NDArray[np.bool_]] = []
        self._wind: list[NDArray[np.float32]] = []

    def record(
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
        self._pose.append(pose.astype(np.float32)[None])
        self._items.append(items.astype(np.float32)[None])
        self._present.append(present.copy()[None])
        self._wind.append(wind.astype(np.float32)[None])

    @property
    def pose(self) -> NDArray[np.float32]:
        """(frame, agent, 3) x, y [m], yaw [rad]."""
        return _joined(self._pose)

    @property
    def items(self) -> NDArray[np.float32]:
        """(frame, item, 2) [m]."""
        return _joined(self._items)

    @property
    def present(self) -> NDArray[np.bool_]:
        """(frame, item) False once removed."""
        return _joined(self._present)

    @property
    def wind(self) -> NDArray[np.float32]:
        """(frame, 2) [m/s]."""
        return _joined(self._wind)


def _joined(parts: list[NDArray[Scalar]]) -> NDArray[Scalar]:
    """All frames as one array, which replaces them: asking after every step copies once."""
    parts[:] = [np.concatenate(parts)]
    return parts[0]
