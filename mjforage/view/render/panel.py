"""Parts of a film's panel: head, clock, shares, signs, compass and chart."""

import math
import re
from dataclasses import dataclass

import numpy as np

from mjforage.runs.episode_recording import Recording
from mjforage.view.page import style
from mjforage.view.render import palette, symbols
from mjforage.view.render.chart import Chart
from mjforage.view.render.layout import SIGN_ROW, Box
from mjforage.view.render.links import paint_link, paint_lost
from mjforage.view.render.palette import WHITE, Colour
from mjforage.view.render.raster import Floats, Image, paint_box, paint_polygon, paint_rings
from mjforage.view.render.seen_by import EVERYBODY, shown_name
from mjforage.view.render.text import fit, width, write
from mjforage.view.render.timeline import Timeline

DARK: Colour = (14.0, 30.0, 42.0)
PALE: Colour = (202.0, 216.0, 224.0)
_BAR: Colour = (84.0, 104.0, 118.0)
_WIND: Colour = (150.0, 206.0, 255.0)
_MODULE = re.compile(r"^[\w.]+:")
_ARROW: Floats = np.array([[0.0, -1.0], [0.55, 0.8], [0.0, 0.4], [-0.55, 0.8]])
_UP: Floats = np.array([0.0, -1.0])
_CRISP = (0.0, 1.0, 1.0)  # grown by, edge, alpha


@dataclass(frozen=True)
class PanelState:
    """State of a panel at one time, besides the recording.

    Attributes
    ----------
    notes : facts that the picture does not show
    north_rad : direction of north in the picture, clockwise from up
    wind_mps : (2,) towards east and north, 0 in still air
    """

    notes: str = ""
    north_rad: float = 0.0
    wind_mps: tuple[float, float] = (0.0, 0.0)


def text_size(unit: float, units: float) -> int:
    """Font size in whole pixels, never too small to read."""
    return max(9, round(units * unit))


def mission_clock(seconds: float) -> str:
    """Return mm:ss, with hours only where there are any."""
    whole = int(seconds + 1e-6)
    hours, minutes = whole // 3600, whole // 60 % 60
    clock = f"{minutes:02d}:{whole % 60:02d}"
    return f"{hours}:{clock}" if hours else clock


def short_name(policy: str) -> str:
    """Name of a policy, of a user's class without its module."""
    return _MODULE.sub("", policy) or "episode"


def paint_head(image: Image, box: Box, unit: float, policy: str, about: str) -> None:
    """Policy with its colour, and words about the episode."""
    size = text_size(unit, 16)
    base, x, room = box.bottom - 0.5 * (box.height - 0.72 * size), box.left + 10 * unit, box.width
    swatch = (x, base - 0.75 * size, x + 0.75 * size, base)
    paint_box(image, swatch, 3 * unit, 0.0, 1.0, WHITE)
    colour = palette.from_hex(style.policy_colour(policy))
    paint_box(image, swatch, 3 * unit, -1.5 * unit, 1.0, colour)
    x, room = x + size + 2 * unit, room - size - 22 * unit
    name = fit(short_name(policy), size, 0.6 * room, bold=True)
    write(image, name, x, base, size, bold=True, colour=WHITE)
    room -= width(name, size, bold=True) + 12 * unit
    size = text_size(unit, 12)
    about = fit(about, size, room)
    write(image, about, box.right - 10 * unit, base, size, colour=PALE, align="right")


def paint_clock(image: Image, box: Box, unit: float, recording: Recording, time: float) -> None:
    """Time of the mission and the step, on one line that starts at the top of the box."""
    base, clock = box.top + 31 * unit, mission_clock(time * recording.period_s)
    write(image, clock, box.left, base, text_size(unit, 40), bold=True, colour=WHITE)
    count, size = f"step {int(time + 1e-9)} of {recording.horizon}", text_size(unit, 12.5)
    write(image, count, box.right, base, size, colour=PALE, align="right")


def paint_shares(image: Image, box: Box, unit: float, timeline: Timeline, time: float) -> None:
    """Two bars, 44 units apart: shares of items that are discovered and collected."""
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
    write(image, key, box.left, base, key_size, bold=True, colour=WHITE)
    after = box.left + width(key, key_size, bold=True) + 8 * unit
    percent, large = f"{share:.0f} %", text_size(unit, 14)
    room = box.right - after - width(percent, large, bold=True) - 6 * unit
    write(image, fit(words, size, room), after, base, size, colour=PALE)
    write(image, percent, box.right, base, large, bold=True, colour=WHITE, align="right")
    low, high = base + 9 * unit, base + 17 * unit
    paint_box(image, (box.left, low, box.right, high), 4 * unit, 0.0, 1.0, _BAR)
    if share > 0.0:
        reach = box.left + max(8 * unit, box.width * share / 100.0)
        paint_box(image, (box.left, low, reach, high), 4 * unit, 0.0, 1.0, colour)


def sign_words(recording: Recording, most: int, drawn: bool) -> list[str]:
    """Meaning of each sign; `drawn` and `most`: see `paint_signs`."""
    idleness = "idleness 0–1" if drawn else "idleness 0–1 (chart)"
    words = ["item, discovered", "item, not yet", f"believed: 1, 2, {most}", idleness]
    if recording.knowledge is not None:
        words += ["in contact", "scans lost in this step"]
    if drawn:  # vessels in 3-D have their names beside them
        words += [style.role(one) for one in np.unique(recording.agent_collects).tolist()]
    return words


def paint_signs(
    image: Image, box: Box, unit: float, recording: Recording, most: int, drawn: bool
) -> None:
    """Signs with their meaning, in as many columns as the box needs.

    Parameters
    ----------
    most : see `palette.most_believed`
    drawn : True if items are dots in a drawing, else bodies with rings
    """
    u, one = unit, np.ones(1)
    words = sign_words(recording, most, drawn)
    columns = 1 if len(words) * SIGN_ROW * u <= box.height + 1.0 else 2
    wide, size = box.width / columns, text_size(u, 12)
    for number, word in enumerate(words):
        left = box.left + number % columns * wide
        y = box.top + (number // columns + 0.5) * SIGN_ROW * u
        mark = np.array([[left + 17 * u, y]])
        patch = (left, y - 9 * u, left + 34 * u, y + 9 * u)
        paint_box(image, patch, 4 * u, 0.0, 1.0, palette.CLEAR_DEEP if drawn else palette.DEEP_SEA)
        if word.startswith("item") and drawn:
            symbols.paint_items(image, mark, one, 4.0 * u, known=number == 0)
        elif word.startswith("item"):
            symbols.paint_body(image, mark[0], u, known=number == 0)
        elif word.startswith("believed"):
            for count, shift in ((1, -11.3), (2, 0.0), (most, 11.3)):
                at = mark + np.array([[shift * u, 0.0]])
                symbols.paint_believed(image, at, np.array([count]), one, 11.3 * u, most)
        elif word.startswith("idleness"):
            _paint_idleness(image, patch)
        elif word in ("in contact", "scans lost in this step"):
            ends = mark + np.array([[-14.0 * u, 0.0], [14.0 * u, 0.0]])
            (paint_link if word == "in contact" else paint_lost)(image, ends, u)
        else:
            collects = word == style.role(True)
            colour = palette.FORAGER if collects else palette.SCOUT
            symbols.paint_hull(image, mark[0] - (u, 0.0), 0.0, 15.0 * u, collects, colour)
        word = fit(word, size, wide - 42 * u)
        write(image, word, left + 42 * u, y + 4.5 * u, size, colour=PALE)


def _paint_idleness(image: Image, patch: tuple[float, float, float, float]) -> None:
    left, top, right, bottom = (round(side) for side in patch)
    part = np.linspace(0.0, 1.0, right - left)[:, None]
    clear, hazy = np.array(palette.CLEAR_DEEP), np.array(palette.HAZY_DEEP)
    image[top:bottom, left:right] = np.rint(clear + (hazy - clear) * part).astype(np.uint8)


def paint_notes(image: Image, box: Box, unit: float, state: PanelState) -> None:
    """A compass whose needle shows north, clockwise from up in the picture, and words beside it.

    Where there is wind, a dart outside its ring comes from where the wind does.
    """
    radius, y = 14.0 * unit, 0.5 * (box.top + box.bottom)
    at = np.array([box.left + 24.0 * unit, y])
    paint_compass(image, at, radius, state.north_rad)
    east, north = state.wind_mps
    speed = math.hypot(east, north)
    if speed > 0.0:
        toward = state.north_rad + math.atan2(east, north)
        dart = 0.35 * radius * symbols.turned(_ARROW, toward)
        dart = at - 1.45 * radius * symbols.turned(_UP, toward) + dart
        paint_polygon(image, dart, *_CRISP, _WIND)
    x, up = at + (radius + 8.0 * unit) * symbols.turned(_UP, state.north_rad)
    size = text_size(unit, 11)
    write(image, "N", x, up + 4 * unit, size, bold=True, colour=WHITE, align="middle")
    left, size = box.left + 56.0 * unit, text_size(unit, 12)
    lines = [(state.notes, PALE)] if state.notes else []
    lines += [(f"wind {speed:.1f} m/s", _WIND)] if speed > 0.0 else []
    for number, (words, colour) in enumerate(lines):
        base = y + (4.5 + 17.0 * (number - 0.5 * (len(lines) - 1))) * unit
        write(image, fit(words, size, box.right - left), left, base, size, colour=colour)


def paint_compass(image: Image, at: Floats, radius: float, north_rad: float) -> None:
    """A needle in a ring around `at` (2,) [pixel]; it shows north, clockwise from up."""
    line = np.array([radius]), np.array([0.1 * radius]), np.array([0.7])
    paint_rings(image, at[None], *line, PALE)
    needle = 0.7 * radius * symbols.turned(_ARROW, north_rad) + at
    paint_polygon(image, needle, *_CRISP, WHITE)


CHART_TITLE = 24.0  # above a chart [unit]


def paint_chart(
    image: Image, box: Box, unit: float, chart: Chart, recording: Recording, time: float
) -> None:
    """The chart in the middle of its box, with the belief's owner and its number of items."""
    left, by = box.left + 0.5 * (box.width - chart.width), shown_name(recording)
    base, size, right = box.top + 15 * unit, text_size(unit, 12.5), left + chart.width
    room = chart.width - 3 * size
    long, short = (f"seen by {by}", by) if by != EVERYBODY else ("believed items", "believed")
    words = long if width(long, size, bold=True) <= room else fit(short, size, room, bold=True)
    write(image, words, left, base, size, bold=True, colour=WHITE)
    believed = str(int(recording.belief[int(time + 1e-9)].sum()))
    write(image, believed, right, base, size, colour=PALE, align="right")
    top, left = round(box.top + CHART_TITLE * unit), round(left)
    image[top : top + chart.height, left : left + chart.width] = chart.picture(time)
