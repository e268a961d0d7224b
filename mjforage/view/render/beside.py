"""Two episodes side by side: the same clock, one explanation of the signs, a score each."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mjforage.base.errors import UserError
from mjforage.runs.episode_recording import Recording
from mjforage.view.page import style
from mjforage.view.render import palette
from mjforage.view.render.frame_split import Box, is_brief, unit_of
from mjforage.view.render.inset import Inset
from mjforage.view.render.palette import Colour
from mjforage.view.render.panel import mission_clock
from mjforage.view.render.raster import Image, paint_box
from mjforage.view.render.seen_by import EVERYBODY, shown_name
from mjforage.view.render.side_panel import (
    DARK,
    GAP,
    PAD,
    PALE,
    Moment,
    chart,
    paint_chart,
    paint_clock,
    paint_notes,
    paint_shares,
    paint_signs,
    text_size,
)
from mjforage.view.render.text import fit, width, write
from mjforage.view.render.timeline import Timeline, timeline_of

_HEAD, _STRIP = 34.0, 186.0  # above and below the pictures [unit]
_LINE = 23  # of a small frame's head [pixel]
_BETWEEN = 4.0  # the pictures [unit]
_MIDDLE = 330.0  # least width of clock and signs [unit]
_SCORE = 150.0  # least width of a score [unit]
_CHART = 130.0  # [unit]
_CLOCK = 44.0  # [unit]


@dataclass(frozen=True)
class Half:
    """One of the two: its episode, and what draws it without a panel.

    Attributes
    ----------
    draw : picture (height, width, 3) at a time [step]
    moment : what else is told of that time
    charted : whether belief and idleness are in a chart, and not in the picture
    followed : agent that the chart marks, or None
    """

    replay: Recording
    draw: Callable[[float], Image]
    moment: Callable[[float], Moment]
    charted: bool
    followed: int | None


def check_beside(first: Recording, second: Recording) -> None:
    """Check that two episodes can share a clock.

    Raises
    ------
    UserError
        If they are of the same policy, or of other items.
    """
    if first.policy == second.policy:
        raise UserError(f"beside {second.policy}: is the film's own policy; name another one")
    alike = ("world", "episode", "seed", "period_s", "pitch_m", "vessels", "team_names")
    arrays = ("navigable", "agent_team", "agent_collects", "item_class")
    same = all(getattr(first, name) == getattr(second, name) for name in alike)
    if not same or not all(
        np.array_equal(getattr(first, name), getattr(second, name)) for name in arrays
    ):
        raise UserError(f"beside {second.policy}: is not the same episode; play both from one run")


class BesideFrame:
    """Where everything is in a frame of `width` x `height` that shows two episodes."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height, self.unit = width, height, unit_of(width, height)
        self.brief = is_brief(round(0.75 * width), height)
        self.head = _LINE if self.brief else round(_HEAD * self.unit)
        self.strip = 0 if self.brief else round(_STRIP * self.unit)
        gap = max(2, 2 * round(0.5 * _BETWEEN * self.unit))
        left = (width - gap) // 2
        high = height - self.head - self.strip
        self.pictures = (
            Box(0, self.head, left, self.head + high),
            Box(left + gap, self.head, width, self.head + high),
        )
        """Whole pixels; of odd widths the right one has one pixel more."""
        self.rooms = [(round(box.width), round(box.height)) for box in self.pictures]
        """Width and height of each."""


class Beside:
    """Draws frames (height, width, 3) uint8 of two halves; `frame(73.5)` is between two steps."""

    def __init__(self, halves: tuple[Half, Half], place: BesideFrame) -> None:
        self._halves, self._place = halves, place
        self._timelines = tuple(timeline_of(half.replay) for half in halves)
        self._scores, self._rooms, self._middle = _strip_boxes(place, halves[0].charted)
        self._most = palette.most_believed(*(half.replay.belief for half in halves))
        self._charts: list[Inset | None] = [None, None]
        if self._rooms is not None:
            self._charts = [
                _chart(*both, place.unit, self._most)
                for both in zip(halves, self._rooms, strict=True)
            ]

    def frame(self, time: float) -> Image:
        """Draw both at `time` [step]; an episode that is over stays at its end."""
        place = self._place
        image = np.empty((place.height, place.width, 3), np.uint8)
        image[:] = np.array(DARK, np.uint8)
        for number, half in enumerate(self._halves):
            timeline = self._timelines[number]
            now = min(time, float(timeline.length))
            left, top, right, bottom = (round(side) for side in place.pictures[number])
            image[top:bottom, left:right] = half.draw(now)
            self._paint_head(image, number, time)
            if not place.brief:
                self._paint_score(image, number, half.moment(now), now)
        if place.brief:
            return image
        u, longer = place.unit, longer_of(*(half.replay for half in self._halves))
        paint_clock(image, self._middle, u, longer, time)
        signs = self._middle.lower((_CLOCK + 10.0) * u)
        drawn = not self._halves[0].charted
        paint_signs(image, signs, u, longer, self._most, drawn=drawn, columns=2)
        return image

    def _paint_head(self, image: Image, number: int, time: float) -> None:
        """Name of the policy, and which episode it is or that it is over."""
        place, replay, timeline = self._place, self._halves[number].replay, self._timelines[number]
        u, box = place.unit, place.pictures[number]
        size, base = text_size(u, 16), 0.5 * place.head + 0.36 * text_size(u, 16)
        x, room = box.left + 10 * u, box.width - 20 * u
        colour = palette.from_hex(style.policy_colour(replay.policy))
        swatch = (x, base - 0.75 * size, x + 0.75 * size, base)
        paint_box(image, swatch, 3 * u, 0.0, 1.0, palette.WHITE)
        paint_box(image, swatch, 3 * u, -1.5 * u, 1.0, colour)
        x, room = x + size + 2 * u, room - size - 2 * u
        name = fit(replay.policy, size, 0.6 * room, bold=True)
        write(image, name, x, base, size, bold=True, colour=palette.WHITE)
        words = self._about(replay, timeline, time)
        size, room = text_size(u, 12), room - width(name, size, bold=True) - 40 * u
        words = fit(words, size, room)
        write(image, words, box.right - 10 * u, base, size, colour=PALE, align="right")

    def _about(self, replay: Recording, timeline: Timeline, time: float) -> str:
        over = time >= timeline.length
        if self._place.brief:
            now = min(time, float(timeline.length))
            share = timeline.pta_c[int(now + 1e-9)]
            return f"{mission_clock(now * replay.period_s)} · PTA_C {share:.0f} %"
        if over:
            return f"ended at {mission_clock(timeline.length * replay.period_s)}"
        seen = shown_name(replay)
        eyes = "" if seen == EVERYBODY else f"seen by {seen} · "
        return f"{eyes}{replay.world} world · episode {replay.episode}"

    def _paint_score(self, image: Image, number: int, moment: Moment, now: float) -> None:
        u, score, inset = self._place.unit, self._scores[number], self._charts[number]
        paint_shares(image, score, u, self._timelines[number], now)
        notes = score._replace(top=score.bottom - 54 * u)
        paint_notes(image, notes, u, moment)
        if inset is not None and self._rooms is not None:
            paint_chart(image, self._rooms[number], u, inset, now, moment.hulls)


def _strip_boxes(
    place: BesideFrame, charted: bool
) -> tuple[tuple[Box, Box], tuple[Box, Box] | None, Box]:
    """Boxes of scores, of charts where there is room for them, and of clock and signs."""
    u = place.unit
    top, bottom = place.height - place.strip + PAD * u, place.height - PAD * u
    left, right = PAD * u, place.width - PAD * u
    rooms = None
    if charted and right - left > (2 * (_CHART + _SCORE + 3 * GAP) + _MIDDLE) * u:
        high = bottom + 6 * u
        rooms = (
            Box(left, top - 8 * u, left + _CHART * u, high),
            Box(right - _CHART * u, top - 8 * u, right, high),
        )
        left, right = rooms[0].right + GAP * u, rooms[1].left - GAP * u
    wide = min(250.0 * u, 0.5 * (right - left - _MIDDLE * u) - 2 * GAP * u)
    wide = max(wide, 0.28 * (right - left))
    scores = Box(left, top, left + wide, bottom), Box(right - wide, top, right, bottom)
    middle = Box(scores[0].right + 2 * GAP * u, top, scores[1].left - 2 * GAP * u, bottom)
    return scores, rooms, middle


def _chart(half: Half, room: Box, unit: float, most: int) -> Inset:
    colours: list[Colour] = palette.agent_colours(half.replay.agent_collects.tolist())
    return chart(half.replay, colours, room, unit, half.followed, most)


def longer_of(first: Recording, second: Recording) -> Recording:
    """The episode that ends later."""
    return max((first, second), key=lambda replay: len(replay.agent_rc))
