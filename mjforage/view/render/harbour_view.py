"""A recording seen in three dimensions through MuJoCo, at any time of the episode."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render.cameras import CAMERAS, Area, Circumstances, View, magnified
from mjforage.view.render.layout import is_brief, unit_of
from mjforage.view.render.opengl import Canvas
from mjforage.view.render.palette import agent_colours
from mjforage.view.render.panel import PanelState
from mjforage.view.render.sheet import Sheet
from mjforage.view.render.smoothing import smooth_edges
from mjforage.view.render.surface import Drawn
from mjforage.view.render.tags import Tags
from mjforage.view.render.timeline import Timeline
from mjforage.view.render.track import Track
from mjforage.view.render.visual_scene import VisualScene, distance_ahead, mirrored
from mjforage.view.render.wakes import TRAIL_STEPS, lay_rings, lay_vessel
from mjforage.view.render.water import Water, shore_of

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]
_CALM_FILM = 2.0  # faster films slow their waves down to so many times their pace
_MARGIN_M = 3.0  # beyond the water where vessels of life size leave no marks
_FINEST_M = 0.09  # texel of the sheet near a vessel
_MIRROR_SHARE = 2  # the mirrored picture is so many times smaller
_NOTHING = Drawn(np.zeros((1, 1, 3), np.uint8), np.full((1, 1), np.inf, np.float32))


class HarbourView:
    """Draws pictures (height, width, 3) uint8 of one recording through MuJoCo; close it after use.

    Waves, rocking vessels and bobbing items are drawn so that films look like water; the simulation
    is planar and has none of them. Raises `UserError` if there is no such vessel, or no OpenGL.

    Parameters
    ----------
    recording : the episode, of any world
    camera : name in `CAMERAS`
    width, height : of a picture [pixel]
    follow : name of a vessel, such as ``scouts_0``, for the cameras that follow one; by default the
        first that collects for chase, the first that does not for scout
    speed : simulated seconds per second of film; smooths the camera and calms the waves
    detail : pictures are drawn so many times larger each way and shrunk
    shares : a view of the same bodies, no smaller, whose canvas this one draws on, as a process has
        but one; it is to be closed after this one

    Attributes
    ----------
    followed : agent that the camera follows, or None
    """

    def __init__(
        self,
        recording: Recording,
        camera: str,
        width: int,
        height: int,
        *,
        follow: str | None = None,
        speed: float = 1.0,
        detail: int = 1,
        shares: "HarbourView | None" = None,
    ) -> None:
        self._camera = CAMERAS[camera]
        self._recording, self._track = recording, Track.of(recording)
        self._timeline, area = Timeline.of(recording), water_area(recording)
        self._scales = magnified(self._camera, area)
        agent = followed_agent(recording, camera, follow)
        self.followed = agent if self._camera.follows else None
        self._scene: VisualScene = (
            shares._scene if shares else VisualScene(recording, *self._scales)
        )
        mast, aspect = self._scene.masts[agent], width / height
        self._circumstances = Circumstances(self._track, area, aspect, speed, agent, mast)
        self._surface_rate = min(1.0, _CALM_FILM / speed)
        about = recording.navigable, recording.pitch_m, recording.quays
        self._water = Water(shore_of(*about))
        self._colours = agent_colours(recording.agent_collects.tolist())
        self._tags: Tags | None = None
        if not self._camera.follows and not is_brief(width, height):
            self._tags = Tags(recording.labels, self._colours, width, unit_of(width, height))
        self._size, self._detail = (height, width), detail
        tall, wide = detail * height, detail * width
        self._drawn = _buffers(tall, wide)
        self._mirror = _buffers(tall // _MIRROR_SHARE, wide // _MIRROR_SHARE)
        self._owns = shares is None
        self._canvas: Canvas = shares._canvas if shares else Canvas(self._scene.model, wide, tall)

    def close(self) -> None:
        """Give OpenGL back."""
        if self._owns:
            self._canvas.close()

    def __enter__(self) -> "HarbourView":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def picture(self, time: float) -> Image:
        """Draw the state at `time` [step], 0 to the length of the episode.

        Raises `ValueError` if `time` lies outside the episode.
        """
        if not 0.0 <= time <= self._timeline.length:
            raise ValueError(f"time {time} lies outside the episode")
        time_s = time * self._recording.period_s
        vessels, items = self._track.vessels_at(time_s), self._track.items_at(time_s)
        known, surface_s = self._timeline.known <= time, self._surface_rate * time_s
        self._scene.place(afloat(vessels, surface_s), floating(items, surface_s), known)
        view = self._camera.view(self._circumstances, time_s)
        picture = self._through(view, self._sheet(time_s, vessels, items, known), surface_s)
        self._write_names(picture, view, vessels)
        return picture

    def state(self, time: float) -> PanelState:
        """State of the panel at `time` [step]."""
        time_s = time * self._recording.period_s
        north_rad = self._camera.view(self._circumstances, time_s).north_rad
        return PanelState(self._notes(time_s), north_rad, self._track.wind_at(time_s))

    def _through(self, view: View, sheet: Sheet, surface_s: float) -> Image:
        """MuJoCo's two pictures with the water between them."""
        mirror = _NOTHING
        if self._camera.follows:  # from afar one looks into the water, not along it
            mirror = self._draw(mirrored(view), self._mirror)
        drawn = self._draw(view, self._drawn)
        self._water.paint(drawn, mirror, sheet, view, surface_s)
        smooth_edges(drawn.image, self._drawn.image)
        return shrunk(self._drawn.image, self._detail)

    def _draw(self, view: View, buffers: Drawn) -> Drawn:
        """MuJoCo's picture and distances from a view, row 0 on top."""
        near = self._camera.near_m
        scene = self._scene.seen(view, self._size[1] / self._size[0], near)
        self._canvas.draw(scene, *buffers)
        ahead = distance_ahead(buffers.ahead, near)[::-1]
        return Drawn(np.ascontiguousarray(buffers.image[::-1]), np.ascontiguousarray(ahead))

    def _sheet(
        self, time_s: float, vessels: Floats, items: Floats, known: NDArray[np.bool_]
    ) -> Sheet:
        """Everything that lies on the water now."""
        scale, item_scale = self._scales
        camera, lasting = self._camera, TRAIL_STEPS * self._recording.period_s
        if camera.ground_m is None:
            area = self._circumstances.area.grown(_MARGIN_M * scale)
        else:
            x, y = vessels[self._circumstances.followed, :2].tolist()
            area = Area(x, y, x, y).grown(0.5 * camera.ground_m)
        pixel_m = max(area.east - area.west, area.north - area.south) / max(self._size)
        sheet = Sheet.blank(area, max(_FINEST_M, 0.8 * pixel_m / self._detail))
        for agent, vessel in enumerate(self._scene.vessels):
            colour = None if camera.follows else self._colours[agent]
            lay_vessel(sheet, self._track, agent, vessel, time_s, scale, colour, lasting)
        lay_rings(sheet, items, known, time_s - self._track.removed_s, item_scale, camera.follows)
        return sheet

    def _write_names(self, image: Image, view: View, vessels: Floats) -> None:
        if self._tags is None:
            return
        height, width = self._size
        middles = np.column_stack((vessels[:, :2], np.zeros(len(vessels))))
        half_m = 0.5 * self._scales[0] * np.array([one.length_m for one in self._scene.vessels])
        x, y, ahead = view.project(middles, width / height).T
        aside = view.project(middles + half_m[:, None] * view.right, width / height)[:, 0]
        inside = (ahead > 0.0) & (np.abs(x) < 1.0) & (np.abs(y) < 1.0)
        places = np.column_stack((0.5 * width * (1.0 + x), 0.5 * height * (1.0 - y)))
        radius = 0.5 * width * np.abs(aside - x)
        self._tags.paint(image, np.where(inside[:, None], places, np.nan), radius)

    def _notes(self, time_s: float) -> str:
        """Facts that the picture does not show."""
        if self.followed is None:
            return "vessels {:.2g} x, debris {:.2g} x".format(*self._scales)
        way = self._track.way(self.followed, time_s + np.array([-0.5, 0.5]))
        speed = float(np.linalg.norm(way[1, :2] - way[0, :2]))
        return f"{self._recording.labels[self.followed]} · {speed:.1f} m/s"


def followed_agent(recording: Recording, camera: str, follow: str | None) -> int:
    """Number of the vessel that a camera belongs to.

    Raises `UserError` if there is no such vessel, or the camera follows none.
    """
    if follow is None:
        wanted = recording.agent_collects if camera == "chase" else ~recording.agent_collects
        return int(np.argmax(wanted))
    if not CAMERAS[camera].follows:
        followers = " and ".join(name for name, kind in CAMERAS.items() if kind.follows)
        raise UserError(f"follow {follow}: camera {camera} follows nobody; {followers} do")
    labels = recording.labels
    if follow not in labels:
        raise UserError(f"follow {follow}: no such vessel; choose {', '.join(labels)}")
    return labels.index(follow)


def water_area(recording: Recording) -> Area:
    """The rectangle of the map that holds its water."""
    row, column = np.nonzero(recording.navigable)
    last, pitch = recording.navigable.shape[0] - 1, recording.pitch_m
    return Area(
        (column.min() - 0.5) * pitch,
        (last - row.max() - 0.5) * pitch,
        (column.max() + 0.5) * pitch,
        (last - row.min() + 0.5) * pitch,
    )


def afloat(hulls: Floats, surface_s: float) -> Floats:
    """(agent, 6) x, y, z, roll, pitch, yaw of vessels (agent, 3), rocked a little for effect."""
    phase = 2.4 * np.arange(len(hulls))
    heave = 0.015 * np.sin(1.9 * surface_s + phase)
    roll = 0.022 * np.sin(1.3 * surface_s + 1.7 * phase)
    pitch = 0.014 * np.sin(1.6 * surface_s + 0.6 * phase)
    return np.column_stack((hulls[:, :2], heave, roll, pitch, hulls[:, 2]))


def floating(items: Floats, surface_s: float) -> Floats:
    """(item, 6) x, y, z, yaw, tilt, share left of items (item, 3), bobbing for effect."""
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


def _buffers(height: int, width: int) -> Drawn:
    return Drawn(np.empty((height, width, 3), np.uint8), np.empty((height, width), np.float32))
