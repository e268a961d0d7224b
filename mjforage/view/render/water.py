"""Water, sky and haze, painted over what MuJoCo drew by the distance of every pixel.

The surface is a plane with the slopes of `swell.py`: it mirrors the sky, the sun and a second
picture of the harbour drawn from below, lets the quays and hulls shine through where they are not
deep, and carries the foam and trails of a `Sheet`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.view.render.bands import in_bands
from mjforage.view.render.cameras import View
from mjforage.view.render.harbour import PaddedLand
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

Image = NDArray[np.uint8]
Field = NDArray[np.float32]
SLOPE = 0.10  # root mean square of the small waves
SHORE_M = 14.0  # water further from land than this is deep
_SHORE_TEXELS = 1536  # along the longer side, at most


@dataclass(frozen=True, eq=False)
class Shore:
    """Distance to land (row, column) [m], at most `SHORE_M`; row 0 southernmost."""

    distance: Field
    west: float
    south: float
    texel_m: float


def shore_of(ground: PaddedLand) -> Shore:
    """Measure the water of a harbour."""
    finer = int(np.clip(_SHORE_TEXELS // max(ground.land.shape), 1, 8))
    water = np.repeat(np.repeat(~ground.land[::-1], finer, axis=0), finer, axis=1)
    texel_m = ground.pitch_m / finer
    if water.all():
        distance = np.full(water.shape, SHORE_M)
    else:
        distance = (ndimage.distance_transform_edt(water) - 0.5) * texel_m
    corner = ground.x(np.array(0)), ground.y(np.array(len(ground.land)))
    near = np.clip(distance, 0.0, SHORE_M).astype(np.float32)
    return Shore(near, float(corner[0]), float(corner[1]), texel_m)


class Water:
    """Paints the water of one harbour."""

    def __init__(self, shore: Shore) -> None:
        self._shore = shore
        self._small = Swell(PATCH_M, PATCH_SIZE, SLOPE)
        self._broad = Swell(PATCH_M, BROAD_SIZE, 0.55 * SLOPE)

    def paint(
        self,
        image: Image,
        ahead: Field,
        mirror: Image,
        mirror_ahead: Field,
        sheet: Sheet,
        view: View,
        surface_s: float,
    ) -> None:
        """Paint water, sky and haze into `image` (h, w, 3), row 0 on top.

        Parameters
        ----------
        ahead : (h, w) distance along the view [m], infinite where MuJoCo drew nothing
        mirror, mirror_ahead : the same from below, upside down, in any size
        surface_s : time of the waves [s]
        """
        shore = self._shore
        half = np.tan(0.5 * view.fov_rad)
        arguments = (
            Drawn(image, ahead),
            Drawn(mirror, mirror_ahead),
            Spread(sheet.texels, sheet.west, sheet.south, sheet.texel_m),
            Spread(shore.distance, shore.west, shore.south, shore.texel_m),
            self._small.slopes(surface_s),
            self._broad.slopes(surface_s / np.sqrt(BROAD)),
            np.stack((view.eye, view.forward, view.right * half, view.up * half)),
        )
        in_bands(len(image), lambda first, end: paint_surface(*arguments, first, end))
