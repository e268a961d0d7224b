"""Words and figures over a film: clock, progress, belief map, names of vessels."""

import numpy as np

from mjforage.runs.episode_replay import Replay
from mjforage.view.render import palette
from mjforage.view.render.inset import Inset
from mjforage.view.render.palette import Colour, team_colours
from mjforage.view.render.panel import mission_clock, team_collects
from mjforage.view.render.raster import Floats, Image, paint_box
from mjforage.view.render.seen_by import EVERYBODY, shown_name
from mjforage.view.render.text import fit, width, write
from mjforage.view.render.timeline import Timeline

_GLASS: Colour = (14.0, 30.0, 42.0)
_GLASS_ALPHA = 0.66
_PALE: Colour = (202.0, 216.0, 224.0)
_TRACK: Colour = (84.0, 104.0, 118.0)
_PAD, _MARGIN = 16.0, 18.0  # [unit]
_CARD_WIDTH, _CARD_HEIGHT = 268.0, 186.0  # [unit]
_INSET_WIDTH, _INSET_HEIGHT = 178.0, 226.0  # [unit] at most
_LEAST_INSET = 0.58
_FULL_HEIGHT = 720.0  # frame height at which a unit is a pixel
_FULL_WIDTH = 1080.0
_LEAST_UNIT = 0.74
_BRIEF_WIDTH, _BRIEF_HEIGHT = 480, 320  # smaller frames have room for one line of words only


class Overlay:
    """Paints one replay's figures into frames of `width` x `height`."""

    def __init__(self, replay: Replay, timeline: Timeline, width: int, height: int) -> None:
        self._replay, self._timeline = replay, timeline
        self._width, self._height = width, height
        self._unit = max(_LEAST_UNIT, min(height / _FULL_HEIGHT, width / _FULL_WIDTH))
        self._brief = width < _BRIEF_WIDTH or height < _BRIEF_HEIGHT
        collects = team_collects(replay)
        self.colours = team_colours(collects)
        self._scout = next((c for c, f in zip(self.colours, collects, strict=True) if not f), _PALE)
        self._forager = next((c for c, f in zip(self.colours, collects, strict=True) if f), _PALE)
        small = max(_LEAST_INSET, min(height / _FULL_HEIGHT, width / _FULL_WIDTH))
        room = _INSET_WIDTH * small, _INSET_HEIGHT * small
        self._inset = Inset(replay, self.colours, room)

    def paint(self, image: Image, time: float, hulls_rc: Floats, notes: str) -> None:
        """Paint the figures of `time` [step]; hulls (agent, 2) [node]; `notes` stand below left."""
        if self._brief:
            self._paint_line(image, time)
            return
        self._paint_card(image, time)
        self._paint_inset(image, time, hulls_rc)
        self._paint_notes(image, notes)

    def tags(self, image: Image, places: Floats, words: tuple[str, ...]) -> None:
        """Write names above points (n, 2) of the picture, no two over each other.

        Points that are not numbers get none.
        """
        if self._brief:
            return
        taken: list[tuple[float, float, float, float]] = []
        for number, (x, y) in enumerate(places.tolist()):
            if np.isfinite(x) and np.isfinite(y):
                box = self._free_box(x, y, words[number], taken)
                taken.append(box)
                self._paint_tag(image, box, words[number], int(self._replay.agent_team[number]))

    def _free_box(
        self, x: float, y: float, words: str, taken: list[tuple[float, float, float, float]]
    ) -> tuple[float, float, float, float]:
        """Room for a tag above a point, higher up where others are in the way."""
        u = self._unit
        wide, high = width(words, self._size(12.5), bold=True) + 15 * u, 18 * u
        left = min(max(x - 0.5 * wide, 2.0), self._width - wide - 2.0)
        top = y - high
        for other in sorted(taken, key=lambda box: -box[1]):
            beside = left >= other[2] or other[0] >= left + wide
            above = top >= other[3] + 2 * u or other[1] >= top + high + 2 * u
            if not beside and not above:
                top = other[1] - high - 2 * u
        top = max(top, 4 * u)
        return left, top, left + wide, top + high

    def _paint_tag(
        self, image: Image, box: tuple[float, float, float, float], words: str, team: int
    ) -> None:
        u, (left, top, _, _) = self._unit, box
        paint_box(image, box, 5 * u, 0.0, 0.72, _GLASS)
        stripe = (left + 4 * u, top + 4 * u, left + 7 * u, top + 14 * u)
        paint_box(image, stripe, 1.5 * u, 0.0, 1.0, self.colours[team])
        base = top + 13.5 * u
        size = self._size(12.5)
        write(image, words, left + 11 * u, base, size, bold=True, colour=palette.WHITE)

    def _size(self, units: float) -> int:
        return max(9, round(units * self._unit))

    def _glass(self, image: Image, box: tuple[float, float, float, float]) -> None:
        paint_box(image, box, 9 * self._unit, 0.0, _GLASS_ALPHA, _GLASS)

    def _paint_line(self, image: Image, time: float) -> None:
        """Clock and shares, as much of it as there is room for."""
        step = int(time + 1e-9)
        shares = (("PTA_D", self._timeline.pta_d[step]), ("PTA_C", self._timeline.pta_c[step]))
        words = [mission_clock(time * self._replay.period_s)]
        words += [f"{key} {share:.0f} %" for key, share in shares]
        size, room = self._size(13), self._width - 18.0
        line = "   ".join(words)
        if width(line, size, bold=True) > room:
            line = fit(words[0], size, room, bold=True)
        self._glass(image, (4.0, 4.0, 14.0 + width(line, size, bold=True), 10.0 + size))
        write(image, line, 9.0, 6.0 + size, size, bold=True, colour=palette.WHITE)

    def _paint_card(self, image: Image, time: float) -> None:
        u, replay, timeline = self._unit, self._replay, self._timeline
        left, top = _MARGIN * u, _MARGIN * u
        right, bottom = left + _CARD_WIDTH * u, top + _CARD_HEIGHT * u
        self._glass(image, (left, top, right, bottom))
        x, end, room = left + _PAD * u, right - _PAD * u, (_CARD_WIDTH - 2 * _PAD) * u
        name = fit(replay.policy or "episode", self._size(16), 0.5 * room, bold=True)
        write(image, name, x, top + 26 * u, self._size(16), bold=True, colour=palette.WHITE)
        about = f"{replay.world} world · episode {replay.episode}"
        about = fit(about, self._size(11.5), room - width(name, self._size(16), bold=True) - 8 * u)
        write(image, about, end, top + 26 * u, self._size(11.5), colour=_PALE, align="right")
        clock = mission_clock(time * replay.period_s)
        write(image, clock, x, top + 71 * u, self._size(40), bold=True, colour=palette.WHITE)
        step = int(time + 1e-9)
        count = f"step {step} of {replay.horizon}"
        write(image, count, end, top + 71 * u, self._size(12.5), colour=_PALE, align="right")
        items = len(timeline.discovered)
        found, taken = (int((e <= step).sum()) for e in (timeline.discovered, timeline.removed))
        rows = (
            ("PTA_D", f"{found} of {items} discovered", timeline.pta_d[step], self._scout),
            ("PTA_C", f"{taken} of {items} collected", timeline.pta_c[step], self._forager),
        )
        for number, row in enumerate(rows):
            self._paint_bar(image, x, end, top + (100 + 44 * number) * u, row)

    def _paint_bar(
        self, image: Image, x: float, end: float, base: float, row: tuple[str, str, float, Colour]
    ) -> None:
        u, (key, words, share, colour) = self._unit, row
        write(image, key, x, base, self._size(13), bold=True, colour=palette.WHITE)
        after = x + width(key, self._size(13), bold=True) + 8 * u
        write(image, words, after, base, self._size(11.5), colour=_PALE)
        percent = f"{share:.0f} %"
        write(
            image,
            percent,
            end,
            base,
            self._size(14),
            bold=True,
            colour=palette.WHITE,
            align="right",
        )
        low, high = base + 9 * u, base + 17 * u
        paint_box(image, (x, low, end, high), 4 * u, 0.0, 1.0, _TRACK)
        if share > 0.0:
            reach = x + max(8 * u, (end - x) * share / 100.0)
            paint_box(image, (x, low, reach, high), 4 * u, 0.0, 1.0, colour)

    def _paint_inset(self, image: Image, time: float, hulls_rc: Floats) -> None:
        u, inset = self._unit, self._inset
        pad, title = 10 * u, 26 * u
        right, bottom = self._width - _MARGIN * u, self._height - _MARGIN * u
        left, top = right - inset.width - 2 * pad, bottom - inset.height - pad - title
        self._glass(image, (left, top, right, bottom))
        base = top + 18 * u
        by, size = shown_name(self._replay), self._size(12.5)
        words = "believed items" if by == EVERYBODY else f"seen by {by}"
        words = fit(words, size, inset.width - 3 * size, bold=True)
        write(image, words, left + pad, base, size, bold=True, colour=palette.WHITE)
        believed = str(int(self._replay.belief[int(time + 1e-9)].sum()))
        write(image, believed, right - pad, base, size, colour=_PALE, align="right")
        inset.paint(image, round(left + pad), round(top + title), time, hulls_rc)

    def _paint_notes(self, image: Image, notes: str) -> None:
        if not notes:
            return
        u, size = self._unit, self._size(12)
        words = fit(notes, size, 0.6 * self._width)
        left, bottom = _MARGIN * u, self._height - _MARGIN * u
        box = (left, bottom - 26 * u, left + width(words, size) + 20 * u, bottom)
        self._glass(image, box)
        write(image, words, left + 10 * u, bottom - 9 * u, size, colour=palette.WHITE)
