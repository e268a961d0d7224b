"""The legend: every sign of the map, drawn by the same functions as on the map."""

from collections.abc import Sequence

import numpy as np

from mjforage.view.render import palette, symbols
from mjforage.view.render.frame_layout import LEGEND_ROW, PANEL_WIDTH, Layout
from mjforage.view.render.links import paint_link, paint_lost
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Floats, Image, paint_box, paint_rings
from mjforage.view.render.text import fit, write

_TEXT_LEFT = 46.0  # [unit]


class Legend:
    """Writes rows downwards from a corner of the panel; painted once per replay."""

    def __init__(self, image: Image, corner: tuple[float, float], layout: Layout) -> None:
        self._image, self._layout = image, layout
        self._left, self._y = corner[0], corner[1] + 13 * layout.unit
        self._mark_x = corner[0] + 17 * layout.unit

    def _row(self, text: str) -> None:
        u, size = self._layout.unit, self._layout.size(13)
        label = fit(text, size, (PANEL_WIDTH - _TEXT_LEFT) * u)
        write(self._image, label, self._left + _TEXT_LEFT * u, self._y + 4.5 * u, size)
        self._y += LEGEND_ROW * u

    def _water(self) -> None:
        """Lay a patch of water under a sign, as its colours are made for water."""
        u = self._layout.unit
        patch = (self._left, self._y - 10.5 * u, self._left + 34 * u, self._y + 10.5 * u)
        paint_box(self._image, patch, 5 * u, 0.0, 1.0, palette.CLEAR_DEEP)

    def team(self, name: str, collects: bool, colours: Sequence[Colour]) -> None:
        """Two rows: hulls of a team, two at most, and its view."""
        self._water()
        u, (length, apart) = self._layout.unit, (20.0, 0.0) if len(colours) == 1 else (15.0, 8.0)
        for colour, shift in zip(colours[:2], (-apart, apart), strict=False):
            place = np.array([self._mark_x - 1.0 + shift * u, self._y])
            symbols.paint_hull(self._image, place, 0.0, length * u, collects, colour)
        self._row(f"{name} ({len(colours)})")
        self._water()
        box = (self._mark_x - 11 * u, self._y - 6.5 * u, self._mark_x + 11 * u, self._y + 6.5 * u)
        role = palette.FORAGER if collects else palette.SCOUT
        paint_box(self._image, box, 6 * u, 0.0, 0.16, role)
        paint_box(self._image, box, 6 * u, 1.6 * u, 0.85, role)
        self._row(f"in view of {name}")

    def items(self, most: int) -> None:
        """Rows for items, discovered or not, beliefs up to `most` a node, and a collection."""
        u, one = self._layout.unit, np.ones(1)
        dot = 4.0 * u
        for known, text in ((True, "item, discovered"), (False, "item, not yet discovered")):
            self._water()
            symbols.paint_items(self._image, self._mark(), one, dot, known=known)
            self._row(text)
        self._water()
        for count, shift in ((1, -11.3), (2, 0.0), (most, 11.3)):
            place, number = self._mark(shift * u), np.array([count])
            symbols.paint_believed(self._image, place, number, one, 11.3 * u, most)
        self._row(f"items believed here: 1, 2, {most}")
        self._water()
        for wide, colour in ((3.6, palette.ITEM_RIM), (2.0, palette.ITEM)):
            paint_rings(self._image, self._mark(), 8.0 * u * one, wide * u * one, one, colour)
        self._row("item just collected")

    def links(self, collects: bool, colour: Colour) -> None:
        """Rows for contacts, lost looks, and a vessel of a team where it was last heard of."""
        u = self._layout.unit
        for paint, text in ((paint_link, "in contact"), (paint_lost, "looks lost in this step")):
            self._water()
            paint(self._image, np.concatenate((self._mark(-14 * u), self._mark(14 * u))), u)
            self._row(text)
        self._water()
        place = np.array([self._mark_x - 1.0, self._y])
        symbols.paint_ghost(self._image, place, 0.0, 20.0 * u, collects, colour)
        self._row("last heard of here, how long ago")

    def _mark(self, shift: float = 0.0) -> Floats:
        return np.array([[self._mark_x + shift, self._y]])

    def idleness(self) -> None:
        """Row with the scale of the veil, from just seen to idle."""
        u = self._layout.unit
        y0, y1 = round(self._y - 8 * u), round(self._y + 8 * u)
        x0, x1 = round(self._left), round(self._left + 110 * u)
        part = np.linspace(0.0, 1.0, x1 - x0)[:, None]
        clear, hazy = np.array(palette.CLEAR_DEEP), np.array(palette.HAZY_DEEP)
        self._image[y0:y1, x0:x1] = np.rint(clear + (hazy - clear) * part).astype(np.uint8)
        size = self._layout.size(13)
        write(self._image, "idleness 0 to 1", x1 + 12 * u, self._y + 4.5 * u, size)
        self._y += LEGEND_ROW * u

    def scale_bar(self, pitch_m: float) -> None:
        """Row with a bar of a round number of metres."""
        u = self._layout.unit
        metre = self._layout.scale / pitch_m  # [pixel/m]
        length_m = round_length(150 * u / metre)
        x0, x1 = self._left, self._left + length_m * metre
        for box in (
            (x0, self._y - 1 * u, x1, self._y + 1 * u),
            (x0, self._y - 5 * u, x0 + 2 * u, self._y + 5 * u),
            (x1 - 2 * u, self._y - 5 * u, x1, self._y + 5 * u),
        ):
            paint_box(self._image, box, 0.0, 0.0, 1.0, palette.INK)
        size = self._layout.size(13)
        write(self._image, f"{length_m:g} m", x1 + 12 * u, self._y + 4.5 * u, size)
        self._y += LEGEND_ROW * u


def round_length(most: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten that is at most `most`."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= most))
