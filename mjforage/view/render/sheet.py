"""Picture of marks on the water, in world coordinates: foam, trails, halos, shadows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mjforage.view.render.cameras import Area
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import paint_rings, paint_stroke

Floats = NDArray[np.float64]
FOAM = 4  # channel of foam; 0 to 2 are colour times cover, 3 is cover
MOST_TEXELS = 1024  # along the longer side
_SOFT_FOAM = 1.3  # foam fades to its sides over such a part of its half width


@dataclass(frozen=True, eq=False)
class Sheet:
    """A square grid over part of the water.

    Attributes
    ----------
    texels : (row, column, 5) uint8 red, green and blue times cover, cover, foam; row 0 southernmost
    west, south : corner [m]
    texel_m : side of a texel
    """

    texels: NDArray[np.uint8]
    west: float
    south: float
    texel_m: float

    @classmethod
    def blank(cls, area: Area, finest_m: float) -> "Sheet":
        """An empty sheet, its texels `finest_m` or as fine as `MOST_TEXELS` allow."""
        longer = max(area.east - area.west, area.north - area.south)
        texel_m = max(finest_m, longer / MOST_TEXELS)
        west, south = (np.floor(np.array((area.west, area.south)) / texel_m) * texel_m).tolist()
        rows, columns = np.ceil(np.array((area.north - south, area.east - west)) / texel_m)
        return cls(np.zeros((int(rows), int(columns), 5), np.uint8), west, south, texel_m)

    def _places(self, xy: Floats) -> Floats:
        """(n, 2) points [m] as texel coordinates (x, y), texel centres at halves."""
        return np.ascontiguousarray((xy - (self.west, self.south)) / self.texel_m)

    def foam(self, xy: Floats, width_m: Floats, strength: Floats) -> None:
        """Lay foam along a line (n, 2)."""
        if len(xy) > 1:
            width = np.maximum(1.5, width_m / self.texel_m) / (1.0 + 0.5 * _SOFT_FOAM)
            foam = self.texels[..., FOAM:]
            paint_stroke(foam, self._places(xy), width, strength, (255.0,), _SOFT_FOAM)

    def stroke(self, xy: Floats, width_m: Floats, alpha: Floats, colour: Colour) -> None:
        """Paint a line (n, 2) over the picture."""
        if len(xy) > 1:
            width, paint = width_m / self.texel_m, (*colour, 255.0)
            paint_stroke(self.texels, self._places(xy), width, alpha, paint)

    def rings(
        self, xy: Floats, radius_m: Floats, width_m: Floats, alpha: Floats, colour: Colour
    ) -> None:
        """Paint circles around points (n, 2); radius, line width and alpha are (n,)."""
        radius, width = radius_m / self.texel_m, width_m / self.texel_m
        paint_rings(self.texels, self._places(xy), radius, width, alpha, (*colour, 255.0))
