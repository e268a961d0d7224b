"""A replay seen from above: one frame at any time of the episode."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette, symbols
from mjforage.view.render.background import paint_background
from mjforage.view.render.frame_layout import bare_layout, plan_layout
from mjforage.view.render.legend import Legend
from mjforage.view.render.links import paint_links, write_lost
from mjforage.view.render.node_fields import fields_at, nearest_water, paint_fields
from mjforage.view.render.panel import Panel, team_collects
from mjforage.view.render.raster import Floats, Image, paint_box
from mjforage.view.render.seen_by import age_of, last_heard
from mjforage.view.render.side_panel import DARK
from mjforage.view.render.text import write
from mjforage.view.render.timeline import between, course_at, split_time, timeline_of

TRAIL_STEPS = 14.0  # how far back trails reach [step]
FADE_PART = 0.3  # the last part of a step, in which things appear and vanish
FLASH_STEPS = 0.9  # how long a collection stays marked [step]


class TopView:
    """Draws frames (height, width, 3) uint8 of one replay; `frame(73.5)` is between two steps.

    Parameters
    ----------
    replay : Recording
        The episode.
    long_side : int, optional
        Most pixels along the wider side; by default 1280, 1600 for maps of over 200 nodes a side.
    room : (int, int), optional
        Width and height of frames that show the map alone, without a panel.
    """

    def __init__(
        self,
        replay: Recording,
        long_side: int | None = None,
        *,
        room: tuple[int, int] | None = None,
        most: int | None = None,
    ) -> None:
        self._replay = replay
        self._timeline = timeline_of(replay)
        rows, columns = replay.navigable.shape
        teams, linked = len(replay.team_names), replay.held is not None
        if room is None:
            self._layout = plan_layout(rows, columns, teams, long_side, linked=linked)
        else:
            self._layout = bare_layout(rows, columns, *room)
        self._background = paint_background(replay.navigable, self._layout)
        self._collects = team_collects(replay)
        self._colours = palette.agent_colours(replay.agent_collects.tolist())
        self._most = most or palette.most_believed(replay.belief)
        self._panel = Panel(replay, self._timeline, self._layout) if room is None else None
        self._page = self._paint_page()
        nearest = nearest_water(replay.navigable)
        self._fields = lru_cache(maxsize=2)(lambda step: fields_at(replay, step, nearest))

    @property
    def length(self) -> int:
        """Last step of the episode."""
        return self._timeline.length

    @property
    def size(self) -> tuple[int, int]:
        """Height and width of a frame [pixel], both even."""
        return self._layout.height, self._layout.width

    def on_chart(self, time: float) -> Floats:
        """(agent, 3) row, column [node] and course, clockwise on the map, at `time` [step]."""
        places = between(self._replay.agent_rc, time)
        return np.column_stack((places, course_at(self._timeline, time)))

    def place(self, rc: NDArray[np.floating]) -> tuple[float, float]:
        """Pixel (x, y) in a frame of the map position (row, column) [node]."""
        x, y = self._pixels(np.asarray(rc, np.float64)[None])[0]
        return float(x) + self._layout.map_left, float(y) + self._layout.map_top

    def frame(self, time: float) -> Image:
        """Draw the state at `time` [step], 0 to `length`.

        Raises
        ------
        ValueError
            If `time` lies outside the episode.
        """
        before, after, part = split_time(time, self._timeline.length)
        image = self._page.copy()
        sea = self._map_area(image)
        fields = self._fields(before).mixed(self._fields(after), part)
        roles = palette.SCOUT, palette.FORAGER
        paint_fields(sea, self._background, fields, self._layout, roles)
        self._paint_trails(sea, time)
        self._paint_beliefs(sea, before, after, part)
        self._paint_items(sea, time)
        self._paint_links(sea, time)
        self._paint_vessels(sea, time)
        self._paint_edge(image)
        if self._panel is not None:
            self._panel.paint_moving(image, time)
        return image

    def _paint_page(self) -> Image:
        """Everything outside the map that stays: paper, title, legend."""
        page = np.empty((self._layout.height, self._layout.width, 3), np.uint8)
        if self._panel is None:
            page[:] = np.array(DARK, np.uint8)
            return page
        page[:] = np.array(palette.PAGE, np.uint8)
        self._panel.paint_fixed(page)
        legend = Legend(page, self._panel.legend, self._layout)
        for team, name in enumerate(self._replay.team_names):
            members = np.flatnonzero(self._replay.agent_team == team)
            if members.size:
                colours = [self._colours[agent] for agent in members]
                legend.team(name, self._collects[team], colours)
        legend.items(self._most)
        if self._replay.held is not None:
            legend.links(self._collects[-1], self._colours[-1])
        legend.idleness()
        legend.scale_bar(self._replay.pitch_m)
        return page

    def _map_area(self, image: Image) -> Image:
        layout = self._layout
        return image[
            layout.map_top : layout.map_top + layout.map_height,
            layout.map_left : layout.map_left + layout.map_width,
        ]

    def _paint_edge(self, image: Image) -> None:
        """A fine frame around the map."""
        layout, line = self._layout, 1.5 * self._layout.unit
        left, top = layout.map_left, layout.map_top
        box = (left - line / 2, top - line / 2)
        corner = (left + layout.map_width + line / 2, top + layout.map_height + line / 2)
        paint_box(image, (*box, *corner), 0.0, line, 1.0, palette.QUAY_FOOT)

    def _pixels(self, rc: Floats) -> Floats:
        """Pixels (n, 2) in the map area as (x, y) from positions (n, 2) as (row, column)."""
        shift = self._layout.border + 0.5
        return np.ascontiguousarray((rc[:, ::-1] + shift) * self._layout.scale)

    def _paint_trails(self, sea: Image, time: float) -> None:
        first = max(0.0, time - TRAIL_STEPS)
        inner = np.arange(np.floor(first) + 1.0, np.ceil(time))
        times = np.concatenate([[first], inner, [time]])
        way = np.stack([between(self._replay.agent_rc, moment) for moment in times])
        length = symbols.hull_length(self._layout)
        for agent in np.flatnonzero(last_heard(self._replay, _step(time)) == _step(time)):
            colour = self._colours[agent]
            symbols.paint_trail(sea, self._pixels(way[:, agent]), length, colour)

    def _paint_beliefs(self, sea: Image, before: int, after: int, part: float) -> None:
        """Nodes fill and empty at the end of a step, when the fleet has looked."""
        late = max(0.0, (part - 1.0 + FADE_PART) / FADE_PART)
        old, new = self._replay.belief[before], self._replay.belief[after]
        row, column = np.nonzero((old > 0) | (new > 0))
        was, will = old[row, column], new[row, column]
        alpha = (1.0 - late) * (was > 0) + late * (will > 0)
        count = np.where(was > 0, was, will) if late < 0.5 else np.where(will > 0, will, was)
        points = self._pixels(np.column_stack([row, column]).astype(np.float64))
        symbols.paint_believed(sea, points, count, alpha, self._layout.scale, self._most)

    def _paint_items(self, sea: Image, time: float) -> None:
        timeline, radius = self._timeline, symbols.item_radius(self._layout)
        points = self._pixels(between(self._replay.item_rc, time))
        left = np.clip((timeline.removed - time) / FADE_PART, 0.0, 1.0)
        known = timeline.known <= time
        for group, is_known in ((~known, False), (known, True)):
            shown = group & (left > 0.0)
            symbols.paint_items(sea, points[shown], left[shown], radius, known=is_known)
        age: Floats = (time - timeline.removed.astype(np.float64)) / FLASH_STEPS
        flash = (age >= 0.0) & (age < 1.0)
        symbols.paint_collected(sea, points[flash], age[flash], self._layout)

    def _paint_links(self, sea: Image, time: float) -> None:
        points = self._pixels(between(self._replay.agent_rc, time))
        paint_links(sea, self._replay, _step(time), points, self._layout.unit)
        write_lost(sea, self._replay, _step(time), points, self._layout.unit)

    def _paint_vessels(self, sea: Image, time: float) -> None:
        """Those who are heard as they are; others in outline, and faded where last heard of."""
        replay, course = self._replay, course_at(self._timeline, time)
        points = self._pixels(between(replay.agent_rc, time))
        heard, length = last_heard(replay, _step(time)), symbols.hull_length(self._layout)
        away = heard < _step(time)
        order = np.argsort(replay.agent_collects, kind="stable")[::-1]
        for agent in order[np.argsort(~away[order], kind="stable")]:  # those away below the others
            look = bool(replay.agent_collects[agent]), self._colours[agent]
            place, heading = points[agent], float(course[agent])
            if away[agent]:
                symbols.paint_outline(sea, place, heading, length, *look)
                self._paint_ghost(sea, time, agent, int(heard[agent]), length, look)
            else:
                symbols.paint_hull(sea, place, heading, length, *look)

    def _paint_ghost(
        self,
        sea: Image,
        time: float,
        agent: int,
        heard: int,
        length: float,
        look: tuple[bool, palette.Colour],
    ) -> None:
        """A vessel where it was at step `heard`, and how long ago that is."""
        x, y = place = self._pixels(self._replay.agent_rc[heard, agent][None].astype(np.float64))[0]
        symbols.paint_ghost(sea, place, float(self._timeline.course[heard, agent]), length, *look)
        size = max(9, self._layout.size(12))
        ago = f"{age_of(self._replay, time, heard)} ago"
        write(sea, ago, x, y + 0.55 * length + size, size, bold=True, align="middle")


def _step(time: float) -> int:
    """The last step that is over."""
    return int(time + 1e-9)
