"""Anti-aliased shapes painted into 8-bit images, each by its signed distance in pixels.

Images are (height, width, channel) uint8 and are changed in place; a colour has a value for each
of the first channels. Points are (x, y) in pixels with pixel centres at halves. `alpha` is 0
(nothing) to 1 (opaque).
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel

Image = NDArray[np.uint8]  # (height, width, channel)
Floats = NDArray[np.float64]
Channels = tuple[float, ...]


@kernel
def _span(low: float, high: float, size: int) -> tuple[int, int]:
    """Pixels of an axis of `size` that [low, high] touches, as a half-open range."""
    return max(0, int(np.floor(low))), min(size, int(np.ceil(high)) + 1)


@kernel
def _blend(image: Image, y: int, x: int, colour: Channels, alpha: float) -> None:
    """Lay a colour over a pixel with an opacity from 0 to 1."""
    for channel in range(len(colour)):
        old = float(image[y, x, channel])
        image[y, x, channel] = np.uint8(old + (colour[channel] - old) * alpha + 0.5)


@kernel
def paint_rings(
    image: Image, points: Floats, radius: Floats, width: Floats, alpha: Floats, colour: Channels
) -> None:
    """Stroke circles of `radius` with line `width` [pixel]; arrays are (n,), `points` (n, 2)."""
    for i in range(points.shape[0]):
        x, y, reach = points[i, 0], points[i, 1], radius[i] + 0.5 * width[i] + 1.0
        first_row, last_row = _span(y - reach, y + reach, image.shape[0])
        first_column, last_column = _span(x - reach, x + reach, image.shape[1])
        for row in range(first_row, last_row):
            for column in range(first_column, last_column):
                distance = abs(np.hypot(column + 0.5 - x, row + 0.5 - y) - radius[i])
                cover = min(1.0, max(0.0, 0.5 * width[i] - distance + 0.5))
                if cover > 0.0:
                    _blend(image, row, column, colour, cover * alpha[i])


def paint_discs(
    image: Image, points: Floats, radius: Floats, alpha: Floats, colour: Channels
) -> None:
    """Fill discs; `radius` [pixel] and `alpha` are (n,), `points` (n, 2)."""
    paint_rings(image, points, 0.0 * radius, 2.0 * radius, alpha, colour)


@kernel
def _to_segment(x: float, y: float, start: Floats, end: Floats) -> tuple[float, float]:
    """Distance to a segment [pixel] and where along it, 0 at its start, 1 at its end."""
    along_x, along_y = end[0] - start[0], end[1] - start[1]
    square = along_x * along_x + along_y * along_y
    part = 0.0
    if square > 0.0:
        part = ((x - start[0]) * along_x + (y - start[1]) * along_y) / square
        part = min(1.0, max(0.0, part))
    return np.hypot(x - start[0] - part * along_x, y - start[1] - part * along_y), part


@kernel
def _polygon_distance(x: float, y: float, corners: Floats) -> float:
    """Signed distance to a simple polygon [pixel], negative inside; no side has length 0."""
    square, inside = np.inf, False
    for i in range(corners.shape[0]):
        ax, ay = corners[i - 1, 0], corners[i - 1, 1]
        along_x, along_y = corners[i, 0] - ax, corners[i, 1] - ay
        from_x, from_y = x - ax, y - ay
        part = (from_x * along_x + from_y * along_y) / (along_x * along_x + along_y * along_y)
        part = min(1.0, max(0.0, part))
        off_x, off_y = from_x - part * along_x, from_y - part * along_y
        square = min(square, off_x * off_x + off_y * off_y)
        if (from_y < 0.0) != (from_y < along_y) and from_x < from_y * along_x / along_y:
            inside = not inside
    nearest = float(np.sqrt(square))
    return -nearest if inside else nearest


@kernel
def paint_polygon(
    image: Image, corners: Floats, grow: float, softness: float, alpha: float, colour: Channels
) -> None:
    """Fill a polygon (n, 2) widened by `grow`, its edge blurred over `softness` >= 1 [pixel]."""
    reach = max(0.0, grow) + softness
    rows = _span(corners[:, 1].min() - reach, corners[:, 1].max() + reach, image.shape[0])
    columns = _span(corners[:, 0].min() - reach, corners[:, 0].max() + reach, image.shape[1])
    for row in range(rows[0], rows[1]):
        for column in range(columns[0], columns[1]):
            distance = _polygon_distance(column + 0.5, row + 0.5, corners) - grow
            cover = min(1.0, max(0.0, 0.5 - distance / softness))
            if cover > 0.0:
                _blend(image, row, column, colour, cover * alpha)


@kernel
def _stroke_cover(
    height: int, width_px: int, points: Floats, width: Floats, alpha: Floats, soft: float
) -> tuple[int, int, NDArray[np.float32]]:
    """Cover of each pixel by a polyline (n, 2), from a first row and column on.

    `width` [pixel] and `alpha` (n,) vary along it. Overlapping parts take the stronger cover, so
    joints and crossings do not darken. The cover falls to nothing over the part `soft` of the half
    width, or a pixel.
    """
    spread = 0.5 + 0.25 * soft
    reach = spread * width.max() + 1.0
    rows = _span(points[:, 1].min() - reach, points[:, 1].max() + reach, height)
    columns = _span(points[:, 0].min() - reach, points[:, 0].max() + reach, width_px)
    cover = np.zeros((max(0, rows[1] - rows[0]), max(0, columns[1] - columns[0])), np.float32)
    for i in range(points.shape[0] - 1):
        a, b = points[i], points[i + 1]
        reach = spread * max(width[i], width[i + 1]) + 1.0
        first_row, last_row = _span(min(a[1], b[1]) - reach, max(a[1], b[1]) + reach, rows[1])
        first, last = _span(min(a[0], b[0]) - reach, max(a[0], b[0]) + reach, columns[1])
        for row in range(first_row, last_row):
            for column in range(first, last):
                distance, part = _to_segment(column + 0.5, row + 0.5, a, b)
                half = 0.5 * (width[i] + part * (width[i + 1] - width[i]))
                strength = alpha[i] + part * (alpha[i + 1] - alpha[i])
                strength *= min(1.0, max(0.0, (half - distance) / max(1.0, soft * half) + 0.5))
                old = cover[row - rows[0], column - columns[0]]
                cover[row - rows[0], column - columns[0]] = max(old, np.float32(strength))
    return rows[0], columns[0], cover


@kernel
def paint_stroke(
    image: Image,
    points: Floats,
    width: Floats,
    alpha: Floats,
    colour: Channels,
    soft: float = 0.0,
) -> None:
    """Stroke a polyline (n, 2), see `_stroke_cover`."""
    top, left, cover = _stroke_cover(image.shape[0], image.shape[1], points, width, alpha, soft)
    for row in range(cover.shape[0]):
        for column in range(cover.shape[1]):
            if cover[row, column] > 0.0:
                _blend(image, row + top, column + left, colour, cover[row, column])


@kernel
def paint_box(
    image: Image,
    box: tuple[float, float, float, float],
    radius: float,
    line: float,
    alpha: float,
    colour: Channels,
) -> None:
    """Fill the rounded rectangle (left, top, right, bottom), or stroke it where `line` > 0."""
    left, top, right, bottom = box
    rows = _span(top - line - 1.0, bottom + line + 1.0, image.shape[0])
    columns = _span(left - line - 1.0, right + line + 1.0, image.shape[1])
    for row in range(rows[0], rows[1]):
        for column in range(columns[0], columns[1]):
            over_x = abs(column + 0.5 - 0.5 * (left + right)) - 0.5 * (right - left) + radius
            over_y = abs(row + 0.5 - 0.5 * (top + bottom)) - 0.5 * (bottom - top) + radius
            outside = np.hypot(max(over_x, 0.0), max(over_y, 0.0))
            distance = outside + min(max(over_x, over_y), 0.0) - radius
            if line > 0.0:
                distance = abs(distance) - 0.5 * line
            cover = min(1.0, max(0.0, 0.5 - distance))
            if cover > 0.0:
                _blend(image, row, column, colour, cover * alpha)


@kernel
def paint_mask(
    image: Image, mask: NDArray[np.uint8], left: int, top: int, colour: Channels
) -> None:
    """Blend `colour` where the 8-bit `mask` (height, width), placed at (left, top), is set."""
    for row in range(max(0, -top), min(mask.shape[0], image.shape[0] - top)):
        for column in range(max(0, -left), min(mask.shape[1], image.shape[1] - left)):
            if mask[row, column] > 0:
                _blend(image, row + top, column + left, colour, mask[row, column] / 255.0)
