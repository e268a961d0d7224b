"""A small chart of what is believed: belief map, idleness, vessels and their links."""

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_replay import Replay
from mjforage.view.render import palette
from mjforage.view.render.links import paint_links
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Floats, Image, paint_box, paint_discs, paint_rings
from mjforage.view.render.seen_by import age_of, last_heard
from mjforage.view.render.text import write
from mjforage.view.render.timeline import split_time

_LAND: Colour = (120.0, 122.0, 118.0)
_CLEAR: Colour = (150.0, 205.0, 222.0)
_HAZY: Colour = (72.0, 104.0, 128.0)
_BELIEF: Colour = (255.0, 214.0, 74.0)
_MOST_BELIEF = 4.0  # items at which a mark grows no more


class Inset:
    """Charts at most `room` (width, height) pixels large; `paint` puts one into a picture."""

    def __init__(self, replay: Replay, colours: list[Colour], room: tuple[float, float]) -> None:
        self._replay, self._colours = replay, colours
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
        self._drawn: tuple[int, Image] | None = None

    def _nodes(self, pixels: int, first: int, end: int) -> NDArray[np.int64]:
        place = first + ((np.arange(pixels) + 0.5) / self._scale).astype(np.int64)
        nodes: NDArray[np.int64] = np.minimum(place, end - 1)
        return nodes

    def paint(self, image: Image, left: int, top: int, time: float, hulls_rc: Floats) -> None:
        """Paint the chart of `time` [step] with hulls (agent, 2) at row and column [node]."""
        step, _, _ = split_time(time, len(self._replay.belief) - 1)
        area = image[top : top + self.height, left : left + self.width]
        area[:] = self._chart(step)
        unit, now = max(1.0, self.height / 240.0), int(time + 1e-9)
        hulls, heard = self._pixels(hulls_rc), last_heard(self._replay, now)
        paint_links(area, self._replay, now, hulls, 0.8 * unit, palette.WHITE)
        for agent in np.argsort(self._replay.agent_collects, kind="stable")[::-1]:
            at, alpha = hulls[agent][None], np.ones(1)
            colour = self._colours[int(self._replay.agent_team[agent])]
            if heard[agent] < now:
                paint_rings(area, at, 3.3 * unit * alpha, 1.2 * unit * alpha, alpha, colour)
                at, alpha = self._ghost(area, agent, int(heard[agent]), time, unit), 0.55 * alpha
            paint_discs(area, at, np.array([4.6 * unit]), alpha, palette.WHITE)
            paint_discs(area, at, np.array([3.3 * unit]), alpha, colour)

    def _ghost(
        self, area: Image, agent: int, heard: int, time: float, unit: float
    ) -> NDArray[np.float64]:
        """Place (1, 2) where a vessel was last heard of, with how long ago written below it."""
        at = self._pixels(self._replay.agent_rc[heard, agent][None].astype(np.float64))
        size, (x, y) = max(9, round(9.0 * unit)), at[0]
        ago = age_of(self._replay, time, heard)
        base, white = y + 4.0 * unit + size, palette.WHITE
        write(area, ago, x, base, size, bold=True, colour=white, align="middle")
        return at

    def _chart(self, step: int) -> Image:
        """Land, water by idleness and belief marks of one step, kept until the next."""
        if self._drawn is None or self._drawn[0] != step:
            idle = self._replay.idleness[step][self._rows][:, self._columns].astype(np.float64)
            clear, hazy = np.array(_CLEAR), np.array(_HAZY)
            water = clear + (hazy - clear) * idle[..., None]
            chart = np.where(self._water[..., None], water, np.array(_LAND)).astype(np.uint8)
            row, column = np.nonzero(self._replay.belief[step] > 0)
            count = np.minimum(self._replay.belief[step][row, column], _MOST_BELIEF)
            at = self._pixels(np.column_stack((row, column)).astype(np.float64))
            radius = np.maximum(1.6, self._scale * (0.42 + 0.10 * count))
            paint_discs(chart, at, radius + 0.8, np.full(len(at), 0.85), palette.ITEM_RIM)
            paint_discs(chart, at, radius, np.ones(len(at)), _BELIEF)
            line = (0.5, 0.5, self.width - 0.5, self.height - 0.5)
            paint_box(chart, line, 0.0, 1.0, 0.5, palette.WHITE)
            self._drawn = step, chart
        return self._drawn[1]

    def _pixels(self, rc: Floats) -> Floats:
        """(n, 2) x and y in the chart of rows and columns (n, 2)."""
        shifted = (rc[:, ::-1] + 0.5 - (self._left, self._top)) * self._scale
        return np.ascontiguousarray(shifted)
