"""Links between vessels: pairs in contact, and contacts that lost scans."""

import numpy as np

from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.raster import Floats, Image, paint_stroke
from mjforage.view.render.text import write

_DASH, _GAP = 6.0, 4.0  # of a link that lost scans [unit]
_COUNT_SIZE, _COUNT_AWAY = 12.0, 12.0  # of the count beside it [unit]


def paint_links(
    image: Image,
    recording: Recording,
    step: int,
    points: Floats,
    unit: float,
    colour: palette.Colour = palette.INK,
) -> None:
    """Paint a line between all in contact, broken and red where scans were lost in the step.

    `points`: (agent, 2) where vessels are [pixel]; `unit`: width of a fine line [pixel].
    """
    if recording.knowledge is None:
        return
    linked, lost = recording.knowledge.linked[step], recording.knowledge.lost[step]
    for i, j in np.argwhere(np.triu(linked)):
        if lost[i, j] + lost[j, i]:
            paint_lost(image, points[[i, j]], unit)
        else:
            paint_link(image, points[[i, j]], unit, colour)


def paint_link(
    image: Image, ends: Floats, unit: float, colour: palette.Colour = palette.INK
) -> None:
    """Paint one contact from end to end (2, 2) [pixel]."""
    paint_stroke(image, ends, np.full(2, 1.1 * unit), np.full(2, 0.6), colour)


def paint_lost(image: Image, ends: Floats, unit: float) -> None:
    """Paint one contact that lost scans."""
    long = max(float(np.hypot(*(ends[1] - ends[0]))), 1e-9)
    for first in np.arange(0.0, long, (_DASH + _GAP) * unit):
        part = np.array([first, min(first + _DASH * unit, long)])[:, None] / long
        dash = np.ascontiguousarray(ends[0] + part * (ends[1] - ends[0]))
        paint_stroke(image, dash, np.full(2, 2.2 * unit), np.full(2, 0.95), palette.LOST)


def write_lost(image: Image, recording: Recording, step: int, points: Floats, unit: float) -> None:
    """Write the number of scans lost, beside the middle of each link."""
    if recording.knowledge is None:
        return
    lost = recording.knowledge.lost[step]
    for i, j in np.argwhere(np.triu(lost + lost.T, 1)):
        (x, y), (along_x, along_y) = points[[i, j]].mean(axis=0), points[j] - points[i]
        away = _COUNT_AWAY * unit / max(float(np.hypot(along_x, along_y)), 1e-9)
        away *= -1.0 if along_y < 0.0 else 1.0  # to the right of the link
        at = x + away * along_y, y - away * along_x + 0.35 * _COUNT_SIZE * unit
        text, size = f"−{lost[i, j] + lost[j, i]}", max(9, round(_COUNT_SIZE * unit))
        write(image, text, *at, size, bold=True, colour=palette.LOST, align="middle")
