"""A small chart, north up: what is believed, idleness, vessels with headings, their links."""

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette, symbols
from mjforage.view.render.links import paint_links
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Floats, Image, paint_box, paint_rings
from mjforage.view.render.seen_by import age_of, last_heard
from mjforage.view.render.text import write
from mjforage.view.render.timeline import courses, split_time

_HULL = 13.0  # length of a vessel's mark [unit]
_FULL_HEIGHT = 240.0  # of a chart in which a unit is a pixel


class Inset:
    """Charts at most `room` (width, height) pixels large; `paint` puts one into a picture.

    `colours` are those of the agents; `followed` is the agent that is marked, or None; `most`
    the count of believed items drawn darkest, by default that of the episode.
    """

    def __init__(
        self,
        replay: Recording,
        colours: list[Colour],
        room: tuple[float, float],
        followed: int | None = None,
        most: int | None = None,
    ) -> None:
        self.replay, self._colours, self._followed = replay, colours, followed
        row, column = np.nonzero(replay.navigable)
        rows, columns = replay.navigable.shape
        self._top, self._left = max(row.min() - 1, 0), max(column.min() - 1, 0)
        bottom, right = min(row.max() + 2, rows), min(column.max() + 2, columns)
        self._scale = min(room[0] / (right - self._left), room[1] / (bottom - self._top))
        self.width = max(1, int((right - self._left) * self._scale))
        self.height = max(1, int((bottom - self._top) * self._scale))
        self._rows = self._nodes(self.height, self._top, bottom)
        self._columns = self._nodes(self.width, self._left, right)
        self._water = replay.navigable[self._rows][:, self._columns]
        self._course = courses(replay.agent_rc)
        self._most = most or palette.most_believed(replay.belief)
        self._drawn: tuple[int, Image] | None = None

    def _nodes(self, pixels: int, first: int, end: int) -> NDArray[np.int64]:
        place = first + ((np.arange(pixels) + 0.5) / self._scale).astype(np.int64)
        nodes: NDArray[np.int64] = np.minimum(place, end - 1)
        return nodes

    def paint(self, image: Image, left: int, top: int, time: float, hulls: Floats) -> None:
        """Paint the chart of `time` [step].

        Parameters
        ----------
        hulls : (agent, 3) row and column [node], course [rad], from east, clockwise on the screen
        """
        step, _, _ = split_time(time, len(self.replay.belief) - 1)
        area = image[top : top + self.height, left : left + self.width]
        area[:] = self._chart(step)
        unit, now = max(0.8, self.height / _FULL_HEIGHT), int(time + 1e-9)
        places, heard = self._pixels(hulls[:, :2]), last_heard(self.replay, now)
        paint_links(area, self.replay, now, places, 0.8 * unit)
        for agent in np.argsort(self.replay.agent_collects, kind="stable")[::-1]:
            look = bool(self.replay.agent_collects[agent]), self._colours[agent]
            place, course, length = places[agent], float(hulls[agent, 2]), _HULL * unit
            if agent == self._followed:
                self._mark(area, place, length, look[1])
            if heard[agent] < now:
                symbols.paint_outline(area, place, course, length, *look)
                self._paint_ghost(area, agent, int(heard[agent]), time, unit)
            else:
                symbols.paint_hull(area, place, course, length, *look)

    def _mark(self, area: Image, place: Floats, length: float, colour: Colour) -> None:
        """A ring around the vessel that the camera follows."""
        one = np.ones(1)
        for wide, paint in ((0.26, palette.WHITE), (0.13, colour)):
            paint_rings(area, place[None], 0.95 * length * one, wide * length * one, one, paint)

    def _paint_ghost(self, area: Image, agent: int, heard: int, time: float, unit: float) -> None:
        """A vessel faded where it was last heard of, with how long ago written below it."""
        at = self._pixels(self.replay.agent_rc[heard, agent][None].astype(np.float64))[0]
        look = bool(self.replay.agent_collects[agent]), self._colours[agent]
        symbols.paint_ghost(area, at, float(self._course[heard, agent]), _HULL * unit, *look)
        size, ago = max(9, round(9.0 * unit)), age_of(self.replay, time, heard)
        write(area, ago, at[0], at[1] + 8.0 * unit + size, size, bold=True, align="middle")

    def _chart(self, step: int) -> Image:
        """Land, water by idleness and believed items of one step, kept until the next."""
        if self._drawn is None or self._drawn[0] != step:
            idle = self.replay.idleness[step][self._rows][:, self._columns].astype(np.float64)
            clear, hazy = np.array(palette.CLEAR_DEEP), np.array(palette.HAZY_DEEP)
            water = clear + (hazy - clear) * idle[..., None]
            chart = np.where(self._water[..., None], water, np.array(palette.QUAY))
            count = self.replay.belief[step][self._rows][:, self._columns]
            believed = count > 0
            chart[believed] = palette.belief_shades(count[believed], self._most)
            chart = chart.astype(np.uint8)
            line = (0.5, 0.5, self.width - 0.5, self.height - 0.5)
            paint_box(chart, line, 0.0, 1.0, 0.5, palette.WHITE)
            self._drawn = step, chart
        return self._drawn[1]

    def _pixels(self, rc: Floats) -> Floats:
        """(n, 2) x and y in the chart of rows and columns (n, 2)."""
        shifted = (rc[:, ::-1] + 0.5 - (self._left, self._top)) * self._scale
        return np.ascontiguousarray(shifted)
