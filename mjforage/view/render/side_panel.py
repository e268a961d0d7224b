"""The panel of a film: score, signs, compass and chart, beside the picture and never over it."""

import math
import re
from dataclasses import dataclass

import numpy as np

from mjforage.runs.episode_recording import Recording
from mjforage.view.page import style
from mjforage.view.render import palette, symbols
from mjforage.view.render.frame_split import Box, Kind, Split
from mjforage.view.render.inset import Inset
from mjforage.view.render.links import paint_link, paint_lost
from mjforage.view.render.palette import Colour
from mjforage.view.render.panel import mission_clock
from mjforage.view.render.raster import Floats, Image, paint_box, paint_polygon, paint_rings
from mjforage.view.render.seen_by import EVERYBODY, shown_name
from mjforage.view.render.text import fit, width, write
from mjforage.view.render.timeline import Timeline

DARK: Colour = (14.0, 30.0, 42.0)
PALE: Colour = (202.0, 216.0, 224.0)
_TRACK: Colour = (84.0, 104.0, 118.0)
PAD, GAP = 18.0, 14.0  # [unit]
SCORE_WIDTH, SCORE_HEIGHT = 250.0, 164.0  # [unit]
SIGNS_WIDTH, SIGN_ROW = 226.0, 22.0  # [unit]
NOTES_HEIGHT = 54.0  # [unit]
_TITLE = 24.0  # of a chart [unit]
_LEAST_CHART = 90.0  # [unit]
_MODULE = re.compile(r"^[\w.]+:")
_ARROW: Floats = np.array([[0.0, -1.0], [0.55, 0.8], [0.0, 0.4], [-0.55, 0.8]])
_UP: Floats = np.array([0.0, -1.0])
_CRISP = (0.0, 1.0, 1.0)  # grown by, edge, alpha
_WIND: Colour = (150.0, 206.0, 255.0)


@dataclass(frozen=True)
class Moment:
    """What a picture's panel tells of one time.

    Attributes
    ----------
    hulls : (agent, 3) row and column [node], course [rad], clockwise on the chart
    notes : what a viewer cannot know from the picture
    north_rad : where north is in the picture, clockwise from up
    wind_mps : (2,) towards east and north, 0 in still air
    """

    hulls: Floats
    notes: str
    north_rad: float
    wind_mps: tuple[float, float] = (0.0, 0.0)


def text_size(unit: float, units: float) -> int:
    """Font size in whole pixels, never too small to read."""
    return max(9, round(units * unit))


def paint_background(image: Image, box: Box) -> None:
    """Lay the ground that panels stand on."""
    left, top, right, bottom = (round(side) for side in box)
    image[top:bottom, left:right] = np.array(DARK, np.uint8)


def paint_head(image: Image, box: Box, unit: float, replay: Recording, title: str) -> None:
    """Name of who plays, of a user's class without its module, and which episode that is."""
    name = fit(_MODULE.sub("", title), text_size(unit, 16), 0.55 * box.width, bold=True)
    write(image, name, box.left, box.top + 16 * unit, text_size(unit, 16), bold=True, colour=_WHITE)
    size = text_size(unit, 11.5)
    room = box.width - width(name, text_size(unit, 16), bold=True) - 8 * unit
    about = fit(f"{replay.world} world · episode {replay.episode}", size, room)
    write(image, about, box.right, box.top + 16 * unit, size, colour=PALE, align="right")


def paint_clock(image: Image, box: Box, unit: float, replay: Recording, time: float) -> None:
    """Time of the mission and the step, on one line that starts at the top of the box."""
    base, clock = box.top + 31 * unit, mission_clock(time * replay.period_s)
    write(image, clock, box.left, base, text_size(unit, 40), bold=True, colour=_WHITE)
    count, size = f"step {int(time + 1e-9)} of {replay.horizon}", text_size(unit, 12.5)
    write(image, count, box.right, base, size, colour=PALE, align="right")


def paint_shares(image: Image, box: Box, unit: float, timeline: Timeline, time: float) -> None:
    """What is discovered and collected: two bars below each other, 44 units apart."""
    step, items = int(time + 1e-9), len(timeline.discovered)
    found, taken = (int((e <= step).sum()) for e in (timeline.discovered, timeline.removed))
    rows = (
        ("PTA_D", f"{found} of {items} discovered", timeline.pta_d[step], palette.SCOUT),
        ("PTA_C", f"{taken} of {items} collected", timeline.pta_c[step], palette.FORAGER),
    )
    for number, row in enumerate(rows):
        _paint_bar(image, box, box.top + (14 + 44 * number) * unit, unit, row)


def _paint_bar(
    image: Image, box: Box, base: float, unit: float, row: tuple[str, str, float, Colour]
) -> None:
    key, words, share, colour = row
    key_size, size = text_size(unit, 13), text_size(unit, 11.5)
    write(image, key, box.left, base, key_size, bold=True, colour=_WHITE)
    after = box.left + width(key, key_size, bold=True) + 8 * unit
    percent, large = f"{share:.0f} %", text_size(unit, 14)
    room = box.right - after - width(percent, large, bold=True) - 6 * unit
    write(image, fit(words, size, room), after, base, size, colour=PALE)
    write(image, percent, box.right, base, large, bold=True, colour=_WHITE, align="right")
    low, high = base + 9 * unit, base + 17 * unit
    paint_box(image, (box.left, low, box.right, high), 4 * unit, 0.0, 1.0, _TRACK)
    if share > 0.0:
        reach = box.left + max(8 * unit, box.width * share / 100.0)
        paint_box(image, (box.left, low, reach, high), 4 * unit, 0.0, 1.0, colour)


def sign_rows(replay: Recording) -> int:
    """How many rows the signs of an episode take."""
    return 4 + 2 * (replay.held is not None)


def paint_signs(
    image: Image,
    box: Box,
    unit: float,
    replay: Recording,
    most: int,
    *,
    drawn: bool,
    columns: int = 1,
) -> None:
    """What the marks mean; `drawn`: items are dots in a drawing, else bodies with rings; `most`:
    see `palette.most_believed`.
    """
    u, one = unit, np.ones(1)
    rows = ["item, discovered", "item, not yet", f"believed: 1, 2, {most}"]
    rows += ["idleness 0–1" if drawn else "idleness 0–1 (chart)"]
    if replay.held is not None:
        rows += ["in contact", "looks lost in this step"]
    linked = len(rows)
    collects = np.unique(replay.agent_collects).tolist() if drawn else []
    rows += [style.role(one) for one in collects]  # bodies have their names beside them
    wide = box.width / columns
    for number, words in enumerate(rows):
        left = box.left + number % columns * wide
        y = box.top + (number // columns + 0.5) * SIGN_ROW * u
        mark = np.array([[left + 17 * u, y]])
        patch = (left, y - 9 * u, left + 34 * u, y + 9 * u)
        paint_box(image, patch, 4 * u, 0.0, 1.0, palette.CLEAR_DEEP if drawn else palette.DEEP_SEA)
        if number < 2 and drawn:
            symbols.paint_items(image, mark, one, 4.0 * u, known=number == 0)
        elif number < 2:
            symbols.paint_body(image, mark[0], u, known=number == 0)
        elif number == 2:
            for count, shift in ((1, -11.3), (2, 0.0), (most, 11.3)):
                at = mark + np.array([[shift * u, 0.0]])
                symbols.paint_believed(image, at, np.array([count]), one, 11.3 * u, most)
        elif number == 3:
            _paint_idleness(image, patch)
        elif number >= linked:
            role = collects[number - linked]
            colour = palette.FORAGER if role else palette.SCOUT
            symbols.paint_hull(image, mark[0] - (u, 0.0), 0.0, 15.0 * u, role, colour)
        else:
            ends = mark + np.array([[-14.0 * u, 0.0], [14.0 * u, 0.0]])
            (paint_link if number == 4 else paint_lost)(image, ends, u)
        size = text_size(u, 12)
        words = fit(words, size, wide - 42 * u)
        write(image, words, left + 42 * u, y + 4.5 * u, size, colour=PALE)


def _paint_idleness(image: Image, patch: tuple[float, float, float, float]) -> None:
    left, top, right, bottom = (round(side) for side in patch)
    part = np.linspace(0.0, 1.0, right - left)[:, None]
    clear, hazy = np.array(palette.CLEAR_DEEP), np.array(palette.HAZY_DEEP)
    image[top:bottom, left:right] = np.rint(clear + (hazy - clear) * part).astype(np.uint8)


def paint_notes(image: Image, box: Box, unit: float, moment: Moment) -> None:
    """A compass whose needle shows north, clockwise from up in the picture, and words beside it.

    Where there is wind, a dart outside its ring comes from where the wind does.
    """
    radius, y = 14.0 * unit, 0.5 * (box.top + box.bottom)
    at = np.array([box.left + 24.0 * unit, y])
    paint_compass(image, at, radius, moment.north_rad)
    east, north = moment.wind_mps
    speed = math.hypot(east, north)
    if speed > 0.0:
        toward = moment.north_rad + math.atan2(east, north)
        dart = 0.35 * radius * _turned(_ARROW, toward)
        paint_polygon(image, at - 1.45 * radius * _turned(_UP, toward) + dart, *_CRISP, _WIND)
    x, up = at + (radius + 8.0 * unit) * np.array(
        [np.sin(moment.north_rad), -np.cos(moment.north_rad)]
    )
    write(
        image, "N", x, up + 4 * unit, text_size(unit, 11), bold=True, colour=_WHITE, align="middle"
    )
    left, size = box.left + 56.0 * unit, text_size(unit, 12)
    lines = [(moment.notes, PALE)] if moment.notes else []
    lines += [(f"wind {speed:.1f} m/s", _WIND)] if speed > 0.0 else []
    for number, (words, colour) in enumerate(lines):
        base = y + (4.5 + 17.0 * (number - 0.5 * (len(lines) - 1))) * unit
        write(image, fit(words, size, box.right - left), left, base, size, colour=colour)


def paint_compass(image: Image, at: Floats, radius: float, north_rad: float) -> None:
    """A needle in a ring around `at` (2,) [pixel]; it shows north, clockwise from up."""
    line = np.array([radius]), np.array([0.1 * radius]), np.array([0.7])
    paint_rings(image, at[None], *line, PALE)
    needle = 0.7 * radius * _turned(_ARROW, north_rad) + at
    paint_polygon(image, needle, *_CRISP, _WHITE)


def _turned(shape: Floats, clockwise_rad: float) -> Floats:
    """Corners (n, 2) or one (2,), right and down, turned in the picture."""
    cos, sin = np.cos(clockwise_rad), np.sin(clockwise_rad)
    turned: Floats = shape @ np.array([[cos, sin], [-sin, cos]])
    return turned


def chart(
    replay: Recording,
    colours: list[Colour],
    box: Box,
    unit: float,
    followed: int | None,
    most: int | None = None,
) -> Inset:
    """The chart that fits into a box below its title."""
    return Inset(replay, colours, (box.width, box.height - _TITLE * unit), followed, most)


def paint_chart(
    image: Image, box: Box, unit: float, inset: Inset, time: float, hulls: Floats
) -> None:
    """The chart in the middle of its box, with whose belief it is and how many items that has."""
    left = box.left + 0.5 * (box.width - inset.width)
    right, replay = left + inset.width, inset.replay
    base, size, by = box.top + 15 * unit, text_size(unit, 12.5), shown_name(replay)
    room = inset.width - 3 * size
    long, short = (f"seen by {by}", by) if by != EVERYBODY else ("believed items", "believed")
    words = long if width(long, size, bold=True) <= room else fit(short, size, room, bold=True)
    write(image, words, left, base, size, bold=True, colour=_WHITE)
    believed = str(int(replay.belief[int(time + 1e-9)].sum()))
    write(image, believed, right, base, size, colour=PALE, align="right")
    inset.paint(image, round(left), round(box.top + _TITLE * unit), time, hulls)


class SidePanel:
    """Paints one replay's panel into frames: a column, a row or, in small frames, one line."""

    def __init__(
        self,
        replay: Recording,
        timeline: Timeline,
        split: Split,
        colours: list[Colour],
        followed: int | None,
    ) -> None:
        self._replay, self._timeline, self._split = replay, timeline, split
        u, inside = split.unit, split.panel.shrunk(PAD * split.unit)
        self._score = Box(inside.left, inside.top, inside.left + SCORE_WIDTH * u, inside.bottom)
        high = sign_rows(replay) * SIGN_ROW * u
        self._signs: Box | None = None
        if split.kind is Kind.COLUMN:
            top = inside.top + (SCORE_HEIGHT + GAP) * u
            notes = Box(inside.left, inside.bottom - NOTES_HEIGHT * u, inside.right, inside.bottom)
            room = Box(inside.left, top, inside.right, notes.top - GAP * u)
            if room.height - high - GAP * u > 2.0 * _LEAST_CHART * u:
                self._signs = Box(room.left, top, room.right, top + high)
                room = room._replace(top=top + high + GAP * u)
        else:
            left = self._score.right + 2 * GAP * u
            notes = Box(
                left, inside.bottom - NOTES_HEIGHT * u, left + SIGNS_WIDTH * u, inside.bottom
            )
            self._signs = Box(left, inside.top, notes.right, inside.top + high)
            if inside.right - notes.right < 1.5 * _LEAST_CHART * u:
                self._signs, notes = None, notes._replace(right=left)
            room = Box(notes.right + 2 * GAP * u, inside.top, inside.right, inside.bottom)
        self._notes = notes
        self._room = room
        self._inset: Inset | None = None
        if split.kind is not Kind.LINE:
            self._inset = chart(replay, colours, room, u, followed)

    def paint(self, image: Image, time: float, moment: Moment) -> None:
        """Paint the panel of `time` [step]."""
        u = self._split.unit
        paint_background(image, self._split.panel)
        if self._inset is None:
            self._paint_line(image, time, moment.north_rad)
            return
        score = self._score
        paint_head(image, score, u, self._replay, self._replay.policy or "episode")
        paint_clock(image, score.lower(30 * u), u, self._replay, time)
        paint_shares(image, score.lower(76 * u), u, self._timeline, time)
        if self._signs is not None:
            most = palette.most_believed(self._replay.belief)
            paint_signs(image, self._signs, u, self._replay, most, drawn=False)
        if self._notes.width > 0:
            paint_notes(image, self._notes, u, moment)
        paint_chart(image, self._room, u, self._inset, time, moment.hulls)

    def _paint_line(self, image: Image, time: float, north_rad: float) -> None:
        """Clock, shares and a compass without words, as much of it as there is room for."""
        step, box = int(time + 1e-9), self._split.panel
        shares = (("PTA_D", self._timeline.pta_d[step]), ("PTA_C", self._timeline.pta_c[step]))
        words = [mission_clock(time * self._replay.period_s)]
        words += [f"{key} {share:.0f} %" for key, share in shares]
        size, room = text_size(self._split.unit, 13), box.width - 12.0
        radius = 0.5 * box.height - 2.0
        compass = width(words[0], size, bold=True) + 3.0 * radius < room
        if compass:
            at = np.array([box.right - 6.0 - radius, box.top + 0.5 * box.height])
            paint_compass(image, at, radius, north_rad)
            room -= 3.0 * radius
        line = "   ".join(words)
        if width(line, size, bold=True) > room:
            line = fit(words[0], size, room, bold=True)
        write(image, line, 6.0, box.bottom - 7.0, size, bold=True, colour=_WHITE)


_WHITE = palette.WHITE
