"""Images of a harbour with two control points: the water on a grid of the place."""

import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mjforage.base.errors import UserError
from mjforage.scenario.map_formats import DARK, LIGHT, read_image
from mjforage.scenario.map_formats.images import COLOURED, MANY
from mjforage.scenario.place import projection

Point = tuple[float, float, float, float]  # row, column, latitude, longitude
_NEAR = 24  # of red, green and blue each, that still is a colour
_POINT = re.compile(r"^\s*([^,=]+),([^,=]+)=([^,=]+),([^,=]+)$")


def control_point(text: str) -> Point:
    """A control point ROW,COL=LAT,LON of text; raises `UserError` for anything else."""
    match = _POINT.match(text)
    try:
        values = [float(part) for part in match.groups()] if match else []
    except ValueError:
        values = []
    if len(values) != 4 or not np.isfinite(values).all() or abs(values[2]) > 89:
        raise UserError(f"--point {text!r}: give ROW,COL=LAT,LON, for example 12,340=38.97,-76.48")
    row, column, latitude, longitude = values
    return row, column, latitude, longitude


def image_water(path: Path, colours: Sequence[str]) -> NDArray[np.bool_]:
    """(row, column) of an image, its light pixels, its dark ones, or those of colours.

    Raises `UserError` if the image cannot be read, is coloured and no colour is given, or no pixel
    has one of the colours.

    `colours`: "light", "dark", or colours such as #aad3df; none: light, of an image of greys.
    """
    words, levels = list(colours) or ["light"], read_image(path, path.name, told=False)
    with Image.open(path) as image:
        shown = np.asarray(image.convert("RGB")).astype(np.int16)
    if not colours and (share := float((np.ptp(shown, axis=-1) > COLOURED).mean())) > MANY:
        raise UserError(
            f"place {path}: {100 * share:.0f} % of its pixels are coloured; say by --water which "
            f"are water: light, dark, or colours, of which there are {_colours_in(shown)}"
        )
    if words in (["light"], ["dark"]):
        return np.asarray(levels == (DARK if words == ["dark"] else LIGHT))
    found = np.zeros(levels.shape, np.bool_)
    for word in words:
        if not re.fullmatch(r"#[0-9a-fA-F]{6}", word):
            raise UserError(f"--water {word}: of an image give light, dark, or a colour: #aad3df")
        colour = [int(word[i : i + 2], 16) for i in (1, 3, 5)]
        found |= np.abs(shown - colour).max(axis=-1) <= _NEAR
    if not found.any():
        some = _colours_in(shown)
        raise UserError(f"--water {' '.join(words)}: no pixel is near it; there are {some}")
    return found


def _colours_in(shown: NDArray[np.int16]) -> str:
    """The four colours that stand for all of an image, in words."""
    often = Image.fromarray(shown.astype(np.uint8)).quantize(4).getpalette() or []
    return ", ".join("#" + bytes(often[i : i + 3]).hex() for i in range(0, 12, 3) if often[i:])


class Georeference:
    """The pixels of an image on the globe: a similarity through two control points."""

    def __init__(self, points: Sequence[Point], shape: tuple[int, int]) -> None:
        first, second = np.array(points)
        self._latlon = tuple(np.mean([first[2:], second[2:]], axis=0))
        ground = self._plane(np.array([first[3], second[3]]), np.array([first[2], second[2]]))
        pixel = np.array([complex(one[1], -one[0]) for one in (first, second)])
        apart, away = abs(pixel[1] - pixel[0]), abs(ground[1] - ground[0])
        if apart < 1.0 or not 1e-3 < away < 1e6:
            raise UserError(
                f"--point: the two are {apart:g} pixels and {away:g} m apart; give two that lie "
                "far from each other in the image"
            )
        self._shape = shape
        self._scale = (ground[1] - ground[0]) / (pixel[1] - pixel[0])
        self._origin = ground[0] - self._scale * pixel[0]

    def _plane(self, lon: NDArray[np.float64], lat: NDArray[np.float64]) -> NDArray[np.complex128]:
        east, north = projection(*self._latlon).transform(lon, lat)
        return np.asarray(east + 1j * north)

    @property
    def rotation_deg(self) -> float:
        """Bearing of the image's upper edge."""
        return -math.degrees(float(np.angle(self._scale)))

    @property
    def corners(self) -> NDArray[np.float64]:
        """(4, 2) longitude and latitude of the image's corners."""
        rows, columns = self._shape
        pixel = np.array(
            [complex(c, -r) for r in (-0.5, rows - 0.5) for c in (-0.5, columns - 0.5)]
        )
        ground = self._origin + self._scale * pixel
        inverse = projection(*self._latlon).transform(ground.real, ground.imag, direction="INVERSE")
        return np.stack(inverse, axis=-1)

    def sampled(self, water: NDArray[np.bool_], latlon: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Water at (..., 2) latitudes and longitudes; none outside the image."""
        ground = self._plane(latlon[..., 1].ravel(), latlon[..., 0].ravel())
        pixel = (ground - self._origin) / self._scale
        row, column = np.rint(-pixel.imag).astype(int), np.rint(pixel.real).astype(int)
        inside = (row >= 0) & (row < water.shape[0]) & (column >= 0) & (column < water.shape[1])
        found = np.zeros(row.shape, np.bool_)
        found[inside] = water[row[inside], column[inside]]
        return found.reshape(latlon.shape[:-1])
