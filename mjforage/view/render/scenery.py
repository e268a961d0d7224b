"""Scenery of a harbour above the water: quays with a kerb, piers, lawns, and buoys at the edge."""

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.physics.scene.quays import DEPTH_M, FREEBOARD_M
from mjforage.physics.scene.rectangles import merged_rectangles

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Edges = NDArray[np.float32]
BEYOND = 12  # land goes on beyond the map's edge for so many cells, then there is sea
BUOY_EVERY_M = 8.0
_KERB_TOP_M = FREEBOARD_M + 0.14
_FINER = 8  # parts of a cell, of which the outermost is the kerb
_PIER_CELLS = 3  # land up to this width is a pier, with planks
_QUAY_CELLS = 3  # width of the paving along the water
_BUOY_M = (0.36, 0.36, 0.45)
_BUOY = (0.96, 0.77, 0.16, 1.0)
_GROUNDS = {  # colour, colour of the joints, lengths of a tile [m]
    "kerb": ((0.93, 0.91, 0.85), (0.80, 0.77, 0.72), (2.0, 2.0)),
    "planks": ((0.72, 0.60, 0.46), (0.56, 0.46, 0.35), (4.0, 0.5)),
    "yard": ((0.68, 0.66, 0.61), (0.62, 0.60, 0.55), (4.0, 4.0)),
    "lawn": ((0.48, 0.57, 0.37), (0.46, 0.55, 0.35), (12.0, 12.0)),
}
_SIDES = (  # of a box: 0 west, south, below; 1 east, north, above; counter-clockwise from outside
    ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    ((1, 1, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1)),
    ((0, 1, 0), (0, 0, 0), (0, 0, 1), (0, 1, 1)),
)
_SEEN: dict[str, int] = {"contype": 0, "conaffinity": 0, "group": 1}


def land_of(navigable: Bools, pitch_m: float, quays: Edges | None, finer: int) -> Bools:
    """(row, column) land of a map in cells `finer` times finer, by its outlines if it has some.

    `quays`: (edge, 4) of closed outlines, as of `Recording`: land is within an odd number of them.
    """
    if quays is None:
        return (~navigable).repeat(finer, axis=0).repeat(finer, axis=1)
    rows, columns = finer * np.array(navigable.shape)
    size, corner = pitch_m / finer, 0.5 * pitch_m
    crossed = np.zeros((rows, columns + 1), np.int32)
    for x0, y0, x1, y1 in quays.astype(np.float64):
        ends = sorted(np.clip(np.ceil((np.array([y0, y1]) + corner) / size - 0.5), 0, rows))
        line = np.arange(int(ends[0]), int(ends[1]))
        if len(line):
            x = x0 + ((line + 0.5) * size - corner - y0) * (x1 - x0) / (y1 - y0)
            column = np.clip(np.ceil((x + corner) / size - 0.5), 0, columns).astype(np.int64)
            crossed[rows - 1 - line, column] += 1
    return np.asarray(crossed.cumsum(axis=1)[:, :-1] % 2 == 1)


def add_scenery(
    spec: mujoco.MjSpec, navigable: Bools, pitch_m: float, quays: Edges | None = None
) -> None:
    """Add the static scenery of a map, see `land_of`; nothing of it collides."""
    finer, corner = pitch_m / _FINER, (BEYOND + 0.5) * pitch_m
    edge = corner + (len(navigable) - 1) * pitch_m  # northern
    land = land_of(navigable, pitch_m, quays, _FINER)
    for name, part, top_m in _grounds(np.pad(land, BEYOND * _FINER, mode="edge")):
        if part.any():
            top, left, bottom, right = finer * merged_rectangles(part).T
            low, high = edge - bottom, edge - top
            _add_boxes(spec, name, left - corner, low, right - corner, high, top_m)
    for x, y in buoy_places(navigable, pitch_m):
        buoy = mujoco.mjtGeom.mjGEOM_ELLIPSOID
        spec.worldbody.add_geom(type=buoy, pos=(x, y, 0.2), size=_BUOY_M, rgba=_BUOY, **_SEEN)


def _grounds(fine: Bools) -> Iterator[tuple[str, Bools, float]]:
    """Material, cells, and height [m] of each kind of ground, of land in cells as fine."""
    shape = len(fine) // _FINER, _FINER, fine.shape[1] // _FINER, _FINER
    land = np.asarray(fine.reshape(shape).any(axis=(1, 3)))
    block = np.ones((_PIER_CELLS + 1,) * 2, np.bool_)
    pier = land & ~ndimage.binary_opening(land, block)
    room = ndimage.distance_transform_cdt(np.pad(land, 1, mode="edge"), "chessboard")[1:-1, 1:-1]
    lawn = room > _QUAY_CELLS
    kerb = fine & ~ndimage.binary_erosion(fine, np.ones((3, 3), np.bool_), border_value=1)
    yield "kerb", kerb, _KERB_TOP_M
    for name, part in (("planks", pier), ("lawn", lawn), ("yard", land & ~pier & ~lawn)):
        there = part.repeat(_FINER, axis=0).repeat(_FINER, axis=1)
        yield name, there & fine & ~kerb, FREEBOARD_M


def _add_boxes(
    spec: mujoco.MjSpec,
    name: str,
    west: Floats,
    south: Floats,
    east: Floats,
    north: Floats,
    z: float,
) -> None:
    """Boxes (n,) from the bottom of a quay to `z` as one mesh; every side has its own corners."""
    x, y = np.stack((west, east)), np.stack((south, north))
    sides = np.array(_SIDES)  # (side, corner, axis)
    heights = np.broadcast_to(
        np.where(sides[..., 2], z, -DEPTH_M)[..., None], (*sides.shape[:2], len(west))
    )
    corners = np.stack((x[sides[..., 0]], y[sides[..., 1]], heights), axis=-1).reshape(-1, 3)
    first = np.arange(sides.size // 3 * len(west)).reshape(len(sides), 4, len(west))
    faces = np.concatenate((first[:, [0, 1, 2]], first[:, [0, 2, 3]]))
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert, mesh.userface = corners.reshape(-1), faces.transpose(0, 2, 1).reshape(-1)
    mesh.usertexcoord = (corners[:, :2] / _GROUNDS[name][2]).reshape(-1)
    _add_material(spec, name)
    kind = mujoco.mjtGeom.mjGEOM_MESH
    spec.worldbody.add_geom(type=kind, meshname=name, material=name, **_SEEN)


def _add_material(spec: mujoco.MjSpec, name: str) -> None:
    """A material of tiles with joints."""
    flat, plane = mujoco.mjtBuiltin.mjBUILTIN_FLAT, mujoco.mjtTexture.mjTEXTURE_2D
    texture = spec.add_texture(name=name, type=plane, builtin=flat, width=64, height=64, nchannel=3)
    texture.mark, (texture.rgb1, texture.markrgb, _) = mujoco.mjtMark.mjMARK_EDGE, _GROUNDS[name]
    material = spec.add_material(name=name, specular=0.05, shininess=0.1)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name


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
        at = np.arange(0.5 * BUOY_EVERY_M, len(water) * pitch_m, BUOY_EVERY_M)
        wet = water[np.minimum((at / pitch_m).astype(np.int64), len(water) - 1)]
        found.append(np.array(start) * pitch_m + at[wet][:, None] * np.array(along))
    return np.concatenate(found)
