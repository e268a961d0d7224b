"""Tracks of hulls alone, for tests."""

import numpy as np
from numpy.typing import NDArray

from mjforage.view.render.track import Track


def track_of_hulls(pose: NDArray[np.float64]) -> Track:
    """Poses (F, agent, 3) every half second, no item, still air."""
    frames = len(pose)
    items, wind = np.zeros((frames, 0, 2), np.float32), np.zeros((frames, 2), np.float32)
    return Track(0.5, pose, items, np.zeros(0), 1.0, wind)
