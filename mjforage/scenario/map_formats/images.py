"""Images: a pixel per cell, light or dark, or of a grey that stands for unknown."""

import logging
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from mjforage.base.errors import UserError
from mjforage.scenario.map_formats.levels import MOST_CELLS, UNKNOWN, Levels, check_size

IMAGE_SUFFIXES = (
    *(".png", ".jpg", ".jpeg", ".bmp", ".gif"),
    *(".pgm", ".pbm", ".ppm", ".pnm", ".tif", ".tiff", ".webp"),
)
HALF = {255: 128, 65535: 32768}  # lightest grey -> this light or lighter is light
FREE, OCCUPIED = 0.196, 0.65  # of ROS map_server: thresholds of darkness; between them: unknown
SERVED = {0, 205, 254, 255}  # the greys that it writes: occupied, unknown, free
COLOURED = 48  # between the largest and the least of red, green and blue: more than JPEG makes
MANY = 0.01  # share of pixels that is worth a word
BAND = 256  # rows whose colours are mixed at a time
_BROKEN = OSError, ValueError, TypeError, SyntaxError, EOFError, ArithmeticError, LookupError
"""Raised by Pillow on damaged files."""

logger = logging.getLogger(__name__)


def read_image(path: Path, name: str, told: bool = True) -> Levels:
    """Levels of an image; its size is checked in its header.

    From half as light as white a pixel is light; transparency counts as white. An image of 0 and 1
    alone has 1 light. In PGM files, and others with the greys of ROS map_server alone, a pixel is
    light or dark where that takes it for free or occupied, and else unknown. Raises `UserError` if
    it is no image, damaged or too large.

    `path`: the file; `name`: name of the map in messages; `told`: warn of colours.
    """
    try:
        with warnings.catch_warnings():  # of its size, which is checked here
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(path)
        with image:
            check_size(image.height, image.width, name)
            return _levels(image, name, told)
    except UserError:
        raise
    except Image.DecompressionBombError as error:
        raise UserError(
            f"map {name}: has more pixels than the {MOST_CELLS:,} cells of a map; cut out the part "
            "that you need, or make its cells larger"
        ) from error
    except UnidentifiedImageError as error:
        raise UserError(f"map {name}: is no image, or one of size 0, or damaged") from error
    except _BROKEN as error:
        words = " ".join(str(error).split())
        raise UserError(f"map {name}: cannot be read as an image ({words})") from error


def _levels(image: Image.Image, name: str, told: bool) -> Levels:
    plain = "transparency" not in image.info
    if image.mode == "F":
        raise ValueError("its pixels are real numbers; give whole ones")
    if image.mode == "1" and plain:
        return np.asarray(image).astype(np.int8)
    if image.mode == "L" and plain:
        return _grey(np.asarray(image), 255, image, name)
    if image.mode.startswith("I"):
        return _grey(np.asarray(image), 65535, image, name)
    return _colours(image, name, told)


def _grey(values: NDArray[Any], top: int, image: Image.Image, name: str) -> Levels:
    if values.max() <= 1:
        levels: Levels = (values == 1).astype(np.int8)
    elif image.format == "PPM" or _is_served(values):
        darkness = 1.0 - values / top
        levels = np.where(darkness < FREE, 1, np.where(darkness > OCCUPIED, 0, UNKNOWN))
        levels = levels.astype(np.int8)
    else:
        levels = (values >= HALF[top]).astype(np.int8)
    if (unknown := float((levels == UNKNOWN).mean())) > MANY:
        logger.warning(
            "map %s: %.0f %% of its pixels are unknown, as 205 of map_server is, and become land",
            *(name, 100.0 * unknown),
        )
    return levels


def _is_served(values: NDArray[Any]) -> bool:
    """True if an image has the greys that map_server writes, unknown cells among them."""
    found = set(np.unique(values).tolist())
    return 205 in found and found <= SERVED


def _colours(image: Image.Image, name: str, told: bool) -> Levels:
    """Levels of colours by their lightness, on white."""
    levels: Levels = np.empty((image.height, image.width), np.int8)
    coloured = 0
    for top in range(0, image.height, BAND):
        part = image.crop((0, top, image.width, min(top + BAND, image.height))).convert("RGBA")
        shown = Image.alpha_composite(Image.new("RGBA", part.size, "white"), part)
        levels[top : top + BAND] = np.asarray(shown.convert("L")) >= HALF[255]
        parts: NDArray[Any] = np.asarray(shown.convert("RGB"))
        coloured += int((np.ptp(parts, axis=-1) > COLOURED).sum())
    if told and coloured > MANY * levels.size:
        logger.warning(
            "map %s: %.0f %% of its pixels are coloured, and colours count by lightness alone: "
            "%.0f %% of all are light; `mjforage maps %s -o seen.png` shows which",
            *(name, 100 * coloured / levels.size, 100 * levels.mean(), name),
        )
    return levels
