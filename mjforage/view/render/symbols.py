"""Symbols of a chart: vessels, trails, items, believed items."""

import numpy as np
from numpy.typing import NDArray

from mjforage.view.render import palette
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import (
    Floats,
    Image,
    paint_box,
    paint_discs,
    paint_polygon,
    paint_rings,
    paint_stroke,
)

# Outlines with the bow towards +x, in hull lengths: a slender delta, and two floats with a mouth.
SCOUT_HULL: Floats = np.array(
    [[0.56, 0.0], [0.1, 0.2], [-0.44, 0.36], [-0.28, 0.0], [-0.44, -0.36], [0.1, -0.2]]
)
_FORAGER_HALF = [[0.42, 0.4], [-0.34, 0.4], [-0.46, 0.26]]
FORAGER_HULL: Floats = np.array(
    [
        [0.08, 0.16],
        [0.52, 0.2],
        *_FORAGER_HALF,
        *[[x, -y] for x, y in reversed(_FORAGER_HALF)],
        [0.52, -0.2],
        [0.08, -0.16],
    ]
)


def turned(points: Floats, clockwise_rad: float) -> Floats:
    """Points (n, 2) or (2,), right and down, turned in the picture."""
    cos, sin = np.cos(clockwise_rad), np.sin(clockwise_rad)
    found: Floats = points @ np.array([[cos, sin], [-sin, cos]])
    return found


def _corners(place: Floats, course: float, length: float, collects: bool) -> Floats:
    return length * turned(FORAGER_HULL if collects else SCOUT_HULL, course) + place


def paint_hull(
    image: Image,
    place: Floats,
    course: float,
    length: float,
    collects: bool,
    colour: Colour,
) -> None:
    """Paint one vessel at `place` (2,) [pixel] with a soft shadow, a white rim and a deck."""
    corners = _corners(place, course, length, collects)
    rim = max(1.0, 0.055 * length)
    shadow = corners + 0.07 * length
    paint_polygon(image, shadow, rim, max(1.0, 0.22 * length), 0.45, palette.WATER_SHADOW)
    paint_polygon(image, corners, 1.75 * rim, 1.0, 0.9, palette.INK)
    paint_polygon(image, corners, rim, 1.0, 1.0, palette.WHITE)
    paint_polygon(image, corners, -0.25 * rim, 1.0, 1.0, colour)
    cabin = length * turned(np.array([[-0.16 if collects else -0.02, 0.0]]), course) + place
    size = np.array([0.075 * length])
    paint_discs(image, cabin, size, np.ones(1), palette.WHITE)


def paint_stale(
    image: Image, place: Floats, course: float, length: float, collects: bool, colour: Colour
) -> None:
    """Paint a vessel faded, at its last known position."""
    corners, rim = _corners(place, course, length, collects), max(1.0, 0.055 * length)
    paint_polygon(image, corners, rim, 1.0, 0.55, palette.WHITE)
    paint_polygon(image, corners, -0.25 * rim, 1.0, 0.5, colour)


def paint_outline(
    image: Image, place: Floats, course: float, length: float, collects: bool, colour: Colour
) -> None:
    """Paint the outline of a vessel at its true position, which is not known."""
    corners = _corners(place, course, length, collects)
    around, line = np.concatenate((corners, corners[:1])), np.full(len(corners) + 1, 0.06 * length)
    paint_stroke(image, around, line, np.full(len(around), 0.8), colour)


def paint_trail(image: Image, points: Floats, length: float, colour: Colour) -> None:
    """Paint the way (n, 2) [pixel] that a vessel came, oldest first, fading into the past."""
    age = np.linspace(0.0, 1.0, len(points))
    paint_stroke(image, points, length * (0.06 + 0.10 * age), 0.75 * age**1.3, colour)


def paint_items(image: Image, points: Floats, alpha: Floats, radius: float, *, known: bool) -> None:
    """Paint litter (n, 2) [pixel]: bright with a dark rim; small and dim until discovered."""
    size = np.full(len(points), radius if known else 0.72 * radius)
    strength = alpha if known else 0.62 * alpha
    paint_discs(image, points, size + max(0.9, 0.3 * radius), strength, palette.ITEM_RIM)
    paint_discs(image, points, size, alpha if known else 0.75 * alpha, palette.ITEM)


def paint_body(image: Image, place: Floats, unit: float, *, known: bool) -> None:
    """Paint litter at `place` (2,) [pixel] as MuJoCo shows it from afar: ringed once discovered."""
    (x, y), one = place, np.ones(1)
    box = (x - 3.2 * unit, y - 2.2 * unit, x + 3.2 * unit, y + 2.2 * unit)
    paint_box(image, box, 1.0 * unit, 0.0, 1.0, palette.BODY)
    if known:
        paint_rings(image, place[None], 7.2 * unit * one, 1.5 * unit * one, one, palette.ITEM)


def paint_believed(
    image: Image,
    points: Floats,
    count: NDArray[np.integer],
    alpha: Floats,
    side: float,
    most: int,
) -> None:
    """Fill nodes (n, 2) [pixel] where `count` items are believed, the darker the more."""
    half = 0.5 * side
    shades = palette.belief_shades(count, most)
    for (x, y), colour, cover in zip(points, shades, alpha, strict=True):
        box = (x - half, y - half, x + half, y + half)
        paint_box(image, box, 0.0, 0.0, 0.9 * float(cover), tuple(colour.tolist()))


def paint_collected(
    image: Image, points: Floats, age: Floats, radius: float, length: float
) -> None:
    """Paint the ring that spreads where an item was just collected.

    Parameters
    ----------
    points : (n, 2) [pixel]
    age : (n,) in 0..1
    radius, length : of an item and a vessel [pixel]
    """
    reach, width = radius + age * 0.9 * length, (1.0 - age) * max(2.5, 0.16 * length) + 0.5
    left, rim = 0.95 * (1.0 - age), max(1.2, 0.05 * length)
    paint_rings(image, points, reach, width + rim, left, palette.ITEM_RIM)
    paint_rings(image, points, reach, width, left, palette.ITEM)
