"""The ground of a chart: quays, and water by its idleness with the areas in view over it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage
from scipy import ndimage

from mjforage.base.compiled import inlined, kernel
from mjforage.runs.episode_recording import Recording
from mjforage.view.render import palette
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Image

Field = NDArray[np.float32]
Bools = NDArray[np.bool_]
SCOUT_VIEW, FORAGER_VIEW = 1, 2  # bits of Recording.in_view
VIEW_FILL, VIEW_LINE = 0.3, 0.9  # opacity
_REACH = 3.0  # views are outlined up to this distance [node]
_KERB, _SHALLOW = 0.2, 1.5  # widths along the water line [node]
_SMOOTH = 0.7  # deviation [node]


class Ground(NamedTuple):
    """Constant part of a chart (height, width); colours are 0..255."""

    land: Field  # (height, width, 3)
    clear: Field  # (height, width, 3) water of idleness 0
    hazy: Field  # (height, width, 3) water of idleness 1
    water: Field  # (height, width) cover, 0..1

    @classmethod
    def of(cls, navigable: Bools, width: int, height: int) -> "Ground":
        """Paint the ground of a map (row, column), its corners rounded."""
        scale, wet = width / navigable.shape[1], navigable.astype(np.float32)
        shore = resized(wet, width, height) - 0.5  # about the distance to the water line [node]
        kerb = np.clip((_KERB + shore) * scale + 0.5, 0.0, 1.0)
        blurred = ndimage.gaussian_filter(wet, _SHALLOW, mode="nearest")
        deep = np.clip(2.0 * resized(blurred, width, height) - 1.0, 0.0, 1.0)
        return cls(
            _mixed(palette.QUAY, palette.QUAY_EDGE, kerb),
            _mixed(palette.CLEAR_SHALLOW, palette.CLEAR_DEEP, deep),
            _mixed(palette.HAZY_SHALLOW, palette.HAZY_DEEP, deep),
            np.clip(shore * scale + 0.5, 0.0, 1.0),
        )


def resized(field: Field, width: int, height: int) -> Field:
    """A field of nodes (row, column) as one of pixels, interpolated smoothly."""
    picture = PilImage.fromarray(np.ascontiguousarray(field))
    return np.array(picture.resize((width, height), PilImage.Resampling.BICUBIC))


def _mixed(first: Colour, second: Colour, part: Field) -> Field:
    low, high = np.array(first, np.float32), np.array(second, np.float32)
    mixed: Field = low + (high - low) * part[..., None]
    return mixed


def fields_at(recording: Recording, step: int) -> Field:
    """(3, row, column) idleness, and signed distances to the views of scouts and foragers [node].

    Distances are negative inside and at most `_REACH`. Land takes the value of the nearest water;
    idleness and the wide views of scouts are smoothed.
    """
    land = ~recording.navigable
    nearest = ndimage.distance_transform_edt(land, return_distances=False, return_indices=True)
    view = recording.in_view[step][tuple(nearest)]
    idleness = recording.idleness[step].astype(np.float32)[tuple(nearest)]
    scouts, foragers = (_edge_distance((view & bit) != 0) for bit in (SCOUT_VIEW, FORAGER_VIEW))
    smooth = (ndimage.gaussian_filter(one, _SMOOTH, mode="nearest") for one in (idleness, scouts))
    return np.stack((*smooth, foragers))


def _edge_distance(inside: Bools) -> Field:
    if not inside.any():
        return np.full(inside.shape, _REACH, np.float32)
    padded = np.pad(inside, 1)  # a view ends with the map
    within = ndimage.distance_transform_edt(padded)[1:-1, 1:-1]
    outside = ndimage.distance_transform_edt(~inside)
    signed = np.where(inside, 0.5 - within, outside - 0.5)
    return np.clip(signed, -_REACH, _REACH).astype(np.float32)


@inlined
def _over(value: float, colour: float, cover: float) -> float:
    return value + (colour - value) * cover


@inlined
def _within(pixels: float) -> float:
    """Cover of a pixel `pixels` from an edge, negative inside."""
    return min(1.0, max(0.0, 0.5 - pixels))


@kernel
def paint_ground(image: Image, ground: Ground, fields: Field, pixels: float, line: float) -> None:
    """Paint land, and water by idleness with the views over it.

    Parameters
    ----------
    fields : (3, height, width) as of `fields_at`
    pixels : per node
    line : half the width of a view's outline [pixel]
    """
    land, clear, hazy, water = ground.land, ground.clear, ground.hazy, ground.water
    colours = (palette.SCOUT, palette.FORAGER)
    tints = (0.15, 0.55)
    for i in range(image.shape[0]):
        for j in range(image.shape[1]):
            wet, idle = water[i, j], min(1.0, max(0.0, fields[0, i, j]))
            for k in range(3):
                value = _over(clear[i, j, k], hazy[i, j, k], idle)
                for team in range(2):
                    off, colour = fields[team + 1, i, j] * pixels, colours[team][k]
                    tint = 255.0 + (colour - 255.0) * tints[team]
                    value = _over(value, tint, VIEW_FILL * _within(off))
                    value = _over(value, colour, VIEW_LINE * _within(abs(off) - line))
                image[i, j, k] = np.uint8(_over(land[i, j, k], value, wet) + 0.5)
