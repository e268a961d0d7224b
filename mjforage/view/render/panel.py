"""The panel beside the map: who, when, how far, and the legend."""

import numpy as np
from numpy.typing import NDArray

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.frame_layout import (
    COLUMN_GAP,
    PANEL_WIDTH,
    PROGRESS_HEIGHT,
    TITLE_HEIGHT,
    Layout,
    legend_height,
)
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Image, paint_box, paint_discs, paint_stroke
from mjforage.view.render.seen_by import EVERYBODY, shown_name
from mjforage.view.render.text import fit, width, write
from mjforage.view.render.timeline import Timeline

_CHART_TOP, _CHART_HEIGHT, _CHART_LEFT = 132.0, 96.0, 40.0  # [unit] in the progress block
_MOST_CHART_GROWTH = 120.0  # [unit] where the panel has room to spare


class Panel:
    """Writes the panel of one replay: `paint_fixed` once, `paint_moving` on every frame."""

    def __init__(self, replay: Recording, timeline: Timeline, layout: Layout) -> None:
        self._replay, self._timeline, self._layout = replay, timeline, layout
        u = layout.unit
        down, across = (1, 0) if layout.stacked else (0, 1)
        left, top = layout.panel_left, layout.panel_top
        step = (PANEL_WIDTH + COLUMN_GAP) * u * across
        self.title = (left, top)
        self.progress = (left + step, top + TITLE_HEIGHT * u * down)
        legend = legend_height(len(replay.team_names), replay.held is not None)
        least = (TITLE_HEIGHT + PROGRESS_HEIGHT + legend) * u
        spare = max(0.0, layout.panel_height - least) * down
        self._chart_height = _CHART_HEIGHT * u + min(spare, _MOST_CHART_GROWTH * u)
        legend_down = (TITLE_HEIGHT + PROGRESS_HEIGHT) * u * down + spare
        self.legend = (left + 2 * step, top + legend_down)

    def paint_fixed(self, image: Image) -> None:
        """Paint what does not change: title, chart axes."""
        replay, size = self._replay, self._layout.size
        left, top = self.title
        u = self._layout.unit
        room = PANEL_WIDTH * u
        rows, columns = replay.navigable.shape
        name = fit(replay.policy or "episode", size(30), room, bold=True)
        write(image, name, left, top + 28 * u, size(30), bold=True)
        about = f"{replay.world} world · episode {replay.episode} · seed {replay.seed}"
        write(image, fit(about, size(13.5), room), left, top + 52 * u, size(13.5), colour=_SOFT)
        grid = f"{rows} × {columns} nodes, {replay.pitch_m:g} m apart"
        if shown_name(replay) != EVERYBODY:
            grid = f"seen by {shown_name(replay)} · {grid}"
        write(image, fit(grid, size(13.5), room), left, top + 72 * u, size(13.5), colour=_SOFT)
        self._paint_axes(image)

    def _chart(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of the chart's plotting area [pixel]."""
        u, (left, top) = self._layout.unit, self.progress
        chart_top = top + _CHART_TOP * u
        right = left + (PANEL_WIDTH - 6) * u
        return left + _CHART_LEFT * u, chart_top, right, chart_top + self._chart_height

    def _paint_axes(self, image: Image) -> None:
        u, size = self._layout.unit, self._layout.size
        left, top, right, bottom = self._chart()
        for percent in (0, 50, 100):
            y = bottom - (bottom - top) * percent / 100.0
            paint_box(image, (left, y - 0.5, right, y + 0.5), 0.0, 0.0, 1.0, palette.HAIRLINE)
            label = f"{percent}" + (" %" if percent == 100 else "")
            write(image, label, left - 7 * u, y + 4 * u, size(11), colour=_SOFT, align="right")
        horizon = self._replay.horizon
        for step, align in ((0, "left"), (horizon // 2, "middle"), (horizon, "right")):
            x = left + (right - left) * step / max(horizon, 1)
            text = "step 0" if step == 0 else str(step)
            write(image, text, x, bottom + 17 * u, size(11), colour=_SOFT, align=align)

    def paint_moving(self, image: Image, time: float) -> None:
        """Paint clock, bars and curves at `time` [step]."""
        replay, timeline, size = self._replay, self._timeline, self._layout.size
        u, (left, top) = self._layout.unit, self.title
        step = int(time + 1e-9)
        write(
            image, mission_clock(time * replay.period_s), left, top + 128 * u, size(40), bold=True
        )
        right = left + PANEL_WIDTH * u
        write(image, f"step {step}", right, top + 110 * u, size(15), bold=True, align="right")
        of = f"of {replay.horizon}"
        write(image, of, right, top + 128 * u, size(13.5), colour=_SOFT, align="right")
        items = len(timeline.discovered)
        for row, (label, key, events, shares, colour) in enumerate(
            (
                ("Discovered", "PTA_D", timeline.discovered, timeline.pta_d, palette.SCOUT),
                ("Collected", "PTA_C", timeline.removed, timeline.pta_c, palette.FORAGER),
            )
        ):
            count = f"{int((events <= step).sum())} of {items}"
            share = f"{shares[step]:.0f} %"
            self._paint_bar(image, row, (label, key, count, share), shares[step], colour)
            self._paint_curve(image, shares, time, colour)

    def _paint_bar(
        self,
        image: Image,
        row: int,
        texts: tuple[str, str, str, str],
        percent: float,
        colour: Colour,
    ) -> None:
        u, size, (left, top) = self._layout.unit, self._layout.size, self.progress
        base, right = top + (18 + 54 * row) * u, left + PANEL_WIDTH * u
        label, key, count, share = texts
        write(image, label, left, base, size(15), bold=True)
        after = left + width(label, size(15), bold=True) + 8 * u
        write(image, f"{key}  {count}", after, base, size(12), colour=_SOFT)
        write(image, share, right, base, size(17), bold=True, align="right")
        bar = (float(left), base + 9 * u, right, base + 18 * u)
        paint_box(image, bar, 4.5 * u, 0.0, 1.0, palette.HAIRLINE)
        if percent > 0.0:
            end = left + max(9 * u, (right - left) * percent / 100.0)
            paint_box(image, (bar[0], bar[1], end, bar[3]), 4.5 * u, 0.0, 1.0, colour)

    def _paint_curve(
        self, image: Image, shares: NDArray[np.float64], time: float, colour: Colour
    ) -> None:
        left, top, right, bottom = self._chart()
        whole = np.arange(int(time) + 1.0)
        steps = np.append(whole, time) if time > whole[-1] else whole
        if len(steps) < 2:
            steps = np.array([0.0, 0.0])
        percent = np.interp(steps, np.arange(len(shares)), shares)
        x = left + (right - left) * steps / max(self._replay.horizon, 1)
        points = np.column_stack([x, bottom - (bottom - top) * percent / 100.0])
        line = np.full(len(points), 2.6 * self._layout.unit)
        paint_stroke(image, points, line, np.ones(len(points)), colour)
        paint_discs(image, points[-1:], 1.6 * line[:1], np.ones(1), colour)


_SOFT = palette.SOFT_INK


def mission_clock(seconds: float) -> str:
    """Return mm:ss, with hours only where there are any."""
    whole = int(seconds + 1e-6)
    hours, minutes = whole // 3600, whole // 60 % 60
    clock = f"{minutes:02d}:{whole % 60:02d}"
    return f"{hours}:{clock}" if hours else clock


def team_collects(replay: Recording) -> list[bool]:
    """Whether each team collects; a team without agents counts as scouts."""
    return [
        bool(np.any(replay.agent_collects[replay.agent_team == team]))
        for team in range(len(replay.team_names))
    ]
