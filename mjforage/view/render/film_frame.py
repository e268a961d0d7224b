"""Frames of a film: the pictures of one or two episodes, and a panel that explains them."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.chart import Chart, shown_part
from mjforage.view.render.layout import Box, Layout
from mjforage.view.render.panel import (
    CHART_TITLE,
    DARK,
    PanelState,
    mission_clock,
    paint_chart,
    paint_clock,
    paint_compass,
    paint_head,
    paint_notes,
    paint_shares,
    paint_signs,
    short_name,
    text_size,
)
from mjforage.view.render.raster import Image
from mjforage.view.render.seen_by import EVERYBODY, shown_name
from mjforage.view.render.text import fit, width, write
from mjforage.view.render.timeline import Timeline


class EpisodeView(Protocol):
    """View of one episode without a panel."""

    @property
    def followed(self) -> int | None:
        """Agent that the chart marks."""

    def picture(self, time: float) -> Image:
        """(height, width, 3) at a time [step], at most as large as its room."""

    def state(self, time: float) -> PanelState:
        """State of the panel at that time."""


class MapView(Chart):
    """The plain drawing from above as the picture of a film."""

    @property
    def followed(self) -> int | None:
        """None: the map follows no vessel."""
        return None

    def state(self, time: float) -> PanelState:
        """North is up."""
        return PanelState()


class FilmFrame:
    """Draws frames (height, width, 3) uint8; `frame(73.5)` is between two steps.

    Parameters
    ----------
    recordings : one, or two of the same episode side by side
    pictures : drawing of each
    size : width and height of a frame [pixel]
    layout : places of all parts
    drawn : True if the pictures are charts, so that the panel needs none
    """

    def __init__(
        self,
        recordings: Sequence[Recording],
        pictures: Sequence[EpisodeView],
        size: tuple[int, int],
        layout: Layout,
        drawn: bool,
    ) -> None:
        self._recordings, self._pictures, self._layout = recordings, pictures, layout
        self._drawn, self._most = drawn, palette.most_believed(*(one.belief for one in recordings))
        self._timelines = [Timeline.of(one) for one in recordings]
        self._longest = max(recordings, key=lambda one: len(one.agent_rc))
        self._blank = np.full((size[1], size[0], 3), np.array(DARK, np.uint8))
        self._charts = [
            None if score.chart is None else self._chart(score.chart, recording, picture)
            for score, recording, picture in zip(layout.scores, recordings, pictures, strict=False)
        ]

    def _chart(self, box: Box, recording: Recording, picture: EpisodeView) -> Chart:
        room = box.width, box.height - CHART_TITLE * self._layout.unit
        return Chart(recording, room, most=self._most, followed=picture.followed, detailed=False)

    def frame(self, time: float) -> Image:
        """Draw `time` [step]; an episode that is over stays at its end."""
        image, layout, u = self._blank.copy(), self._layout, self._layout.unit
        shown = zip(self._recordings, self._pictures, strict=True)
        for number, (recording, picture) in enumerate(shown):
            timeline = self._timelines[number]
            now = min(time, float(timeline.length))
            _put(image, layout.pictures[number], picture.picture(now))
            if not layout.scores:
                self._paint_line(image, number, now)
                continue
            about = self._about(recording, timeline, time)
            paint_head(image, layout.heads[number], u, recording.policy, about)
            score, chart = layout.scores[number], self._charts[number]
            paint_shares(image, score.shares, u, timeline, now)
            paint_notes(image, score.notes, u, picture.state(now))
            if chart is not None and score.chart is not None:
                paint_chart(image, score.chart, u, chart, recording, now)
        if layout.clock is not None:
            paint_clock(image, layout.clock, u, self._longest, time)
        if layout.signs is not None:
            paint_signs(image, layout.signs, u, self._longest, self._most, self._drawn)
        return image

    def _about(self, recording: Recording, timeline: Timeline, time: float) -> str:
        """World and episode, or that it is over."""
        if len(self._recordings) > 1 and time >= timeline.length:
            return f"ended at {mission_clock(timeline.length * recording.period_s)}"
        by = shown_name(recording)
        seen = self._drawn and by != EVERYBODY  # else a chart says so
        return f"seen by {by}" if seen else f"{recording.world} world · episode {recording.episode}"

    def _paint_line(self, image: Image, number: int, now: float) -> None:
        """Policy, clock, shares and a compass, as much of it as there is room for."""
        box, timeline = self._layout.heads[number], self._timelines[number]
        recording, step, size = self._recordings[number], int(now + 1e-9), text_size(1.0, 10)
        clock = mission_clock(now * recording.period_s)
        radius = 0.5 * box.height - 2.0
        at = np.array([box.right - 6.0 - radius, box.top + 0.5 * box.height])
        paint_compass(image, at, radius, self._pictures[number].state(now).north_rad)
        shares = f"PTA_D {timeline.pta_d[step]:.0f} %", f"PTA_C {timeline.pta_c[step]:.0f} %"
        room = box.width - 3.0 * radius - 12.0
        name = short_name(recording.policy)
        parts = [(name, clock, *shares), (name, clock, shares[1]), (clock, shares[1])]
        lines = ["   ".join(part) for part in parts]
        words = next((one for one in lines if width(one, size, bold=True) <= room), clock)
        words, base = fit(words, size, room, bold=True), box.bottom - 7.0
        write(image, words, box.left + 6.0, base, size, bold=True, colour=palette.WHITE)


def _put(image: Image, box: Box, picture: Image) -> None:
    """Put a picture into the middle of its box."""
    height, wide = picture.shape[:2]
    left = round(box.left + 0.5 * (box.width - wide) - 0.25)
    top = round(box.top + 0.5 * (box.height - height) - 0.25)
    image[top : top + height, left : left + wide] = picture


def shape_of(recording: Recording) -> float:
    """Width by height of a chart's content."""
    rows, columns = shown_part(recording)
    return float((columns.stop - columns.start) / (rows.stop - rows.start))


def check_beside(first: Recording, second: Recording) -> None:
    """Check that two episodes can share a clock.

    Raises `UserError` if they are of the same policy, or of other items.
    """
    if first.policy == second.policy:
        raise UserError(f"beside {second.policy}: is the film's own policy; name another one")
    alike = ("world", "episode", "seed", "period_s", "pitch_m", "vessels", "team_names")
    arrays = ("navigable", "agent_team", "agent_collects", "item_class")
    same = all(getattr(first, name) == getattr(second, name) for name in alike)
    equal = (np.array_equal(getattr(first, name), getattr(second, name)) for name in arrays)
    if not same or not all(equal):
        raise UserError(f"beside {second.policy}: is not the same episode; play both from one run")
