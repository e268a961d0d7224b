"""Softening of jagged edges in a finished picture, as software OpenGL is slow at it.

Along strong edges each pixel is mixed with its neighbours along the edge, found from the
brightness around it (T. Lottes, "FXAA", NVIDIA white paper, 2009).
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.view.render.bands import in_bands

Image = NDArray[np.uint8]
_LEAST_CONTRAST = 14.0  # of brightness 0..255
_PART_CONTRAST = 0.11  # of the brightest pixel around
_MOST_PIXELS = 6.0  # how far along an edge


@inlined
def _bright(image: Image, i: int, j: int) -> float:
    """Brightness of a pixel."""
    return float(0.3 * image[i, j, 0] + 0.59 * image[i, j, 1] + 0.11 * image[i, j, 2])


@inlined
def _sample(image: Image, y: float, x: float, k: int) -> float:
    """Bilinear value of a channel; pixel centres lie at whole numbers."""
    y = min(max(y, 0.0), image.shape[0] - 1.001)
    x = min(max(x, 0.0), image.shape[1] - 1.001)
    i, j = int(y), int(x)
    ty, tx = y - i, x - j
    upper = (1.0 - tx) * image[i, j, k] + tx * image[i, j + 1, k]
    lower = (1.0 - tx) * image[i + 1, j, k] + tx * image[i + 1, j + 1, k]
    return float((1.0 - ty) * upper + ty * lower)


def smooth_edges(image: Image, result: Image) -> None:
    """Write the softened `image` (h, w, 3) into `result` of the same shape."""
    in_bands(len(image), lambda first, end: _smooth(image, result, first, end))


@kernel
def _smooth(image: Image, result: Image, first: int, end: int) -> None:
    """Rows `first` to `end` of an image with stair-steps along contrast edges blended away."""
    height, width = image.shape[:2]
    near, far = np.empty(3), np.empty(3)
    result[first:end] = image[first:end]
    for i in range(max(first, 1), min(end, height - 1)):
        for j in range(1, width - 1):
            middle = _bright(image, i, j)
            north, south = _bright(image, i - 1, j), _bright(image, i + 1, j)
            west, east = _bright(image, i, j - 1), _bright(image, i, j + 1)
            low = min(middle, north, south, west, east)
            high = max(middle, north, south, west, east)
            if high - low < max(_LEAST_CONTRAST, _PART_CONTRAST * high):
                continue
            nw, ne = _bright(image, i - 1, j - 1), _bright(image, i - 1, j + 1)
            sw, se = _bright(image, i + 1, j - 1), _bright(image, i + 1, j + 1)
            low, high = min(low, nw, ne, sw, se), max(high, nw, ne, sw, se)
            along_x, along_y = (sw + se) - (nw + ne), (nw + sw) - (ne + se)
            least = max((nw + ne + sw + se) * 0.03, 2.0)
            scale = 1.0 / (min(abs(along_x), abs(along_y)) + least)
            along_x = min(max(along_x * scale, -_MOST_PIXELS), _MOST_PIXELS)
            along_y = min(max(along_y * scale, -_MOST_PIXELS), _MOST_PIXELS)
            for k in range(3):
                inner = _sample(image, i - along_y / 6.0, j - along_x / 6.0, k)
                inner += _sample(image, i + along_y / 6.0, j + along_x / 6.0, k)
                outer = _sample(image, i - 0.5 * along_y, j - 0.5 * along_x, k)
                outer += _sample(image, i + 0.5 * along_y, j + 0.5 * along_x, k)
                near[k], far[k] = 0.5 * inner, 0.25 * (inner + outer)
            bright = 0.3 * far[0] + 0.59 * far[1] + 0.11 * far[2]
            outside = bright < low or bright > high
            for k in range(3):
                result[i, j, k] = np.uint8((near[k] if outside else far[k]) + 0.5)
