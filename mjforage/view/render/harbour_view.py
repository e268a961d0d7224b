"""A replay seen in three dimensions: one frame at any time of the episode."""

import dataclasses
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.runs.episode_recording import Recording
from mjforage.view.render.cameras import CAMERAS, Area, Camera, Circumstances, View, magnified
from mjforage.view.render.frame_split import Box, is_brief, split_frame, unit_of
from mjforage.view.render.harbour import PaddedLand
from mjforage.view.render.markings import lay_hull, lay_rings
from mjforage.view.render.opengl import Canvas
from mjforage.view.render.palette import agent_colours
from mjforage.view.render.sheet import Sheet, blank_sheet
from mjforage.view.render.side_panel import Moment, SidePanel
from mjforage.view.render.smoothing import smooth_edges
from mjforage.view.render.stage import Look, Stage, build_look, distance_ahead, mirrored
from mjforage.view.render.tags import Tags
from mjforage.view.render.timeline import split_time, timeline_of
from mjforage.view.render.track import Track
from mjforage.view.render.wakes import TRAIL_STEPS
from mjforage.view.render.water import Water, shore_of

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]
_CALM_FILM = 2.0  # faster films slow their waves down to so many times their pace
_MARGIN_M = 3.0  # beyond the water where hulls of life size leave no marks
_FINEST_M = 0.09  # texel of the sheet near a hull
_MIRROR_SHARE = 2  # the mirrored picture is so many times smaller


class HarbourView:
    """Draws frames (height, width, 3) uint8 of one replay through MuJoCo; close it after use.

    Parameters
    ----------
    replay : the episode, of any world
    camera : name in `CAMERAS`
    width, height : of a frame [pixel]
    follow : name of a vessel, such as ``scouts_0``, for the cameras that follow one; by default the
        first that collects for chase, the first that does not for scout
    speed : simulated seconds per second of film; smooths the camera and calms the waves
    detail : pictures are drawn so many times larger each way and shrunk
    panel : whether a panel takes its part of the frame; without one all of it is picture
    shares : a view of the same bodies, no smaller, whose canvas this one draws on, as a process has
        but one; it is to be closed after this one
    """

    def __init__(
        self,
        replay: Recording,
        camera: str,
        width: int,
        height: int,
        *,
        follow: str | None = None,
        speed: float = 1.0,
        detail: int = 1,
        panel: bool = True,
        shares: "HarbourView | None" = None,
    ) -> None:
        """Open the view.

        Raises
        ------
        UserError
            If there is no such camera or vessel, or no OpenGL.
        """
        self._camera = _camera_named(camera)
        kind = self._camera
        self._replay, self._track, self._timeline = replay, Track.of(replay), timeline_of(replay)
        area = water_area(replay)
        self._scales = magnified(kind, area)
        self._look: Look = build_look(replay, *self._scales) if shares is None else shares._look
        self._followed = followed_agent(replay, self._look.labels, camera, follow)
        self._stage = Stage(self._look, self._scales[1])
        self._colours = agent_colours(replay.agent_collects.tolist())
        self._frame = np.empty((height, width, 3), np.uint8)
        self._place = Box(0, 0, width, height)
        self._panel: SidePanel | None = None
        if panel:
            self._place, self._panel = self._shared_frame(width, height, area)
        width, height = round(self._place.width), round(self._place.height)
        self._circumstances = Circumstances(
            self._track,
            area,
            width / height,
            speed,
            self._followed,
            self._look.masts[self._followed],
        )
        self._surface_rate = min(1.0, _CALM_FILM / speed)
        self._water = Water(shore_of(PaddedLand.of(replay.navigable, replay.pitch_m)))
        self._tags: Tags | None = None
        if not kind.follows and not is_brief(width, height):
            unit = unit_of(self._frame.shape[1], self._frame.shape[0])
            self._tags = Tags(self._look.labels, self._colours, width, unit)
        self._size, self._detail = (height, width), detail
        drawn = detail * height, detail * width
        self._rgb, self._depth = _buffers(drawn)
        self._mirror = _buffers((drawn[0] // _MIRROR_SHARE, drawn[1] // _MIRROR_SHARE))
        self._owns = shares is None
        self._canvas: Canvas = (
            Canvas(self._look.model, drawn[1], drawn[0]) if not shares else shares._canvas
        )

    def _shared_frame(self, width: int, height: int, area: Area) -> tuple[Box, SidePanel]:
        """Where the picture goes in a frame with a panel, and that panel."""
        split = split_frame(width, height, None if self._camera.follows else _shape(area))
        return split.view, SidePanel(
            self._replay, self._timeline, split, self._colours, self.followed
        )

    def go_on(self, replay: Recording) -> None:
        """Draw from now on from a replay that goes further in the same episode."""
        self._replay, self._track, self._timeline = replay, Track.of(replay), timeline_of(replay)
        self._circumstances = dataclasses.replace(self._circumstances, track=self._track)

    @property
    def about(self) -> str:
        """What draws, for people."""
        return self._canvas.about

    def close(self) -> None:
        """Give OpenGL back."""
        if self._owns:
            self._canvas.close()

    def __enter__(self) -> "HarbourView":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def frame(self, time: float) -> Image:
        """Draw the state at `time` [step], 0 to the length of the episode.

        Raises
        ------
        ValueError
            If `time` lies outside the episode.
        """
        split_time(time, self._timeline.length)
        time_s = time * self._replay.period_s
        hulls, items = self._track.hulls_at(time_s), self._track.items_at(time_s)
        known = self._timeline.known <= time
        surface_s = self._surface_rate * time_s
        self._stage.place(afloat(hulls, surface_s), floating(items, surface_s), known)
        view = self._camera.view(self._circumstances, time_s)
        picture = self._picture(view, self._sheet(time_s, hulls, items, known), surface_s)
        self._write_names(picture, view, hulls)
        if self._panel is None:
            return picture
        frame = self._frame.copy()
        left, top, right, bottom = (round(side) for side in self._place)
        frame[top:bottom, left:right] = picture
        self._panel.paint(frame, time, self.moment(time))
        return frame

    def moment(self, time: float) -> Moment:
        """What a panel tells of `time` [step] beside the picture."""
        time_s = time * self._replay.period_s
        hulls = self._track.hulls_at(time_s)
        node, rows = hulls[:, :2] / self._replay.pitch_m, self._replay.navigable.shape[0]
        places = np.column_stack((rows - 1 - node[:, 1], node[:, 0], -hulls[:, 2]))
        north_rad = self._camera.view(self._circumstances, time_s).north_rad
        return Moment(places, self._notes(time), north_rad, self._track.wind_at(time_s))

    @property
    def followed(self) -> int | None:
        """The agent that the camera follows, if it follows one."""
        return self._followed if self._camera.follows else None

    def _picture(self, view: View, sheet: Sheet, surface_s: float) -> Image:
        """MuJoCo's two pictures with the water between them."""
        near, aspect = self._camera.near_m, self._size[1] / self._size[0]
        mirror, mirror_ahead = _mirror_of_nothing()
        if self._camera.follows:  # from afar one looks into the water, not along it
            self._canvas.draw(self._stage.seen(mirrored(view), aspect, near), *self._mirror)
            mirror = np.ascontiguousarray(self._mirror[0][::-1])
            mirror_ahead = np.ascontiguousarray(distance_ahead(self._mirror[1], near)[::-1])
        self._canvas.draw(self._stage.seen(view, aspect, near), self._rgb, self._depth)
        image = np.ascontiguousarray(self._rgb[::-1])
        ahead = np.ascontiguousarray(distance_ahead(self._depth, near)[::-1])
        self._water.paint(image, ahead, mirror, mirror_ahead, sheet, view, surface_s)
        smooth_edges(image, self._rgb)
        return shrunk(self._rgb, self._detail)

    def _sheet(
        self, time_s: float, hulls: Floats, items: Floats, known: NDArray[np.bool_]
    ) -> Sheet:
        """Everything that lies on the water now."""
        hull_scale, item_scale = self._scales
        camera, lasting = self._camera, TRAIL_STEPS * self._replay.period_s
        if camera.ground_m is None:
            area = self._circumstances.area.grown(_MARGIN_M * hull_scale)
        else:
            x, y = hulls[self._followed, :2].tolist()
            half = 0.5 * camera.ground_m
            area = Area(x - half, y - half, x + half, y + half)
        pixel_m = max(area.east - area.west, area.north - area.south) / max(self._size)
        sheet = blank_sheet(area, max(_FINEST_M, 0.8 * pixel_m / self._detail))
        for agent, vessel in enumerate(self._look.vessels):
            colour = None if camera.follows else self._colours[agent]
            lay_hull(sheet, self._track, agent, vessel, time_s, hull_scale, colour, lasting)
        lay_rings(sheet, items, known, time_s - self._track.removed_s, item_scale, camera.follows)
        return sheet

    def _write_names(self, image: Image, view: View, hulls: Floats) -> None:
        if self._tags is None:
            return
        height, width = self._size
        middles = np.column_stack((hulls[:, :2], np.zeros(len(hulls))))
        half_m = 0.5 * self._scales[0] * np.array([one.length_m for one in self._look.vessels])
        x, y, ahead = view.project(middles, width / height).T
        aside = view.project(middles + half_m[:, None] * view.right, width / height)[:, 0]
        inside = (ahead > 0.0) & (np.abs(x) < 1.0) & (np.abs(y) < 1.0)
        places = np.column_stack((0.5 * width * (1.0 + x), 0.5 * height * (1.0 - y)))
        radius = 0.5 * width * np.abs(aside - x)
        self._tags.paint(image, np.where(inside[:, None], places, np.nan), radius)

    def _notes(self, time: float) -> str:
        """What a viewer cannot know from the picture."""
        camera = self._camera
        if not camera.follows:
            hulls, items = self._scales
            return f"hulls {hulls:.2g} x, debris {items:.2g} x"
        time_s = time * self._replay.period_s
        way = self._track.way(self._followed, time_s + np.array([-0.5, 0.5]))
        speed = float(np.linalg.norm(way[1, :2] - way[0, :2]))
        return f"{self._look.labels[self._followed]} · {speed:.1f} m/s"


def _camera_named(name: str) -> Camera:
    if name not in CAMERAS:
        raise UserError(f"camera {name}: unknown; {nearest(name, CAMERAS)}")
    return CAMERAS[name]


def followed_agent(
    replay: Recording, labels: tuple[str, ...], camera: str, follow: str | None
) -> int:
    """Number of the vessel that a camera belongs to.

    Raises
    ------
    UserError
        If there is no such vessel, or the camera follows none.
    """
    if follow is None:
        wanted = replay.agent_collects if camera == "chase" else ~replay.agent_collects
        return int(np.argmax(wanted))
    if not CAMERAS[camera].follows:
        followers = " and ".join(name for name, kind in CAMERAS.items() if kind.follows)
        raise UserError(f"follow {follow}: camera {camera} follows nobody; {followers} do")
    if follow not in labels:
        raise UserError(f"follow {follow}: no such vessel; choose {', '.join(labels)}")
    return labels.index(follow)


def water_area(replay: Recording) -> Area:
    """The rectangle of the map that holds its water."""
    row, column = np.nonzero(replay.navigable)
    last, pitch = replay.navigable.shape[0] - 1, replay.pitch_m
    return Area(
        (column.min() - 0.5) * pitch,
        (last - row.max() - 0.5) * pitch,
        (column.max() + 0.5) * pitch,
        (last - row.min() + 0.5) * pitch,
    )


def _shape(area: Area) -> float:
    """Width by height."""
    return (area.east - area.west) / (area.north - area.south)


def afloat(hulls: Floats, surface_s: float) -> Floats:
    """(agent, 6) x, y, z, roll, pitch, yaw of hulls (agent, 3), rocked a little for the looks."""
    phase = 2.4 * np.arange(len(hulls))
    heave = 0.015 * np.sin(1.9 * surface_s + phase)
    roll = 0.022 * np.sin(1.3 * surface_s + 1.7 * phase)
    pitch = 0.014 * np.sin(1.6 * surface_s + 0.6 * phase)
    return np.column_stack((hulls[:, :2], heave, roll, pitch, hulls[:, 2]))


def floating(items: Floats, surface_s: float) -> Floats:
    """(item, 6) x, y, z, yaw, tilt, share left of items (item, 3), bobbing for the looks."""
    phase = 1.9 * np.arange(len(items))
    bob = 0.012 * np.sin(2.3 * surface_s + phase)
    yaw = phase + 0.08 * np.sin(0.4 * surface_s + phase)
    tilt = 0.10 * np.sin(1.7 * surface_s + 2.0 * phase)
    return np.column_stack((items[:, :2], bob, yaw, tilt, items[:, 2]))


def shrunk(image: Image, times: int) -> Image:
    """A copy of (h, w, 3), so many times smaller each way by the mean of the pixels."""
    height, width = image.shape[0] // times, image.shape[1] // times
    if times == 1:
        return image.copy()
    blocks = image.reshape(height, times, width, times, 3)
    small: Image = np.rint(blocks.mean(axis=(1, 3), dtype=np.float32)).astype(np.uint8)
    return small


def _mirror_of_nothing() -> tuple[Image, NDArray[np.float32]]:
    """A picture of an empty world."""
    return np.zeros((1, 1, 3), np.uint8), np.full((1, 1), np.inf, np.float32)


def _buffers(size: tuple[int, int]) -> tuple[Image, NDArray[np.float32]]:
    return np.empty((*size, 3), np.uint8), np.empty(size, np.float32)
