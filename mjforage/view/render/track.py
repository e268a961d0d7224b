"""Positions of vessels and items of a recording at any simulated time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording

Floats = NDArray[np.float64]
TURN_PART = 0.35  # part of a step that a vessel takes to turn in the graph world
FADE_PART = 0.3  # of the time between two frames, in which a collected item vanishes


@dataclass(frozen=True, eq=False)
class Track:
    """The track of one recording, with yaw made continuous.

    Attributes
    ----------
    frame_s : time between frames [s]
    poses : (F, agent, 3) x, y [m] and yaw [rad], yaw without jumps of a full turn
    items : (F, item, 2) x, y [m]
    removed_s : (item,) when it is collected [s], infinite if never
    turn_part : part of the time between frames that a vessel takes to turn
    wind : (F, 2) over ground, towards east and north [m/s]
    """

    frame_s: float
    poses: Floats
    items: NDArray[np.float32]
    removed_s: Floats
    turn_part: float
    wind: NDArray[np.float32]

    @classmethod
    def of(cls, recording: Recording) -> "Track":
        """Take the track out of a recording. In the graph world vessels turn early in each step."""
        poses = recording.track_pose.astype(np.float64)
        poses[..., 2] = np.unwrap(poses[..., 2], axis=0)
        gone, frame_s = ~recording.track_present, recording.frame_s
        removed = np.where(gone.any(axis=0), gone.argmax(axis=0) * frame_s, np.inf)
        turn_part = TURN_PART if frame_s >= recording.period_s else 1.0
        items, wind = recording.track_items, recording.track_wind
        return cls(frame_s, poses, items, removed, turn_part, wind)

    @property
    def end_s(self) -> float:
        """Time of the last frame [s]."""
        return (len(self.poses) - 1) * self.frame_s

    def vessels_at(self, time_s: float) -> Floats:
        """(agent, 3) poses; times outside the track take its nearest end."""
        return self._poses(self.poses, time_s)

    def way(self, agent: int, times_s: Floats) -> Floats:
        """(time, 3) poses of one vessel at several times."""
        return self._poses(self.poses[:, agent : agent + 1], times_s)[:, 0]

    def _poses(self, values: Floats, times_s: float | Floats) -> Floats:
        first, second, part = self._between(values, times_s)
        turn = np.minimum(1.0, part / self.turn_part)
        poses: Floats = first + (second - first) * np.concatenate((part, part, turn), axis=-1)
        return poses

    def items_at(self, time_s: float) -> Floats:
        """(item, 3) x, y [m] and how much of it is there: 1, falling to 0 as it is collected."""
        first, second, part = self._between(self.items, time_s)
        left = np.clip((self.removed_s - time_s) / (FADE_PART * self.frame_s), 0.0, 1.0)
        return np.column_stack((first + (second - first) * part, left))

    def wind_at(self, time_s: float) -> tuple[float, float]:
        """Wind over ground, towards east and north [m/s]."""
        first, second, part = self._between(self.wind, time_s)
        east, north = first + (second - first) * part[..., 0]
        return float(east), float(north)

    def _between(
        self, values: NDArray[np.floating], times_s: float | Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Values of the frames before and after, and the part of the way as (..., 1, 1)."""
        last = len(values) - 1
        place = np.clip(np.asarray(times_s) / self.frame_s, 0.0, last)
        before = place.astype(np.int64)
        after = np.minimum(before + 1, last)
        first, second = (values[k].astype(np.float64) for k in (before, after))
        return first, second, (place - before)[..., None, None]
