"""Idleness veil and views: node fields drawn smoothly over the water."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.base.compiled import inlined, kernel
from mjforage.runs.episode_recording import Recording
from mjforage.view.render.background import Background
from mjforage.view.render.frame_layout import Layout
from mjforage.view.render.palette import Colour
from mjforage.view.render.raster import Image

NodeField = NDArray[np.float32]  # (row, column)
SCOUT_VIEW, FORAGER_VIEW = 1, 2  # bits of Recording.in_view
VIEW_FILL, VIEW_LINE = 0.3, 0.9  # opacity
_REACH = 3  # views are outlined up to this distance [node]
_SMOOTHING = np.array([0.25, 0.5, 0.25], np.float32)


class Fields(NamedTuple):
    """Node fields at one step; land takes the value of the nearest water node."""

    idleness: NodeField  # 0..1
    scout_view: NodeField  # signed distance to the edge of the view [node], negative inside
    forager_view: NodeField

    def mixed(self, later: "Fields", part: float) -> "Fields":
        """Return the fields `part` of the way to those of a later step."""
        weight = np.float32(part)
        return Fields(
            self.idleness + (later.idleness - self.idleness) * weight,
            self.scout_view + (later.scout_view - self.scout_view) * weight,
            self.forager_view + (later.forager_view - self.forager_view) * weight,
        )


def nearest_water(navigable: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Row and column (row, column) of the navigable node nearest to each node."""
    water = navigable if navigable.any() else ~navigable
    index = ndimage.distance_transform_edt(~water, return_distances=False, return_indices=True)
    return index[0].astype(np.intp), index[1].astype(np.intp)


def fields_at(
    replay: Recording, step: int, nearest: tuple[NDArray[np.intp], NDArray[np.intp]]
) -> Fields:
    """Prepare the fields of one step."""
    view = replay.in_view[step][nearest]
    return Fields(
        _smooth(replay.idleness[step].astype(np.float32)[nearest]),
        _smooth(_edge_distance((view & SCOUT_VIEW) != 0)),
        _edge_distance((view & FORAGER_VIEW) != 0),
    )


def _edge_distance(inside: NDArray[np.bool_]) -> NodeField:
    """Signed distance to the edge of a node set, cut off at `_REACH` [node]."""
    distance = np.full(inside.shape, _REACH, np.float32)
    if inside.any():
        rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
        first_row, first_column = max(0, rows[0] - _REACH), max(0, columns[0] - _REACH)
        part = np.s_[first_row : rows[-1] + _REACH + 1, first_column : columns[-1] + _REACH + 1]
        _fill_edge_distance(inside[part], distance[part])
    return distance


def _smooth(field: NodeField) -> NodeField:
    """Binomial mean of each node and its neighbours."""
    for axis in (0, 1):
        field = ndimage.correlate1d(field, _SMOOTHING, axis=axis, mode="nearest")
    return field


@kernel
def _fill_edge_distance(inside: NDArray[np.bool_], distance: NodeField) -> None:
    """Distance of each cell to the edge of `inside` [cell], negative within, cut at `_REACH`."""
    rows, columns = inside.shape
    for row in range(rows):
        for column in range(columns):
            nearest = float(_REACH) + 0.5
            for y in range(max(0, row - _REACH), min(rows, row + _REACH + 1)):
                for x in range(max(0, column - _REACH), min(columns, column + _REACH + 1)):
                    if inside[y, x] != inside[row, column]:
                        nearest = min(nearest, np.hypot(float(y - row), float(x - column)))
            sign = -1.0 if inside[row, column] else 1.0
            distance[row, column] = sign * (nearest - 0.5)


def paint_fields(
    image: Image,
    background: Background,
    fields: Fields,
    layout: Layout,
    colours: tuple[Colour, Colour],
) -> None:
    """Paint water, veil and views (scouts', foragers') into the map area (height, width, 3)."""
    rows, columns = fields.idleness.shape
    pixels = _Pixels(
        _samples(rows, layout.map_height, layout),
        _samples(columns, layout.map_width, layout),
        layout.scale,
        layout.unit,
    )
    _shade(image, background, fields, pixels, colours)


class _Pixels(NamedTuple):
    """Where the pixels of the map area lie."""

    row: NDArray[np.float32]  # (height,) node coordinate of each pixel's centre
    column: NDArray[np.float32]  # (width,)
    scale: float  # [pixel/node]
    unit: float  # width of a fine line [pixel]


def _samples(nodes: int, pixels: int, layout: Layout) -> NDArray[np.float32]:
    """Node coordinate of each pixel centre along an axis, inside 0..nodes-1."""
    place = (np.arange(pixels) + 0.5) / layout.scale - layout.border - 0.5
    inside: NDArray[np.float32] = np.clip(place, 0.0, nodes - 1.0).astype(np.float32)
    return inside


@inlined
def _weights(place: float) -> tuple[int, float, float, float]:
    """Quadratic B-spline: the middle node, and the weights of it and its two neighbours."""
    middle = int(place + 0.5)
    shift = place - middle
    before, after = 0.5 * (0.5 - shift) ** 2, 0.5 * (0.5 + shift) ** 2
    return middle, before, 1.0 - before - after, after


@kernel
def _blend_rows(field: NodeField, place: float, blended: NodeField) -> None:
    """Spline along the rows at row coordinate `place`, for every column."""
    middle, before, at, after = _weights(place)
    upper, lower = max(middle - 1, 0), min(middle + 1, field.shape[0] - 1)
    for column in range(field.shape[1]):
        value = before * field[upper, column] + at * field[middle, column]
        blended[column] = value + after * field[lower, column]


@inlined
def _blend_columns(row: NodeField, place: float) -> float:
    """Spline along one row of nodes (column,) at column coordinate `place`."""
    middle, before, at, after = _weights(place)
    left, right = max(middle - 1, 0), min(middle + 1, row.shape[0] - 1)
    return float(before * row[left] + at * row[middle] + after * row[right])


@inlined
def _fill_cover(pixels: float) -> float:
    """Opacity of a view `pixels` from its edge, negative inside."""
    return VIEW_FILL * min(1.0, max(0.0, 0.5 - pixels))


@inlined
def _line_cover(pixels: float, unit: float) -> float:
    """Opacity of a view's outline."""
    return VIEW_LINE * min(1.0, max(0.0, 0.8 * unit - abs(pixels) + 0.5))


@kernel
def _shade(
    image: Image,
    background: Background,
    fields: Fields,
    pixels: _Pixels,
    colours: tuple[Colour, Colour],
) -> None:
    """Mix clear and hazy water by idleness, then the views over it, into every pixel."""
    (scout_colour, forager_colour), unit = colours, pixels.unit
    lines = np.empty((3, fields.idleness.shape[1]), np.float32)
    for i in range(image.shape[0]):
        _blend_rows(fields.idleness, pixels.row[i], lines[0])
        _blend_rows(fields.scout_view, pixels.row[i], lines[1])
        _blend_rows(fields.forager_view, pixels.row[i], lines[2])
        for j in range(image.shape[1]):
            veil = scout = forager = scout_line = forager_line = 0.0
            wet, calm = float(background.water[i, j]), float(background.open_water[i, j])
            if wet > 0.0:
                x = pixels.column[j]
                veil = _blend_columns(lines[0], x)
                near = _blend_columns(lines[1], x) * pixels.scale
                scout, scout_line = wet * _fill_cover(near), wet * calm * _line_cover(near, unit)
                near = _blend_columns(lines[2], x) * pixels.scale
                forager = wet * _fill_cover(near)
                forager_line = wet * calm * _line_cover(near, unit)
            for k in range(3):
                clear = background.clear[i, j, k]
                value = clear + (float(background.hazy[i, j, k]) - clear) * veil
                value += (0.15 * scout_colour[k] + 0.85 * 255.0 - value) * scout
                value += (0.55 * forager_colour[k] + 0.45 * 255.0 - value) * forager
                value += (scout_colour[k] - value) * scout_line
                value += (forager_colour[k] - value) * forager_line
                image[i, j, k] = np.uint8(value + 0.5)
