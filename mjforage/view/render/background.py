"""The part of the map that never changes: water, clear and hazy, and quays."""

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage
from scipy import ndimage

from mjforage.view.render import palette
from mjforage.view.render.frame_layout import Layout
from mjforage.view.render.raster import Image

Field = NDArray[np.float32]  # (height, width)
_SUPERSAMPLING = 2
_TEXTURE_SEED = 7


class Background(NamedTuple):
    """Two pictures of the map that differ only in the state of the water."""

    clear: Image  # (height, width, 3) idleness 0
    hazy: Image  # (height, width, 3) idleness 1
    water: Field  # (height, width) cover of water, 0..1
    open_water: Field  # (height, width) 0 at a quay, 1 a little away from it


def paint_background(navigable: NDArray[np.bool_], layout: Layout) -> Background:
    """Paint the map (row, column) at the size of the layout's map area, or take it as it was."""
    return painted_background(navigable.tobytes(), navigable.shape, layout)


@lru_cache(maxsize=2)
def painted_background(cells: bytes, shape: tuple[int, ...], layout: Layout) -> Background:
    """The same for the bytes of a map; nothing that hangs on time is in it, so one serves all."""
    navigable = np.frombuffer(cells, np.bool_).reshape(shape)
    depth = _quay_distance(navigable, layout)  # positive in water, negative on quays
    scale = layout.scale * _SUPERSAMPLING
    water = np.clip(depth + 0.5, 0.0, 1.0)
    shade = 1.0 - 0.34 * _shadow(water, scale)
    light = 1.0 + _texture(water.shape, scale)
    tint = np.clip(1.0 - np.exp(-np.maximum(depth, 0.0) / (2.2 * scale)), 0.0, 1.0)
    quay = _quay(depth, scale, layout)
    pictures = []
    for shallow, deep in (
        (palette.CLEAR_SHALLOW, palette.CLEAR_DEEP),
        (palette.HAZY_SHALLOW, palette.HAZY_DEEP),
    ):
        sea = _mix(_flat(shallow, water.shape), deep, tint) * light[..., None]
        sea = _mix(sea, palette.WATER_SHADOW, 1.0 - shade)
        pictures.append(_shrink(sea * water[..., None] + quay * (1.0 - water[..., None])))
    return Background(
        clear=_bytes(pictures[0]),
        hazy=_bytes(pictures[1]),
        water=_shrink(water),
        open_water=_shrink(np.clip(depth / (0.22 * scale), 0.0, 1.0)),
    )


def _quay_distance(navigable: NDArray[np.bool_], layout: Layout) -> Field:
    """Signed distance from the water line, corners rounded [supersampled pixel]."""
    rows, columns = navigable.shape
    height, width = layout.map_height * _SUPERSAMPLING, layout.map_width * _SUPERSAMPLING
    row = _nodes(height, layout.scale * _SUPERSAMPLING, layout.border, rows)
    column = _nodes(width, layout.scale * _SUPERSAMPLING, layout.border, columns)
    water = navigable[row][:, column].astype(np.float32)
    rounding = 0.2 * layout.scale * _SUPERSAMPLING
    wet = _blur(water, (rounding, rounding)) >= 0.5
    if wet.all() or not wet.any():
        return np.full(wet.shape, height + width if wet.all() else -height, np.float32)
    inside = ndimage.distance_transform_edt(wet) - 0.5
    outside = ndimage.distance_transform_edt(~wet) - 0.5
    return np.where(wet, inside, -outside).astype(np.float32)


def _nodes(pixels: int, scale: float, border: float, count: int) -> NDArray[np.intp]:
    """Node along an axis that each pixel belongs to; the border belongs to the outermost."""
    place = np.floor((np.arange(pixels) + 0.5) / scale - border)
    nodes: NDArray[np.intp] = np.clip(place, 0, count - 1).astype(np.intp)
    return nodes


def _shadow(water: Field, scale: float) -> Field:
    """Soft shadow that quays throw on the water to the south-east, 0..1."""
    land = _blur(1.0 - water, (0.22 * scale, 0.22 * scale))
    shift = max(1, round(0.2 * scale))
    return np.pad(land, ((shift, 0), (shift, 0)), mode="edge")[:-shift, :-shift]


def _texture(shape: tuple[int, ...], scale: float) -> Field:
    """Faint swell: blurred noise of two grains, always the same, about +-2 %."""
    random = np.random.Generator(np.random.PCG64(_TEXTURE_SEED))
    total = np.zeros(shape, np.float32)
    grain = max(scale, 10.0)
    for along, across, strength in ((3.0, 1.2, 0.012), (0.8, 0.16, 0.006)):
        coarse = max(1.0, across * grain / 3.0)
        size = [max(2, round(length / coarse)) for length in shape]
        noise = random.standard_normal(size, dtype=np.float32)
        sigma = (across * grain / coarse, along * grain / coarse)
        layer = ndimage.gaussian_filter(noise, sigma, mode="nearest")
        total += strength * _resize(layer / max(float(layer.std()), 1e-9), shape)
    return total


def _blur(field: Field, sigma: tuple[float, float]) -> Field:
    """Gaussian blur; wide ones are made on a coarser grid, as nothing fine is left in them."""
    step = max(1.0, min(sigma) / 4.0)
    coarse = [max(2, round(length / step)) for length in field.shape]
    small = _resize(field, coarse) if step > 1.0 else field
    scaled = (sigma[0] / step, sigma[1] / step)
    blurred: Field = ndimage.gaussian_filter(small, scaled, mode="nearest")
    return _resize(blurred, field.shape) if step > 1.0 else blurred


def _resize(field: Field, shape: Sequence[int]) -> Field:
    picture = PilImage.fromarray(np.ascontiguousarray(field))
    return np.array(picture.resize((shape[1], shape[0]), PilImage.Resampling.BILINEAR))


def _quay(depth: Field, scale: float, layout: Layout) -> Field:
    """Quays: sand-grey tops, a light coping along the water and a thin dark foot."""
    inland = np.maximum(-depth, 0.0)
    coping = np.clip(max(0.13 * scale, 2.4 * layout.unit) - inland + 0.5, 0.0, 1.0)
    foot = np.clip(max(0.03 * scale, 0.9 * layout.unit) - inland + 0.5, 0.0, 1.0)
    top = _flat(palette.QUAY, depth.shape)
    top *= 1.0 - 0.06 * np.clip(inland / (2.0 * scale), 0.0, 1.0)[..., None]
    return _mix(_mix(top, palette.QUAY_EDGE, coping), palette.QUAY_FOOT, 0.55 * foot)


def _flat(colour: palette.Colour, shape: tuple[int, ...]) -> Field:
    return np.broadcast_to(np.array(colour, np.float32), (*shape, 3)).copy()


def _mix(picture: Field, colour: palette.Colour, part: NDArray[np.floating]) -> Field:
    weight = part.astype(np.float32)[..., None]
    mixed: Field = picture + (np.array(colour, np.float32) - picture) * weight
    return mixed


def _shrink(picture: Field) -> Field:
    """Mean over supersampled blocks; float32 in, float32 out."""
    height, width = picture.shape[0] // _SUPERSAMPLING, picture.shape[1] // _SUPERSAMPLING
    blocks = picture.reshape(height, _SUPERSAMPLING, width, _SUPERSAMPLING, *picture.shape[2:])
    return np.ascontiguousarray(blocks.mean(axis=(1, 3), dtype=np.float32))


def _bytes(picture: Field) -> Image:
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)
