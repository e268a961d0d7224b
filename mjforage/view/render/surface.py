"""Colours of water, sky and haze over a whole picture, by compiled functions of one pixel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.view.render.sheet import FOAM

Image = NDArray[np.uint8]
Field = NDArray[np.float32]


class Drawn(NamedTuple):
    """Picture and distances that MuJoCo drew."""

    image: Image  # (h, w, 3)
    ahead: Field  # (h, w) distance along the view [m], infinite where nothing is


class Spread(NamedTuple):
    """A picture spread over the water, in world coordinates [m]; row 0 is southernmost."""

    values: Field | Image  # (row, column) distance to land [m], or (row, column, 5) of a `Sheet`
    west: float
    south: float
    texel_m: float


PATCH_M, PATCH_SIZE = 16.0, 256  # patch of the small waves; sizes are powers of two
BROAD, BROAD_SIZE = 6.3, 128  # the second patch is so many times larger

_DEEP = (16.0, 84.0, 112.0)
_SHALLOW = (52.0, 140.0, 150.0)
_DEEP_M = 3.2  # distance from land at which water is half as dark as it gets
_HORIZON = (221.0, 231.0, 236.0)
_ZENITH = (118.0, 172.0, 214.0)
_SUNLIGHT = (255.0, 244.0, 214.0)
_FOAM_WHITE = 246.0
_SUN_X, _SUN_Y, _SUN_Z = 0.4509, -0.5511, 0.7021  # direction to the sun
_HAZE_M = 1500.0  # distance at which things are half lost in the haze
_CLEAR_M = 0.55  # way through the water after which half shines through
_REFLECTED_M = 1.6  # distance of what the water mirrors, for how far slopes shift it
_FINEST_WAVE_M = 0.35  # small waves vanish where a pixel is larger
_MIRROR_GAP = 2  # the mirror is sampled twice, so many rows apart


@inlined
def _wrapped(slopes: Field, x: float, y: float) -> tuple[float, float]:
    """Slopes of a periodic patch at texel coordinates."""
    last = slopes.shape[0] - 1
    fx, fy = np.floor(x), np.floor(y)
    tx, ty = x - fx, y - fy
    left, low = int(fx) & last, int(fy) & last
    right, high = (left + 1) & last, (low + 1) & last
    a, b = (1.0 - tx) * (1.0 - ty), tx * (1.0 - ty)
    c, d = (1.0 - tx) * ty, tx * ty
    sx = a * slopes[low, left, 0] + b * slopes[low, right, 0]
    sx += c * slopes[high, left, 0] + d * slopes[high, right, 0]
    sy = a * slopes[low, left, 1] + b * slopes[low, right, 1]
    sy += c * slopes[high, left, 1] + d * slopes[high, right, 1]
    return sx, sy


@inlined
def _slopes_at(
    small: Field, broad: Field, x: float, y: float, print_m: float
) -> tuple[float, float]:
    """Slopes of the surface; waves finer than a pixel's print are left out, or they flicker."""
    fine = 1.0 / (1.0 + (print_m / _FINEST_WAVE_M) ** 2)
    coarse = 1.0 / (1.0 + (print_m / (_FINEST_WAVE_M * BROAD)) ** 2)
    size, broad_size = small.shape[0] / PATCH_M, broad.shape[0] / (PATCH_M * BROAD)
    sx, sy = _wrapped(small, x * size, y * size)
    bx, by = _wrapped(broad, (0.8 * x - 0.6 * y) * broad_size, (0.6 * x + 0.8 * y) * broad_size)
    lively = fine * (0.75 + 2.2 * bx)  # some patches are rougher than others
    return lively * sx + coarse * bx, lively * sy + coarse * by


@inlined
def _clamped(spread: Spread, x: float, y: float) -> float:
    """Bilinear value of a picture (row, column) at a point of the world, kept inside."""
    field = spread.values
    tx = min(max((x - spread.west) / spread.texel_m - 0.5, 0.0), field.shape[1] - 1.001)
    ty = min(max((y - spread.south) / spread.texel_m - 0.5, 0.0), field.shape[0] - 1.001)
    left, low = int(tx), int(ty)
    tx, ty = tx - left, ty - low
    south = (1.0 - tx) * field[low, left] + tx * field[low, left + 1]
    north = (1.0 - tx) * field[low + 1, left] + tx * field[low + 1, left + 1]
    return float((1.0 - ty) * south + ty * north)


@inlined
def _laid_at(sheet: Spread, x: float, y: float, laid: NDArray[np.float64]) -> None:
    """Bilinear colour, cover and foam (5,) of the sheet at a point, nothing outside it."""
    texels = sheet.values
    tx = (x - sheet.west) / sheet.texel_m - 0.5
    ty = (y - sheet.south) / sheet.texel_m - 0.5
    laid[:] = 0.0
    if 0.0 <= tx < texels.shape[1] - 1.0 and 0.0 <= ty < texels.shape[0] - 1.0:
        left, low = int(tx), int(ty)
        tx, ty = tx - left, ty - low
        for k in range(5):
            south = (1.0 - tx) * texels[low, left, k] + tx * texels[low, left + 1, k]
            north = (1.0 - tx) * texels[low + 1, left, k] + tx * texels[low + 1, left + 1, k]
            laid[k] = (1.0 - ty) * south + ty * north
        laid[3:] /= 255.0


@inlined
def _sky(rise: float, channel: int) -> float:
    """Colour of the sky in a direction that rises by `rise`, its z."""
    part = max(0.0, rise)
    part = part / (part + 0.22)
    return _HORIZON[channel] + (_ZENITH[channel] - _HORIZON[channel]) * part


@inlined
def _haze(distance: float) -> float:
    """Share of the horizon's colour in what is seen at a distance [m]."""
    square = distance * distance
    return square / (square + _HAZE_M * _HAZE_M)


@inlined
def _to_sun(x: float, y: float, z: float) -> float:
    """Cosine between a unit vector and the sun's direction, at least 0."""
    return max(0.0, x * _SUN_X + y * _SUN_Y + z * _SUN_Z)


@inlined
def _paint_solid(image: Image, i: int, j: int, haze: float) -> None:
    """Blend a pixel of something solid with the horizon's colour."""
    for k in range(3):
        value = float(image[i, j, k])
        image[i, j, k] = np.uint8(value + (_HORIZON[k] - value) * haze + 0.5)


@inlined
def _paint_sky(image: Image, i: int, j: int, x: float, y: float, z: float) -> None:
    """Paint a pixel of sky in the view direction (x, y, z), brighter towards the sun."""
    glow = 0.35 * _to_sun(x, y, z) ** 8
    for k in range(3):
        value = _sky(z, k)
        image[i, j, k] = np.uint8(value + (_SUNLIGHT[k] - value) * glow + 0.5)


@inlined
def _mirror_texel(mirror_ahead: Field, row: float, column: float) -> tuple[int, int, int, int]:
    """Two nearby texels of the mirror picture, as rows and columns kept inside."""
    i = min(max(int(row), 0), mirror_ahead.shape[0] - 1)
    j = min(max(int(column), 0), mirror_ahead.shape[1] - 1)
    return i, j, max(i - _MIRROR_GAP, 0), min(j + 1, mirror_ahead.shape[1] - 1)


@kernel
def paint_surface(
    drawn: Drawn,
    mirror: Drawn,
    sheet: Spread,
    shore: Spread,
    small: Field,
    broad: Field,
    camera: NDArray[np.float64],
    first: int,
    end: int,
) -> None:
    """Paint water, sky and haze into rows `first` to `end` of the picture drawn, row 0 on top.

    Parameters
    ----------
    mirror : the picture from below, upside down, in any size
    sheet : (row, column, 5) what lies on the water, see `Sheet`
    shore : (row, column) distance to land [m]
    small, broad : (size, size, 2) slopes of the two patches of waves
    camera : (4, 3) eye [m], forward, and right and up times the tangent of half the field of view
    """
    image, ahead, mirrored, mirror_ahead = drawn.image, drawn.ahead, mirror.image, mirror.ahead
    height, width = ahead.shape
    eye, forward, right, up = camera[0], camera[1], camera[2], camera[3]
    aspect = width / height
    pixel = 2.0 * np.sqrt(up[0] ** 2 + up[1] ** 2 + up[2] ** 2) / height  # [m] one metre ahead
    scale_x, scale_y = mirror_ahead.shape[1] / width, mirror_ahead.shape[0] / height
    laid = np.zeros(5)
    for i in range(first, end):
        v = 1.0 - 2.0 * (i + 0.5) / height
        for j in range(width):
            u = (2.0 * (j + 0.5) / width - 1.0) * aspect
            dx = forward[0] + u * right[0] + v * up[0]
            dy = forward[1] + u * right[1] + v * up[1]
            dz = forward[2] + u * right[2] + v * up[2]
            flat = np.sqrt(dx * dx + dy * dy)
            long = np.sqrt(flat * flat + dz * dz)
            solid = float(ahead[i, j])
            wet = -eye[2] / dz if dz < -1e-5 else np.inf  # distance ahead of the water
            if solid < np.inf and wet >= solid:
                _paint_solid(image, i, j, _haze(solid * flat))
                continue
            if wet == np.inf:
                _paint_sky(image, i, j, dx / long, dy / long, dz / long)
                continue
            x, y = eye[0] + wet * dx, eye[1] + wet * dy
            print_m = pixel * wet * long / np.sqrt(max(-dz / long, 0.02))
            sx, sy = _slopes_at(small, broad, x, y, print_m)
            _laid_at(sheet, x, y, laid)
            off = _clamped(shore, x, y)
            # What the surface mirrors: the sky and the sun, or the harbour
            norm = 1.0 / np.sqrt(1.0 + sx * sx + sy * sy)
            facing = max(0.0, (dx * sx + dy * sy - dz) * norm / long)
            away = (1.0 - facing) ** 2
            fresnel = min(1.0, 0.023 + 1.12 * away * away * (1.0 - facing))
            twice = 2.0 * facing * norm
            rise = abs(dz / long + twice)
            sun = _to_sun(dx / long - twice * sx, dy / long - twice * sy, rise)
            for _ in range(9):
                sun *= sun
            shift = min(2.0 * _REFLECTED_M / (wet * pixel), 0.22 * height)
            across, along = (sy * dx - sx * dy) / long, 1.4 * (sx * dx + sy * dy) / long
            i1, j1, i2, j2 = _mirror_texel(
                mirror_ahead,
                (height - i - 0.5 - along * shift) * scale_y,
                (j + 0.5 - across * shift) * scale_x,
            )
            solid_1, solid_2 = mirror_ahead[i1, j1] < np.inf, mirror_ahead[i2, j2] < np.inf
            glint = 0.0 if solid_1 or solid_2 else 0.75 * sun
            # What shines through it, and what lies on it
            deep = off / (off + _DEEP_M)
            tone = 1.0 - 1.1 * (sx * _SUN_X + sy * _SUN_Y)
            tone *= 1.0 - 0.28 * max(0.0, 1.0 - off / 0.9)  # shade beside a wall
            way = (solid - wet) * long
            through = 1.0 / (1.0 + (way / _CLEAR_M) ** 2) if way < 50.0 else 0.0
            flecks = laid[FOAM] * min(1.0, max(0.0, 0.55 + 5.0 * (sx - sy)))
            flecks = min(0.92, 0.3 * laid[FOAM] + 0.9 * flecks)
            haze = _haze(wet * flat)
            for k in range(3):
                value = (_SHALLOW[k] + (_DEEP[k] - _SHALLOW[k]) * deep) * tone
                value += (float(image[i, j, k]) * (0.45 + 0.18 * k) - value) * through
                sky = 0.5 * _sky(rise, k)
                shine = 0.43 * mirrored[i1, j1, k] if solid_1 else sky
                shine += 0.43 * mirrored[i2, j2, k] if solid_2 else sky
                value += (shine - value) * fresnel
                value += (_SUNLIGHT[k] - value) * glint
                value = value * (1.0 - laid[3]) + laid[k]
                value += (_FOAM_WHITE - value) * flecks
                value += (_HORIZON[k] - value) * haze
                image[i, j, k] = np.uint8(min(255.0, max(0.0, value + 0.5)))
