"""Water, sky and haze, painted over what MuJoCo drew by the distance of every pixel.

The surface is a plane with the slopes of `swell.py`: it mirrors the sky, the sun and a second
picture of the harbour drawn from below, lets the quays and hulls shine through where they are not
deep, and carries the foam and trails of a `Sheet`.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.view.render.bands import in_bands
from mjforage.view.render.cameras import View
from mjforage.view.render.scenery import BEYOND, land_of
from mjforage.view.render.sheet import Sheet
from mjforage.view.render.surface import (
    BROAD,
    BROAD_SIZE,
    PATCH_M,
    PATCH_SIZE,
    Drawn,
    Spread,
    paint_surface,
)
from mjforage.view.render.swell import Swell

SLOPE = 0.10  # root mean square of the small waves
SHORE_M = 14.0  # water further from land than this is deep
_SHORE_TEXELS = 1536  # along the longer side, at most


def shore_of(
    navigable: NDArray[np.bool_], pitch_m: float, quays: NDArray[np.float32] | None = None
) -> Spread:
    """Distance to land [m] over the map, at most `SHORE_M`; land goes on beyond its edge."""
    finer = int(np.clip(_SHORE_TEXELS // (max(navigable.shape) + 2 * BEYOND), 1, 8))
    land = land_of(navigable, pitch_m, quays, finer)
    water = ~np.pad(land, BEYOND * finer, mode="edge")[::-1]
    texel_m, corner = pitch_m / finer, -(BEYOND + 0.5) * pitch_m
    if water.all():
        distance = np.full(water.shape, SHORE_M)
    else:
        distance = (ndimage.distance_transform_edt(water) - 0.5) * texel_m
    return Spread(np.clip(distance, 0.0, SHORE_M).astype(np.float32), corner, corner, texel_m)


class Water:
    """Paints the water of one harbour."""

    def __init__(self, shore: Spread) -> None:
        self._shore = shore
        self._small = Swell(PATCH_M, PATCH_SIZE, SLOPE)
        self._broad = Swell(PATCH_M, BROAD_SIZE, 0.55 * SLOPE)

    def paint(
        self,
        drawn: Drawn,
        mirror: Drawn,
        sheet: Sheet,
        view: View,
        surface_s: float,
    ) -> None:
        """Paint water, sky and haze into the picture drawn, row 0 on top.

        Parameters
        ----------
        mirror : the picture from below, upside down, in any size
        surface_s : time of the waves [s]
        """
        half = np.tan(0.5 * view.fov_rad)
        arguments = (
            drawn,
            mirror,
            Spread(sheet.texels, sheet.west, sheet.south, sheet.texel_m),
            self._shore,
            self._small.slopes(surface_s),
            self._broad.slopes(surface_s / np.sqrt(BROAD)),
            np.stack((view.eye, view.forward, view.right * half, view.up * half)),
        )
        in_bands(len(drawn.image), lambda first, end: paint_surface(*arguments, first, end))
