"""The shapes of a harbour above the water: quay tops, coping, walls, bollards and buoys.

Plain arrays from the map; OpenGL is not needed. Positions are metres in the world's frame.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.physics.scene.quays import FREEBOARD_M
from mjforage.physics.scene.rectangles import merged_rectangles

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
KERB_TOP_M = FREEBOARD_M + 0.14
BEYOND = 12  # land goes on beyond the map's edge for so many cells, then there is sea
KERB_M = 0.45  # width of the coping along the water
WALL_BOTTOM_M = -1.0
PIER_CELLS = 3  # land up to this width is a pier, with planks
BOLLARD_EVERY = 3  # cells
BUOY_EVERY_M = 8.0
_QUAY_CELLS = 3  # width of the paving along the water
_SIDES = 8  # of a round post


@dataclass(frozen=True, eq=False)
class Shape:
    """Triangles with texture coordinates; every quad has corners of its own, so edges are sharp."""

    vertices: Floats  # (v, 3) [m]
    faces: NDArray[np.int32]  # (f, 3)
    uv: Floats  # (v, 2) in textures


@dataclass(frozen=True)
class PaddedLand:
    """The map with land carried on beyond its edge.

    Attributes
    ----------
    land : (row, column) bool, `BEYOND` cells larger than the map on every side
    pitch_m : side of a cell
    rows, columns : of the map
    """

    land: Bools
    pitch_m: float
    rows: int
    columns: int

    @classmethod
    def of(cls, navigable: Bools, pitch_m: float) -> "PaddedLand":
        """Continue the outermost cells of the map outwards."""
        return cls(np.pad(~navigable, BEYOND, mode="edge"), pitch_m, *navigable.shape)

    def x(self, column: NDArray[np.int64]) -> Floats:
        """West side of columns of `land` [m]."""
        return np.asarray((column - BEYOND - 0.5) * self.pitch_m, np.float64)

    def y(self, row: NDArray[np.int64]) -> Floats:
        """North side of rows of `land` [m]."""
        return np.asarray((self.rows - 0.5 - (row - BEYOND)) * self.pitch_m, np.float64)

    def is_land(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> Bools:
        """Whether cells are land; beyond `land` there is sea."""
        rows, columns = self.land.shape
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        found: Bools = inside & self.land[row.clip(0, rows - 1), column.clip(0, columns - 1)]
        return found


def quads(corners: Floats, uv: Floats) -> Shape:
    """Shape of (n, 4, 3) corners, counter-clockwise seen from outside, with (n, 4, 2) texture."""
    count = len(corners)
    first = 4 * np.arange(count, dtype=np.int32)[:, None]
    faces = np.concatenate((first + np.array([0, 1, 2]), first + np.array([0, 2, 3])))
    return Shape(corners.reshape(-1, 3), faces.astype(np.int32), uv.reshape(-1, 2))


def flat_quads(boxes: Floats, z: float, tile_m: float) -> Shape:
    """Level rectangles (n, 4) as west, south, east, north; the texture lies fast in the world."""
    w, s, e, n = boxes.T
    xy = np.stack((np.stack((w, e, e, w), -1), np.stack((s, s, n, n), -1)), -1)
    corners = np.concatenate((xy, np.full((*xy.shape[:2], 1), z)), axis=-1)
    return quads(corners, xy / tile_m)


def piers(ground: PaddedLand) -> Bools:
    """(row, column) land that is nowhere wider than `PIER_CELLS`."""
    block = np.ones((PIER_CELLS + 1,) * 2, np.bool_)
    wide = ndimage.binary_opening(np.pad(ground.land, PIER_CELLS + 1, mode="edge"), block)
    cut = slice(PIER_CELLS + 1, -PIER_CELLS - 1)
    result: Bools = ground.land & ~wide[cut, cut]
    return result


def inland(ground: PaddedLand) -> Bools:
    """(row, column) land behind the quays, at least `_QUAY_CELLS` from water."""
    room = ndimage.distance_transform_cdt(np.pad(ground.land, 1, mode="edge"), "chessboard")
    result: Bools = room[1:-1, 1:-1] > _QUAY_CELLS
    return result


def tops(ground: PaddedLand, cells: Bools, tile_m: float) -> Shape:
    """Quay tops of the given cells."""
    box = merged_rectangles(cells)
    sides = (ground.x(box[:, 1]), ground.y(box[:, 2]), ground.x(box[:, 3]), ground.y(box[:, 0]))
    return flat_quads(np.column_stack(sides), FREEBOARD_M, tile_m)


_AROUND = ((-1, 0), (0, 1), (1, 0), (0, -1))  # north, east, south, west


def shoreline(ground: PaddedLand) -> tuple[Floats, NDArray[np.int64]]:
    """Sides of land cells that face water.

    Returns
    -------
    (n, 2, 2) ends, x and y, with the water on the right hand; (n,) side: 0 north, 1 east, ...
    """
    row, column = (axis.astype(np.int64) for axis in np.nonzero(ground.land))
    ends, sides = [], []
    for side, (down, right) in enumerate(_AROUND):
        wet = ~ground.is_land(row + down, column + right)
        r, c = row[wet], column[wet]
        west, east, north, south = ground.x(c), ground.x(c + 1), ground.y(r), ground.y(r + 1)
        start, end = (
            ((east, north), (west, north)),
            ((east, south), (east, north)),
            ((west, south), (east, south)),
            ((west, north), (west, south)),
        )[side]
        ends.append(np.stack((np.column_stack(start), np.column_stack(end)), axis=1))
        sides.append(np.full(len(r), side))
    return np.concatenate(ends), np.concatenate(sides)


def _inward(ends: Floats) -> Floats:
    """(n, 2) unit vectors from the water to the land."""
    along = ends[:, 1] - ends[:, 0]
    unit = along / np.linalg.norm(along, axis=1, keepdims=True)
    return np.column_stack((-unit[:, 1], unit[:, 0]))


def walls(ends: Floats, tile_m: float) -> Shape:
    """Quay walls down into the water; the texture's height is the wall's."""
    z = (WALL_BOTTOM_M, WALL_BOTTOM_M, KERB_TOP_M, KERB_TOP_M)
    order = (0, 1, 1, 0)
    corners = np.stack(
        [
            np.column_stack((ends[:, o], np.full(len(ends), h)))
            for o, h in zip(order, z, strict=True)
        ],
        axis=1,
    )
    along = ends.sum(axis=2) / tile_m  # x or y is constant along a side, so the sum runs along it
    u = np.stack([along[:, o] for o in order], axis=1)
    v = np.tile([0.0, 0.0, 1.0, 1.0], (len(ends), 1))
    return quads(corners, np.stack((u, v), axis=-1))


def kerbs(ground: PaddedLand, ends: Floats, tile_m: float) -> Shape:
    """Coping along the water: its top, its inner face, and the squares at inner corners."""
    inner = ends + KERB_M * _inward(ends)[:, None]
    low = np.minimum(ends.min(axis=1), inner.min(axis=1))
    high = np.maximum(ends.max(axis=1), inner.max(axis=1))
    boxes = np.concatenate((np.hstack((low, high)), _corner_boxes(ground)))
    top = flat_quads(boxes, KERB_TOP_M, tile_m)
    back = inner[:, ::-1]
    z = (FREEBOARD_M, FREEBOARD_M, KERB_TOP_M, KERB_TOP_M)
    corners = np.stack(
        [
            np.column_stack((back[:, o], np.full(len(back), h)))
            for o, h in zip((0, 1, 1, 0), z, strict=True)
        ],
        axis=1,
    )
    return joined((top, quads(corners, corners[..., :2] / tile_m)))


def _corner_boxes(ground: PaddedLand) -> Floats:
    """Squares where only the diagonal neighbour of a land cell is water."""
    row, column = (axis.astype(np.int64) for axis in np.nonzero(ground.land))
    boxes = []
    for down in (-1, 1):
        for right in (-1, 1):
            beside = ground.is_land(row + down, column) & ground.is_land(row, column + right)
            found = beside & ~ground.is_land(row + down, column + right)
            x = ground.x(column[found] + (right > 0))
            y = ground.y(row[found] + (down > 0))
            other_x, other_y = x - right * KERB_M, y + down * KERB_M
            boxes.append(
                np.column_stack(
                    (
                        np.minimum(x, other_x),
                        np.minimum(y, other_y),
                        np.maximum(x, other_x),
                        np.maximum(y, other_y),
                    )
                )
            )
    return np.concatenate(boxes)


def joined(shapes: tuple[Shape, ...]) -> Shape:
    """One shape of several."""
    offsets = np.cumsum([0] + [len(shape.vertices) for shape in shapes[:-1]])
    faces = [shape.faces + np.int32(o) for shape, o in zip(shapes, offsets, strict=True)]
    return Shape(
        np.concatenate([shape.vertices for shape in shapes]),
        np.concatenate(faces),
        np.concatenate([shape.uv for shape in shapes]),
    )


def posts(places: Floats, rings: tuple[tuple[float, float], ...], uv: tuple[float, float]) -> Shape:
    """Round posts at places (n, 2), each through the given (radius, z) rings, closed above."""
    angle = 2.0 * np.pi * np.arange(_SIDES + 1) / _SIDES
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    sides = []
    for (r0, z0), (r1, z1) in pairwise(rings):
        low = np.column_stack((r0 * circle, np.full(len(circle), z0)))
        high = np.column_stack((r1 * circle, np.full(len(circle), z1)))
        sides.append(np.stack((low[:-1], low[1:], high[1:], high[:-1]), axis=1))
    one = np.concatenate(sides)  # (quad, 4, 3)
    at = np.column_stack((places, np.zeros(len(places))))
    corners = (one[None] + at[:, None, None]).reshape(-1, 4, 3)
    return quads(corners, np.broadcast_to(np.array(uv), (*corners.shape[:2], 2)))


BOLLARD = ((0.17, 0.0), (0.11, 0.12), (0.11, 0.34), (0.2, 0.38), (0.2, 0.46), (0.0, 0.5))
BUOY = ((0.0, -0.3), (0.34, -0.1), (0.36, 0.15), (0.16, 0.32), (0.1, 0.75), (0.0, 0.8))


def bollard_places(ends: Floats) -> Floats:
    """(n, 2) on the kerb, in the middle of every third cell's side."""
    middle = ends.mean(axis=1) + 0.5 * KERB_M * _inward(ends)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    chosen = np.rint(ends.mean(axis=1).sum(axis=1) / length).astype(np.int64) % BOLLARD_EVERY == 0
    found: Floats = middle[chosen]
    return found


def buoy_places(navigable: Bools, pitch_m: float) -> Floats:
    """(n, 2) along the map's edge, where it lies on water: vessels cannot leave there."""
    rows, columns = navigable.shape
    edges = (
        (navigable[0], (-0.5, rows - 0.5), (1.0, 0.0)),
        (navigable[-1], (-0.5, -0.5), (1.0, 0.0)),
        (navigable[::-1, 0], (-0.5, -0.5), (0.0, 1.0)),
        (navigable[::-1, -1], (columns - 0.5, -0.5), (0.0, 1.0)),
    )
    found = []
    for water, start, along in edges:
        length = len(water) * pitch_m
        at = np.arange(0.5 * BUOY_EVERY_M, length, BUOY_EVERY_M)
        wet = water[np.minimum((at / pitch_m).astype(np.int64), len(water) - 1)]
        found.append(np.array(start) * pitch_m + at[wet][:, None] * np.array(along))
    return np.concatenate(found)
