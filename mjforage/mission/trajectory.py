"""Places of bodies from frame to frame of one episode, for recordings."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Frames(NamedTuple):
    """Frames of an episode."""

    pose: NDArray[np.float32]  # (frame, agent, 3) x, y [m], yaw [rad]
    items: NDArray[np.float32]  # (frame, item, 2) x, y [m]
    present: NDArray[np.bool_]  # (frame, item) False once removed
    wind: NDArray[np.float32]  # (frame, 2) over ground [m/s]


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
        self._parts: list[Frames] = []

    def record(
        self,
        pose: NDArray[np.float64],
        items: NDArray[np.float64],
        present: NDArray[np.bool_],
        wind: NDArray[np.float64],
    ) -> None:
        """Take a frame, of the shapes of `Frames` without the first axis."""
        kinds = np.float32, np.float32, np.bool_, np.float32
        frame = zip((pose, items, present, wind), kinds, strict=True)
        self._parts.append(Frames(*(part[None].astype(kind) for part, kind in frame)))

    @property
    def frames(self) -> Frames:
        """All frames. They replace what was recorded: asking after every step copies once."""
        self._parts = [Frames(*map(np.concatenate, zip(*self._parts, strict=True)))]
        return self._parts[0]
