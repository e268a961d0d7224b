"""Tracks of the vessels and items of an episode, as every format of other programs has them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.forcing.record_files import utc
from mjforage.mission.setup import Setup
from mjforage.physics.dynamics.fleet_scene import fleet_vessels
from mjforage.physics.vessels import Vessel
from mjforage.runs.episode_recording import Recording
from mjforage.scenario.place import Place


@dataclass(frozen=True)
class Tracks:
    """Tracks of an episode: of its vessels, then of its items. Frame 0 is its start."""

    setup: Setup
    recording: Recording

    @property
    def place(self) -> Place | None:
        """Place of the map on the globe, if it is one."""
        return self.setup.grid.place

    def globe(self, to: str) -> Place:
        """The place, for a format that has no positions but latitude and longitude.

        Raises `UserError` if the map is none.
        """
        if self.place is None:
            raise UserError(
                f"format {to}: needs latitude and longitude; map {self.setup.grid.name} has none: "
                "make one with mjforage place, or export to csv, netcdf or mcap"
            )
        return self.place

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the vessels and of the items."""
        return *self.recording.labels, *(f"item-{k}" for k in range(len(self.recording.item_class)))

    @property
    def vessels(self) -> int:
        """Number of vessels."""
        return len(self.recording.vessels)

    @cached_property
    def hulls(self) -> tuple[Vessel, ...]:
        """Hull of each vessel."""
        return fleet_vessels(self.setup.fleet, self.setup.scenario.physics)

    @cached_property
    def t_s(self) -> NDArray[np.float64]:
        """(frame,) times from the start [s]."""
        return np.arange(len(self.recording.track_pose), dtype=np.float64) * self.recording.frame_s

    @property
    def begins_s(self) -> float:
        """UTC of the start since 1970 [s]; 0 of an episode that plays no record: it has no date."""
        return self.recording.begins_s or 0.0

    def stamps(self, t_s: Sequence[float] | NDArray[np.float64]) -> list[str | None]:
        """Times from the start as ISO 8601; None for NaN."""
        return [None if np.isnan(t) else utc(self.begins_s + t, "milliseconds") for t in t_s]

    @cached_property
    def decisions(self) -> NDArray[np.int64]:
        """(T'+1,) frames at which decisions are made, and the last."""
        every = round(self.recording.period_s / self.recording.frame_s)
        return every * np.arange(len(self.recording.agent_rc))

    @cached_property
    def told(self) -> NDArray[np.int64]:
        """(T'+1, vessel, 2) row and column that the decision led to, at step 0 those of the start;
        of older recordings those of the node that a vessel came to.
        """
        nodes, graph = self.recording.agent_target, self.setup.graph
        if nodes is None:
            return np.rint(self.recording.agent_rc).astype(np.int64)
        return np.stack((graph.rows[nodes], graph.cols[nodes]), axis=-1).astype(np.int64)

    @cached_property
    def xy_m(self) -> NDArray[np.float64]:
        """(frame, vessel and item, 2) x to the right and y up, from the south-west cell [m]."""
        pose, items = self.recording.track_pose, self.recording.track_items
        return np.concatenate([pose[..., :2], items], axis=1).astype(np.float64)

    @cached_property
    def present(self) -> NDArray[np.bool_]:
        """(frame, vessel and item) True while it is on the water."""
        items = self.recording.track_present
        return np.concatenate([np.ones((len(items), self.vessels), np.bool_), items], axis=1)

    @cached_property
    def heading_deg(self) -> NDArray[np.float64]:
        """(frame, vessel) bearing of the bow, clockwise from north (from y up if no place)."""
        north = self.place.rotation_deg if self.place else 0.0
        yaw = self.recording.track_pose[..., 2].astype(np.float64)
        return np.asarray((north + 90.0 - np.degrees(yaw)) % 360.0, np.float64)

    @cached_property
    def rate(self) -> NDArray[np.float64]:
        """(frame, vessel, 3) rates of x, y [m/s] and yaw [rad/s]: differences of the track."""
        pose = np.unwrap(self.recording.track_pose.astype(np.float64), axis=0, period=2 * np.pi)
        pose[..., :2] = self.recording.track_pose[..., :2]
        if len(pose) < 2:
            return np.zeros_like(pose)
        return np.asarray(np.gradient(pose, self.recording.frame_s, axis=0), np.float64)

    @cached_property
    def latlon(self) -> NDArray[np.float64] | None:
        """(frame, vessel and item, 2) latitude and longitude [deg, WGS 84]; None if no place."""
        cells = self.setup.graph.row_column(self.xy_m)
        return self.place.latlon(cells) if self.place else None

    @cached_property
    def collected_s(self) -> NDArray[np.float64]:
        """(item,) times of the frames in which each is no more [s]; NaN if it is there at last."""
        there = self.recording.track_present
        return np.where(there[0] & ~there[-1], self.t_s[there.argmin(axis=0)], np.nan)

    @cached_property
    def discovered_s(self) -> NDArray[np.float64]:
        """(item,) times at which each was discovered [s]; NaN if never."""
        steps = self.recording.t_discovered.astype(np.float64)
        return np.where(steps < 0, np.nan, steps * self.recording.period_s)
