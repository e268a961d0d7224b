"""A recording seen from above, north up, as a drawing of any size at any time."""

from functools import lru_cache

import numpy as np

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette, symbols
from mjforage.view.render.ground import Field, Ground, fields_at, paint_ground, resized
from mjforage.view.render.links import paint_links, write_lost
from mjforage.view.render.raster import Floats, Image, paint_rings
from mjforage.view.render.seen_by import age_of, last_received
from mjforage.view.render.text import write
from mjforage.view.render.timeline import Timeline
from mjforage.view.render.track import FADE_PART, Track

TRAIL_STEPS = 14.0  # how far back trails reach [step]
FLASH_STEPS = 0.9  # how long a collection stays marked [step]
_FULL_SIZE = 720.0  # of a chart in which a unit is a pixel


class Chart:
    """Draws a recording in pictures (height, width, 3) uint8; see `picture`.

    Parameters
    ----------
    recording : the episode
    room : width and height [pixel] that a picture may have
    most : count of believed items that is drawn darkest, by default the largest of the episode
    followed : agent that is marked, or None
    detailed : True if items, trails and numbers of lost scans are drawn
    """

    def __init__(
        self,
        recording: Recording,
        room: tuple[float, float],
        *,
        most: int | None = None,
        followed: int | None = None,
        detailed: bool = True,
    ) -> None:
        self._recording, self._followed, self._detailed = recording, followed, detailed
        self._timeline, self._track = Timeline.of(recording), Track.of(recording)
        self._rows, self._columns = shown_part(recording)
        navigable = recording.navigable[self._rows, self._columns]
        rows, columns = navigable.shape
        self._scale = min(room[0] / columns, room[1] / rows)  # [pixel/node]
        self.width, self.height = (max(1, int(n * self._scale)) for n in (columns, rows))
        self._unit = max(0.8, max(self.width, self.height) / _FULL_SIZE)
        self._length = float(np.clip(1.5 * self._scale, 17.0 * self._unit, 52.0 * self._unit))
        self._radius = float(np.clip(0.19 * self._scale, 2.1 * self._unit, 7.0 * self._unit))
        self._ground = _ground(navigable.tobytes(), navigable.shape, self.width, self.height)
        self._colours = palette.agent_colours(recording.agent_collects.tolist())
        self._most = most or palette.most_believed(recording.belief)
        self._fields = lru_cache(maxsize=2)(self._fields_at)

    def picture(self, time: float) -> Image:
        """The state at `time` [step], 0 to the length of the episode.

        Raises `ValueError` if `time` lies outside the episode.
        """
        length = self._timeline.length
        if not 0.0 <= time <= length:
            raise ValueError(f"time {time} lies outside the episode, 0 to {length} steps")
        before = int(time)
        after, part = min(before + 1, length), time - before
        first, second = self._fields(before), self._fields(after)
        mixed = first + (second - first) * np.float32(part)
        image = np.empty((self.height, self.width, 3), np.uint8)
        paint_ground(image, self._ground, mixed, self._scale, 0.8 * self._unit)
        vessels = self._vessels(time)
        if self._detailed:
            self._paint_trails(image, time)
        self._paint_beliefs(image, before, after, part)
        if self._detailed:
            self._paint_items(image, time)
        step, places = _step(time), np.ascontiguousarray(vessels[:, :2])
        paint_links(image, self._recording, step, places, self._unit)
        if self._detailed:
            write_lost(image, self._recording, step, places, self._unit)
        self._paint_vessels(image, time, vessels)
        return image

    def place(self, xy: Floats) -> Floats:
        """(n, 2) pixels x and y in a picture of places (n, 2) x and y [m]."""
        nodes = np.asarray(xy) / self._recording.pitch_m + 0.5
        north = len(self._recording.navigable) - self._rows.start
        columns, rows = nodes[:, 0] - self._columns.start, north - nodes[:, 1]
        return np.ascontiguousarray(np.column_stack((columns, rows)) * self._scale)

    def _vessels(self, time: float) -> Floats:
        """(agent, 3) x, y [pixel] and course, clockwise on the screen."""
        poses = self._track.vessels_at(time * self._recording.period_s)
        return np.column_stack((self.place(poses[:, :2]), -poses[:, 2]))

    def _fields_at(self, step: int) -> Field:
        fields = fields_at(self._recording, step)[:, self._rows, self._columns]
        return np.stack([resized(field, self.width, self.height) for field in fields])

    def _paint_trails(self, image: Image, time: float) -> None:
        first = max(0.0, time - TRAIL_STEPS)
        inner = np.arange(np.floor(first) + 1.0, np.ceil(time))
        times = np.concatenate([[first], inner, [time]]) * self._recording.period_s
        for agent in np.flatnonzero(last_received(self._recording, _step(time)) == _step(time)):
            way = self.place(self._track.way(int(agent), times)[:, :2])
            symbols.paint_trail(image, way, self._length, self._colours[agent])

    def _paint_beliefs(self, image: Image, before: int, after: int, part: float) -> None:
        """Nodes fill and empty at the end of a step, when the fleet has scanned."""
        late = max(0.0, (part - 1.0 + FADE_PART) / FADE_PART)
        old, new = self._recording.belief[before], self._recording.belief[after]
        row, column = np.nonzero((old > 0) | (new > 0))
        was, will = old[row, column], new[row, column]
        alpha = (1.0 - late) * (was > 0) + late * (will > 0)
        count = np.where(was > 0, was, will) if late < 0.5 else np.where(will > 0, will, was)
        corner = (self._columns.start, self._rows.start)
        points = (np.column_stack((column, row)) - corner + 0.5) * self._scale
        symbols.paint_believed(image, points, count, alpha, self._scale, self._most)

    def _paint_items(self, image: Image, time: float) -> None:
        removed, known = self._timeline.removed, self._timeline.known <= time
        points = self.place(self._track.items_at(time * self._recording.period_s)[:, :2])
        left = np.clip((removed - time) / FADE_PART, 0.0, 1.0)
        for group, is_known in ((~known, False), (known, True)):
            shown = group & (left > 0.0)
            symbols.paint_items(image, points[shown], left[shown], self._radius, known=is_known)
        age = (time - removed.astype(np.float64)) / FLASH_STEPS
        flash = (age >= 0.0) & (age < 1.0)
        symbols.paint_collected(image, points[flash], age[flash], self._radius, self._length)

    def _paint_vessels(self, image: Image, time: float, vessels: Floats) -> None:
        """Vessels in contact as they are; others in outline, and faded at their last position."""
        recording, step, length = self._recording, _step(time), self._length
        received = last_received(recording, step)
        for agent in np.lexsort((~recording.agent_collects, received == step)):
            symbol = bool(recording.agent_collects[agent]), self._colours[agent]
            place, course = vessels[agent, :2], float(vessels[agent, 2])
            if agent == self._followed:
                self._paint_mark(image, place, symbol[1])
            if received[agent] == step:
                symbols.paint_hull(image, place, course, length, *symbol)
                continue
            symbols.paint_outline(image, place, course, length, *symbol)
            x, y, course = self._vessels(float(received[agent]))[agent]
            symbols.paint_stale(image, np.array((x, y)), course, length, *symbol)
            size = max(9, round(12 * self._unit))
            ago = age_of(recording, time, int(received[agent]))
            write(image, f"{ago} ago", x, y + 0.55 * length + size, size, bold=True, align="middle")

    def _paint_mark(self, image: Image, place: Floats, colour: palette.Colour) -> None:
        """A ring around the vessel that the camera follows."""
        one = np.full(1, self._length)
        for wide, paint in ((0.26, palette.WHITE), (0.13, colour)):
            paint_rings(image, place[None], 0.95 * one, wide * one, np.ones(1), paint)


def shown_part(recording: Recording) -> tuple[slice, slice]:
    """Rows and columns of the map that hold its water, with one node around."""
    row, column = np.nonzero(recording.navigable)
    first = max(row.min() - 1, 0), max(column.min() - 1, 0)
    return slice(first[0], row.max() + 2), slice(first[1], column.max() + 2)


@lru_cache(maxsize=4)
def _ground(cells: bytes, shape: tuple[int, ...], width: int, height: int) -> Ground:
    """The ground of a map; nothing of it changes with time, so one serves all pictures."""
    return Ground.of(np.frombuffer(cells, np.bool_).reshape(shape), width, height)


def _step(time: float) -> int:
    """The last step that is over."""
    return int(time + 1e-9)
