"""Places of pictures and panel in a frame that shows one episode, or two side by side."""

from typing import NamedTuple

_FULL_HEIGHT, _FULL_WIDTH = 720.0, 1080.0  # of a frame in which a unit is a pixel
_LEAST_UNIT = 0.74
_LINE_WIDTH, _LINE_HEIGHT = 560, 340  # smaller frames have room for one line of words only
_LINE = 23  # [pixel]
_COLUMN, _STRIP, _HEAD = 286.0, 186.0, 34.0  # [unit]
_BETWEEN = 4.0  # two pictures [unit]
PAD, GAP = 18.0, 14.0  # [unit]
SIGN_ROW = 22.0  # [unit]
_CLOCK, _SHARES, _NOTES = 44.0, 88.0, 54.0  # heights [unit]
_CHART, _SCORE, _MIDDLE = 130.0, 150.0, 330.0  # least widths in a strip [unit]


class Box(NamedTuple):
    """A rectangle of a frame [pixel]."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def width(self) -> float:
        """Width from left to right."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Height from top to bottom."""
        return self.bottom - self.top


class Score(NamedTuple):
    """Boxes of the panel's parts about one episode."""

    shares: Box
    notes: Box
    chart: Box | None = None


class Layout(NamedTuple):
    """Boxes of a frame; `unit` is the pixel size of everything in the panel."""

    unit: float
    pictures: tuple[Box, ...]  # whole pixels, one per episode
    heads: tuple[Box, ...]  # of each episode; the only words of a brief frame
    scores: tuple[Score, ...] = ()
    clock: Box | None = None
    signs: Box | None = None


def unit_of(width: int, height: int) -> float:
    """Pixels per unit in a frame of that size."""
    return max(_LEAST_UNIT, min(height / _FULL_HEIGHT, width / _FULL_WIDTH))


def is_brief(width: float, height: float) -> bool:
    """True for a frame that has room for one line of words only."""
    return width < _LINE_WIDTH or height < _LINE_HEIGHT


def frame_layout(
    width: int, height: int, episodes: int, shape: float | None, signs: int, charted: bool
) -> Layout:
    """Share a frame so that the pictures show most.

    Parameters
    ----------
    width, height : of the frame [pixel]
    episodes : 1 or 2
    shape : width by height of what a picture has to show; None if it fills any picture
    signs : rows that the explanation of signs takes in one column
    charted : True if the panel has charts
    """
    unit = unit_of(width, height)
    column, below = round(_COLUMN * unit), height - round((_STRIP + _HEAD) * unit)
    beside = width - column
    if is_brief(width if episodes == 1 else 0.75 * width, height):
        pictures = _pictures(width, min(_LINE, height // 3), height, episodes, unit)
        return Layout(unit, pictures, _heads(pictures))
    wide = (
        width >= height
        if shape is None
        else min(beside / shape, height) >= min(width / shape, below)
    )
    if episodes == 1 and wide:
        panel, picture = Box(0, 0, column, height), Box(column, 0, width, height)
        return _column(panel, picture, unit, signs, charted)
    return _strip(width, height, episodes, unit, charted)


def _pictures(width: int, top: int, bottom: int, episodes: int, unit: float) -> tuple[Box, ...]:
    """Boxes between two rows; of odd widths the right one has one pixel more."""
    if episodes == 1:
        return (Box(0, top, width, bottom),)
    gap = max(2, 2 * round(0.5 * _BETWEEN * unit))
    left = (width - gap) // 2
    return Box(0, top, left, bottom), Box(left + gap, top, width, bottom)


def _heads(pictures: tuple[Box, ...]) -> tuple[Box, ...]:
    return tuple(box._replace(top=0.0, bottom=box.top) for box in pictures)


def _column(panel: Box, picture: Box, u: float, signs: int, charted: bool) -> Layout:
    """A panel left of one picture: head, clock, shares, signs, chart and notes below each other."""
    left, right, bottom = panel.left + PAD * u, panel.right - PAD * u, panel.bottom - PAD * u
    clock = Box(left, panel.top + (PAD + 30.0) * u, right, panel.top + (PAD + 30.0 + _CLOCK) * u)
    shares = Box(left, clock.bottom, right, clock.bottom + _SHARES * u)
    rows = Box(left, shares.bottom + GAP * u, right, shares.bottom + (GAP + signs * SIGN_ROW) * u)
    notes = Box(left, bottom - _NOTES * u, right, bottom)
    chart = Box(left, rows.bottom + GAP * u, right, notes.top - GAP * u)
    roomy = chart.height > _SCORE * u if charted else rows.bottom < notes.top
    if not roomy:
        chart = chart._replace(top=rows.top)
    head = Box(panel.left + 8.0 * u, panel.top + 8.0 * u, panel.right - 8.0 * u, clock.top)
    score = Score(shares, notes, chart if charted else None)
    return Layout(u, (picture,), (head,), (score,), clock, rows if roomy else None)


def _strip(width: int, height: int, episodes: int, u: float, charted: bool) -> Layout:
    """Heads above the pictures, and below them scores with charts around clock and signs."""
    strip = height - round(_STRIP * u)
    pictures = _pictures(width, round(_HEAD * u), strip, episodes, u)
    left, right, top, bottom = PAD * u, width - PAD * u, strip + PAD * u, height - PAD * u
    needed = episodes * (_CHART + _SCORE + 3 * GAP) + _MIDDLE
    edge = (_CHART + GAP) * u if charted and right - left > needed * u else 0.0
    inner = right - left - episodes * edge
    wide = min(250.0 * u, (inner - _MIDDLE * u) / episodes - 2 * GAP * u)
    wide = max(wide, 0.28 * inner)
    scores = []
    for x, chart in ((left + edge, left), (right - edge - wide, right - _CHART * u))[:episodes]:
        shares = Box(x, top, x + wide, top + _SHARES * u)
        notes = Box(x, bottom - _NOTES * u, x + wide, bottom)
        room_of = Box(chart, top - 8.0 * u, chart + _CHART * u, bottom + 6.0 * u)
        scores.append(Score(shares, notes, room_of if edge else None))
    end = scores[1].shares.left - 2 * GAP * u if episodes == 2 else right
    clock = Box(scores[0].shares.right + 2 * GAP * u, top, end, top + _CLOCK * u)
    signs = clock._replace(top=clock.bottom + 10.0 * u, bottom=bottom)
    return Layout(u, pictures, _heads(pictures), tuple(scores), clock, signs)
