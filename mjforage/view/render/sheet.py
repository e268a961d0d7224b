"""What lies on the water, as a picture in world coordinates: foam, trails, halos, shadows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.view.render.cameras import Area
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import span, stroke_cover, to_segment

Floats = NDArray[np.float64]
FOAM = 4  # channel of foam; 0 to 2 are colour times cover, 3 is cover
MOST_TEXELS = 1024  # along the longer side


@dataclass(frozen=True, eq=False)
class Sheet:
    """A square grid over part of the water.

    Attributes
    ----------
    texels : (row, column, 5) float32 red, green, blue in 0..255 times cover, cover, foam 0..1;
        row 0 is southernmost
    west, south : corner [m]
    texel_m : side of a texel
    """

    texels: NDArray[np.float32]
    west: float
    south: float
    texel_m: float

    def places(self, xy: Floats) -> Floats:
        """(n, 2) points [m] as texel coordinates (x, y), texel centres at halves."""
        return np.ascontiguousarray((xy - (self.west, self.south)) / self.texel_m)

    def foam(self, xy: Floats, width_m: Floats, strength: Floats) -> None:
        """Lay foam along a line (n, 2); overlapping foam keeps the stronger."""
        if len(xy) > 1:
            _lay_foam(self.texels, self.places(xy), width_m / self.texel_m, strength)

    def stroke(self, xy: Floats, width_m: Floats, alpha: Floats, colour: Colour) -> None:
        """Paint a line (n, 2) over what is there."""
        if len(xy) > 1:
            _lay_stroke(self.texels, self.places(xy), width_m / self.texel_m, alpha, colour)

    def rings(
        self, xy: Floats, radius_m: Floats, width_m: Floats, alpha: Floats, colour: Colour
    ) -> None:
        """Paint circles around points (n, 2); radius, line width and alpha are (n,)."""
        one = 1.0 / self.texel_m
        _lay_rings(self.texels, self.places(xy), radius_m * one, width_m * one, alpha, colour)


def blank_sheet(area: Area, finest_m: float) -> Sheet:
    """An empty sheet over an area, its texels `finest_m` or as fine as `MOST_TEXELS` allow."""
    longer = max(area.east - area.west, area.north - area.south)
    texel_m = max(finest_m, longer / MOST_TEXELS)
    west, south = (np.floor(edge / texel_m) * texel_m for edge in (area.west, area.south))
    shape = (
        int(np.ceil((area.north - south) / texel_m)),
        int(np.ceil((area.east - west) / texel_m)),
    )
    return Sheet(np.zeros((*shape, 5), np.float32), float(west), float(south), texel_m)


@kernel
def _lay_foam(texels: NDArray[np.float32], points: Floats, width: Floats, strength: Floats) -> None:
    """Foam fades to the sides of its line."""
    for i in range(points.shape[0] - 1):
        a, b = points[i], points[i + 1]
        reach = 0.5 * max(width[i], width[i + 1], 1.5)
        rows = span(min(a[1], b[1]) - reach, max(a[1], b[1]) + reach, texels.shape[0])
        columns = span(min(a[0], b[0]) - reach, max(a[0], b[0]) + reach, texels.shape[1])
        for row in range(rows[0], rows[1]):
            for column in range(columns[0], columns[1]):
                distance, part = to_segment(column + 0.5, row + 0.5, a, b)
                half = 0.5 * max(1.5, width[i] + part * (width[i + 1] - width[i]))
                side = distance / half
                if side < 1.0:
                    value = strength[i] + part * (strength[i + 1] - strength[i])
                    value *= (1.0 - side * side) ** 2
                    texels[row, column, FOAM] = max(texels[row, column, FOAM], np.float32(value))


@kernel
def _over(texels: NDArray[np.float32], row: int, column: int, colour: Colour, alpha: float) -> None:
    """Lay a colour over a texel of premultiplied colour and opacity."""
    left = 1.0 - alpha
    for channel in range(3):
        old = texels[row, column, channel] * left
        texels[row, column, channel] = np.float32(old + colour[channel] * alpha)
    texels[row, column, 3] = np.float32(texels[row, column, 3] * left + alpha)


@kernel
def _lay_stroke(
    texels: NDArray[np.float32], points: Floats, width: Floats, alpha: Floats, colour: Colour
) -> None:
    """Lay a stroke of changing width and opacity over the texels."""
    top, left, cover = stroke_cover(texels.shape[0], texels.shape[1], points, width, alpha)
    for row in range(cover.shape[0]):
        for column in range(cover.shape[1]):
            if cover[row, column] > 0.0:
                _over(texels, row + top, column + left, colour, cover[row, column])


@kernel
def _lay_rings(
    texels: NDArray[np.float32],
    points: Floats,
    radius: Floats,
    width: Floats,
    alpha: Floats,
    colour: Colour,
) -> None:
    """Lay rings over the texels; `radius` and `width` are in texels, one each per point."""
    for i in range(points.shape[0]):
        x, y, reach = points[i, 0], points[i, 1], radius[i] + width[i] + 1.0
        rows = span(y - reach, y + reach, texels.shape[0])
        columns = span(x - reach, x + reach, texels.shape[1])
        for row in range(rows[0], rows[1]):
            for column in range(columns[0], columns[1]):
                distance = abs(np.hypot(column + 0.5 - x, row + 0.5 - y) - radius[i])
                cover = min(1.0, max(0.0, 0.5 * width[i] - distance + 0.5))
                if cover > 0.0:
                    _over(texels, row, column, colour, cover * alpha[i])
