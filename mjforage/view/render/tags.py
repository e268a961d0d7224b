"""Names of vessels over a picture."""

import numpy as np

from mjforage.view.render import palette
from mjforage.view.render.palette import Colour
from mjforage.view.render.panel import DARK, text_size
from mjforage.view.render.raster import Floats, Image, paint_box
from mjforage.view.render.text import width, write

_COVER = 0.5  # of the plate behind a name: what floats below it is seen through it


class Tags:
    """Writes names into pictures `wide` pixels wide."""

    def __init__(
        self, labels: tuple[str, ...], colours: list[Colour], wide: int, unit: float
    ) -> None:
        self._labels, self._colours = labels, colours
        self._width, self._unit = wide, unit

    def paint(self, image: Image, places: Floats, radius: Floats) -> None:
        """Write names above vessels, none over another or over another vessel.

        Parameters
        ----------
        places : (agent, 2) middles of vessels in the picture [pixel]; not numbers get no name
        radius : (agent,) that they reach from there [pixel]
        """
        visible = np.asarray(np.isfinite(places).all(axis=1))
        low, high = places - radius[:, None], places + radius[:, None]
        occupied = [tuple(box) for box in np.column_stack((low, high))[visible].tolist()]
        for number, (x, y) in enumerate(places.tolist()):
            if visible[number]:
                words = self._labels[number]
                box = self._free_box(x, y - radius[number] - 2.0 * self._unit, words, occupied)
                occupied.append(box)
                self._paint_tag(image, box, words, self._colours[number])

    def _free_box(
        self, x: float, y: float, words: str, occupied: list[tuple[float, float, float, float]]
    ) -> tuple[float, float, float, float]:
        """Room for a tag above a point, higher up where others are in the way."""
        u = self._unit
        wide, high = width(words, text_size(self._unit, 12.5), bold=True) + 15 * u, 18 * u
        left = min(max(x - 0.5 * wide, 2.0), self._width - wide - 2.0)
        top = y - high
        for other in sorted(occupied, key=lambda box: -box[1]):
            beside = left >= other[2] or other[0] >= left + wide
            above = top >= other[3] + 2 * u or other[1] >= top + high + 2 * u
            if not beside and not above:
                top = other[1] - high - 2 * u
        top = max(top, 4 * u)
        return left, top, left + wide, top + high

    def _paint_tag(
        self, image: Image, box: tuple[float, float, float, float], words: str, colour: Colour
    ) -> None:
        u, (left, top, _, _) = self._unit, box
        paint_box(image, box, 5 * u, 0.0, _COVER, DARK)
        rim = (left + 3 * u, top + 3 * u, left + 8 * u, top + 15 * u)
        paint_box(image, rim, 2.5 * u, 0.0, 0.9, palette.WHITE)
        stripe = (left + 4 * u, top + 4 * u, left + 7 * u, top + 14 * u)
        paint_box(image, stripe, 1.5 * u, 0.0, 1.0, colour)
        base = top + 13.5 * u
        size = text_size(u, 12.5)
        write(image, words, left + 11 * u, base, size, bold=True, colour=palette.WHITE)
