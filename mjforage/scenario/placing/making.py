"""Making a place: a file of outlines or an image, its frame on the globe, and its grid."""

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.base.extras import require
from mjforage.scenario.map_formats import IMAGE_SUFFIXES
from mjforage.scenario.map_formats.levels import check_size
from mjforage.scenario.maps import GridMap, components
from mjforage.scenario.place import Place
from mjforage.scenario.placing.channels import closed_channels, open_borders, width_at
from mjforage.scenario.placing.gridding import least_depths, water_shares, without_barriers
from mjforage.scenario.placing.outlines import Box, read_outlines
from mjforage.scenario.placing.pictures import Georeference, Point, image_water
from mjforage.scenario.placing.water import Choice, Depths, water_of

_MOST_NAMED = 10  # channels
_FINEST = 30_000_000  # cells of the fine grid, on which channels are looked for
_SIMPLE_M = 0.02  # by which the outlines of quays may be simplified


@dataclass(frozen=True)
class Layout:
    """Frame and grid of a place.

    Attributes
    ----------
    pitch_m, share : of the grid; a node has at least that share of water in its cell
    crop : west, south, east, north [deg]; None: all of the file
    rotation_deg : bearing to which columns point up; None: along most of the shore
    """

    pitch_m: float = 4.0
    share: float = 0.6
    crop: Box | None = None
    rotation_deg: float | None = 0.0


def make_place(
    path: Path, layout: Layout, choice: Choice, points: Sequence[Point] = (), licence: str = ""
) -> GridMap:
    """The map of a file, with its place.

    Raises `UserError` if the file cannot be read, has no water there, or the arguments do not fit
    it.

    `points`: control points, of an image.
    """
    require(f"place {path}", "pyogrio", "shapely", "pyproj")
    if not path.is_file():
        raise UserError(f"place {path}: no such file; give a chart, an outline or an image")
    image = path.suffix.lower() in IMAGE_SUFFIXES
    if image != (len(points) == 2) or (points and not image):
        how = "needs --point ROW,COL=LAT,LON twice" if image else "is no image; leave out --point"
        raise UserError(f"place {path}: {how} ({len(points)} given)")
    made = _of_image(path, layout, choice, points) if image else _of_outlines(path, layout, choice)
    place, shares, water, depths, remarks, own = made
    place = replace(
        place,
        share=layout.share,
        source=path.name,
        sha256=_sha256(path),
        licence=licence or own or Place.licence,
    )
    return _with_depths(_finished(place, shares, water, remarks), depths)


_Made = tuple[Place, NDArray[np.float64], Any, Depths | None, list[str], str]


def _of_image(path: Path, layout: Layout, choice: Choice, points: Sequence[Point]) -> _Made:
    if choice.land or choice.pier_width_m or choice.min_depth_m is not None:
        raise UserError(f"place {path}: is an image; leave out --land, --pier-width, --min-depth")
    pixels = image_water(path, choice.water)
    known = Georeference(points, (pixels.shape[0], pixels.shape[1]))
    turned = known.rotation_deg if layout.rotation_deg is None else layout.rotation_deg
    place = _placed(known.corners if layout.crop is None else _corners(layout.crop), turned, layout)
    fine, side = _fine(place), (place.rows, place.columns)
    rows, columns = ((np.arange(n * fine) + 0.5) / fine - 0.5 for n in side)
    cells = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1)
    shares = known.sampled(pixels, place.latlon(cells)).astype(float)
    return place, shares, None, None, _turned_crop(place, layout.crop), ""


def _of_outlines(path: Path, layout: Layout, choice: Choice) -> _Made:
    import shapely

    outlines = read_outlines(path, layout.crop and _wider(layout.crop))
    crop = layout.crop or outlines.bounds
    west, south, east, north = crop or shapely.total_bounds(outlines.shapes)
    span = _corners((west, south, east, north))
    if layout.rotation_deg is None:
        flat = _placed(span, 0.0, layout)
        turned = _along_shore(_framed(outlines.shapes, flat), _box(flat))
    else:
        turned = layout.rotation_deg
    if crop is None:
        span = shapely.get_coordinates(outlines.shapes)
    place = _placed(span, turned, layout, margin=int(crop is None))
    box = _box(place)
    with np.errstate(invalid="ignore"):
        shapes = _framed(outlines.shapes, place)
        damaged = ~shapely.is_valid(shapes)  # the others keep their sense
        shapes[damaged] = shapely.make_valid(shapes[damaged])
    there = np.flatnonzero(shapely.intersects(shapes, box)).tolist()
    outlines = replace(outlines, tags=[outlines.tags[i] for i in there])
    water, depths, remarks = water_of(outlines, shapes[there], choice, box)
    if water.is_empty:
        raise UserError(f"place {path}: has no water there; give another --crop, --water or --land")
    remarks += _turned_crop(place, crop)
    shares = water_shares(water, place.rows, place.columns, place.pitch_m, _fine(place))
    return place, shares, water, depths, remarks, outlines.licence


def _finished(place: Place, fine_shares: NDArray[Any], water: Any, remarks: list[str]) -> GridMap:
    """The largest component of the nodes, and remarks on what else there was."""
    fine = len(fine_shares) // place.rows
    shape = place.rows, fine, place.columns, fine
    shares = fine_shares.reshape(shape).mean(axis=(1, 3))
    nodes = shares >= place.share - 1e-9
    area = float(shares.sum() * place.pitch_m**2)
    if water is not None:
        nodes = without_barriers(nodes, shares, water, place.pitch_m)
    label, sizes = components(nodes, corner_cutting=False)
    if not sizes.size:
        raise UserError(
            f"place: {area:.0f} m2 of water, but no cell of {place.pitch_m:g} m has "
            f"{place.share:g} of it; give a smaller --pitch or --share"
        )
    largest = label == sizes.argmax() + 1
    remarks.append(
        f"water: {area:.0f} m2 of the outlines, {nodes.sum() * place.pitch_m**2:.0f} m2 of the "
        f"cells; of {sizes.size} components the largest stays, with {largest.sum()} of "
        f"{nodes.sum()} nodes"
    )
    remarks += _channels(place, fine_shares > 0.5, largest, water)
    remarks += _borders(place, largest)
    quays = () if water is None else _quays(place, water)
    return GridMap("harbour", largest, replace(place, remarks=tuple(remarks), quays=quays))


def _with_depths(grid: GridMap, depths: Depths | None) -> GridMap:
    """The map with the depths of its nodes, if any is known, and a remark."""
    place = grid.place
    if place is None or depths is None or not depths[0].size:
        return grid
    depth_m = least_depths(*depths, grid.navigable, place.pitch_m)
    known = depth_m[np.isfinite(depth_m)]
    if not known.size:
        return grid
    remark = (
        f"depths of {known.size} of {grid.nodes} nodes, {known.min():g} to {known.max():g} m; "
        "team.NAME.draught_m closes what is too shallow"
    )
    return replace(grid, depth_m=depth_m, place=replace(place, remarks=(*place.remarks, remark)))


def _channels(
    place: Place, fine_water: NDArray[np.bool_], nodes: NDArray[np.bool_], water: Any
) -> list[str]:
    fine = len(fine_water) // place.rows
    found = closed_channels(fine_water, nodes, fine, place.pitch_m / fine)
    lines = []
    for channel in found[:_MOST_NAMED]:
        cell = np.array([channel.row, channel.column]) / fine - 0.5 + 0.5 / fine
        x, y = place.pitch_m * cell[1], place.pitch_m * (place.rows - 1 - cell[0])
        about = channel.width_m
        width = about if water is None else width_at(water, x, y, about)
        lines.append(
            f"the channel at {_named(place, cell)} is {width:.1f} m wide and closed at pitch "
            f"{place.pitch_m:g}; beyond or in it are {channel.area_m2:.0f} m2 of water"
        )
    if len(found) > _MOST_NAMED:
        lines.append(f"{len(found) - _MOST_NAMED} more channels are closed, each with less water")
    return lines


def _borders(place: Place, nodes: NDArray[np.bool_]) -> list[str]:
    """Stretches of the grid's edge beyond which water goes on; vessels and items stay inside."""
    lines = []
    for edge, first, last in open_borders(nodes):
        along = 0 if edge in ("left", "right") else 1
        at = {"upper": 0, "left": 0, "lower": place.rows - 1, "right": place.columns - 1}[edge]
        ends = [(k, at) if along == 0 else (at, k) for k in (first, last)]
        cells = f"{('rows', 'columns')[along]} {first} to {last}"
        lines.append(
            f"open at its {edge} border, {cells}: from {_named(place, ends[0])} to "
            f"{_named(place, ends[1])}"
        )
    return lines


def _named(place: Place, cell: Any) -> str:
    """Latitude and longitude of a cell in words, to a metre."""
    latitude, longitude = place.latlon(cell)
    north, east = "NS"[int(latitude < 0)], "EW"[int(longitude < 0)]
    return f"{abs(latitude):.5f}{north} {abs(longitude):.5f}{east}"


def _quays(place: Place, water: Any) -> tuple[tuple[tuple[float, float], ...], ...]:
    """Closed outlines of the land, without what lies along the place's own edge."""
    import shapely

    land = shapely.difference(_box(place), water)
    smooth = shapely.simplify(land, _SIMPLE_M)
    rings = [shapely.get_coordinates(ring) for ring in shapely.get_parts(shapely.boundary(smooth))]
    return tuple(tuple((float(x), float(y)) for x, y in ring.round(3)) for ring in rings)


def _placed(
    lonlat: NDArray[np.float64], rotation_deg: float, layout: Layout, margin: int = 0
) -> Place:
    """A place about points, whose grid just covers them, and so many cells around them."""
    (west, south), (east, north) = lonlat.min(axis=0), lonlat.max(axis=0)
    pitch_m = layout.pitch_m
    first = Place(0.5 * (south + north), 0.5 * (west + east), pitch_m, 1, 1, rotation_deg)
    low, high = (fun(first.frame(*lonlat.T), axis=0) for fun in (np.min, np.max))
    columns, rows = (max(1, math.ceil(size / pitch_m - 0.01)) + 2 * margin for size in high - low)
    check_size(rows, columns, f"of the place at pitch {pitch_m:g}")
    middle = 0.5 * (low + high) / pitch_m
    latitude, longitude = first.latlon([-middle[1], middle[0]])
    about = round(float(latitude), 9), round(float(longitude), 9)
    return Place(*about, pitch_m, rows, columns, rotation_deg)


def _framed(shapes: Any, place: Place) -> Any:
    """Shapes of longitude and latitude in the frame of a place."""
    import shapely

    return shapely.transform(shapes, lambda xy: place.frame(*xy.T))


def _box(place: Place) -> Any:
    """The grid's rectangle in the frame of its place."""
    import shapely

    half = 0.5 * place.pitch_m
    high = (np.array([place.columns, place.rows]) - 0.5) * place.pitch_m
    return shapely.box(-half, -half, *high)


def _along_shore(shapes: Any, box: Any) -> float:
    """Bearing of the grid's columns along most of the edges, between -45 and 45 [deg].

    Edges vote with their length for their direction modulo a quarter turn.
    """
    import shapely

    votes = 0j
    with np.errstate(invalid="ignore"):
        for shape in shapely.get_parts(shapely.intersection(shapely.make_valid(shapes), box)):
            for part in shapely.get_parts(shapely.boundary(shape) if shape.area else shape):
                way = np.diff(shapely.get_coordinates(part) @ [1.0, 1j])
                way = way[np.abs(way) > 0.0]
                votes += complex((way**4 / np.abs(way) ** 3).sum())
    return -math.degrees(np.angle(votes)) / 4.0 + 0.0


def _corners(box: Box) -> NDArray[np.float64]:
    """(4, 2) longitude and latitude of a box."""
    west, south, east, north = box
    return np.array([(west, south), (west, north), (east, south), (east, north)])


def _wider(box: Box) -> Box:
    """The box in which features are read: a rotated grid reaches beyond its crop."""
    west, south, east, north = box
    wide, tall = east - west, north - south
    stretch = max(math.cos(math.radians(0.5 * (south + north))), 0.01)
    more = 0.5 * max(wide * stretch, tall)
    return west - more / stretch, south - more, east + more / stretch, north + more


def _turned_crop(place: Place, crop: Box | None) -> list[str]:
    """Remark on a crop that a rotated grid reaches beyond."""
    if crop is None or not place.rotation_deg % 90.0:
        return []
    flat = _placed(_corners(crop), 0.0, Layout(place.pitch_m))
    (wide, tall), (width, height) = (
        (one.columns * one.pitch_m, one.rows * one.pitch_m) for one in (place, flat)
    )
    return [
        f"crop: the grid, turned by {place.rotation_deg:.4g} degrees, is {wide:g} x {tall:g} m and "
        f"holds all of the crop's {width:g} x {height:g} m and what is beside it"
    ]


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _fine(place: Place) -> int:
    """Cells of the fine grid along one of the place."""
    return next((k for k in (4, 3, 2) if k * k * place.rows * place.columns <= _FINEST), 1)
