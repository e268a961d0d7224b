"""Where hulls and items of a replay are at any simulated time: the track between its frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render.timeline import TURN_PART

Floats = NDArray[np.float64]
FADE_PART = 0.3  # of the time between two frames, in which a collected item vanishes


@dataclass(frozen=True, eq=False)
class Track:
    """The track of one replay, with yaw made continuous.

    Attributes
    ----------
    frame_s : time between frames [s]
    poses : (F, agent, 3) x, y [m] and yaw [rad], yaw without jumps of a full turn
    items : (F, item, 2) x, y [m]
    removed_s : (item,) when it is collected [s], infinite if never
    turn_part : part of the time between frames that a hull takes to turn
    wind : (F, 2) over ground, towards east and north [m/s]
    """

    frame_s: float
    poses: Floats
    items: NDArray[np.float32]
    removed_s: Floats
    turn_part: float
    wind: NDArray[np.float32]

    @classmethod
    def of(cls, replay: Recording) -> "Track":
        """Take the track out of a replay. At graph level hulls turn early in each step."""
        poses = replay.track_pose.astype(np.float64)
        poses[..., 2] = np.unwrap(poses[..., 2], axis=0)
        gone = ~replay.track_present
        removed = np.where(gone.any(axis=0), gone.argmax(axis=0) * replay.frame_s, np.inf)
        coarse = replay.frame_s >= replay.period_s
        turn_part = TURN_PART if coarse else 1.0
        items, wind = replay.track_items, replay.track_wind
        return cls(replay.frame_s, poses, items, removed, turn_part, wind)

    @property
    def end_s(self) -> float:
        """Time of the last frame [s]."""
        return (len(self.poses) - 1) * self.frame_s

    def hulls_at(self, time_s: float) -> Floats:
        """(agent, 3) poses; times outside the track take its nearest end."""
        before, after, part = self._between(time_s)
        first, second = self.poses[before], self.poses[after]
        pose: Floats = first + (second - first) * part
        turn = min(1.0, part / self.turn_part)
        pose[:, 2] = first[:, 2] + (second[:, 2] - first[:, 2]) * turn
        return pose

    def way(self, agent: int, times_s: Floats) -> Floats:
        """(time, 3) poses of one hull at several times."""
        place = np.clip(times_s / self.frame_s, 0.0, len(self.poses) - 1.0)
        before = np.minimum(place.astype(np.int64), max(len(self.poses) - 2, 0))
        after = np.minimum(before + 1, len(self.poses) - 1)
        part = (place - before)[:, None]
        first, second = self.poses[before, agent], self.poses[after, agent]
        turn = np.minimum(1.0, part / self.turn_part)
        poses: Floats = first + (second - first) * np.hstack((part, part, turn))
        return poses

    def items_at(self, time_s: float) -> Floats:
        """(item, 3) x, y [m] and how much of it is there: 1, falling to 0 as it is collected."""
        before, after, part = self._between(time_s)
        first = self.items[before].astype(np.float64)
        xy = first + (self.items[after] - first) * part
        left = np.clip((self.removed_s - time_s) / (FADE_PART * self.frame_s), 0.0, 1.0)
        return np.column_stack((xy, left))

    def wind_at(self, time_s: float) -> tuple[float, float]:
        """Wind over ground, towards east and north [m/s]."""
        before, after, part = self._between(time_s)
        first = self.wind[before].astype(np.float64)
        east, north = first + (self.wind[after] - first) * part
        return float(east), float(north)

    def _between(self, time_s: float) -> tuple[int, int, float]:
        """Frame before, frame after, and part of the way."""
        last = len(self.poses) - 1
        place = min(max(time_s / self.frame_s, 0.0), float(last))
        before = min(int(place), max(last - 1, 0))
        return before, min(before + 1, last), place - before
