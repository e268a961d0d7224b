"""Sheds with pitched roofs on the land behind the quays, so that it looks like a port."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mjforage.physics.scene.quays import FREEBOARD_M
from mjforage.view.render.harbour import PaddedLand, Shape, joined, quads

Floats = NDArray[np.float64]
_OFF_CELLS = 3  # between a shed and the water, at least
_EVERY_CELLS = 6
_ROOF_M = 1.6  # from eaves to ridge
_OVERHANG_M = 0.4
_SEED = 5
_WALL_V, _ROOF_V = 0.25, 0.75  # where their colours lie in the palette
_Corner = tuple[float, float, float]


def shed_boxes(ground: PaddedLand) -> Floats:
    """(n, 5) west, south, east, north [m] of sheds, and the height of their walls [m]."""
    room = ndimage.distance_transform_cdt(np.pad(ground.land, 1), "chessboard")[1:-1, 1:-1]
    random = np.random.Generator(np.random.PCG64(_SEED))
    found = []
    rows, columns = ground.land.shape
    for row in range(2, rows - 2, _EVERY_CELLS):
        for column in range(2, columns - 2, _EVERY_CELLS):
            draw = random.random(4)
            if room[row, column] <= _OFF_CELLS or draw[0] < 0.3:
                continue
            x = float(ground.x(np.array(column))) + 0.5 * ground.pitch_m
            y = float(ground.y(np.array(row))) - 0.5 * ground.pitch_m
            half = (5.0 + 4.0 * draw[1], 4.0 + 2.5 * draw[2])
            along, across = half if draw[3] < 0.5 else half[::-1]
            found.append((x - along, y - across, x + along, y + across, 2.6 + 1.6 * draw[2]))
    return np.array(found, np.float64).reshape(-1, 5)


def shed_shape(boxes: Floats, colours: int) -> Shape:
    """Walls and roofs; u picks one of `colours` columns of a palette, v wall or roof."""
    parts = []
    for number, (w, s, e, n, wall) in enumerate(boxes.tolist()):
        # Built with the ridge along x; a shed that is longer along y is turned.
        turned = n - s > e - w
        half_long, half_wide = 0.5 * max(e - w, n - s), 0.5 * min(e - w, n - s)
        walls, roofs = _faces(half_long, half_wide, wall)
        u = (number % colours + 0.5) / colours
        for faces, v in ((walls, _WALL_V), (roofs, _ROOF_V)):
            corners = np.array(faces, np.float64)
            if turned:
                corners[..., :2] = np.stack((-corners[..., 1], corners[..., 0]), axis=-1)
            corners += (0.5 * (w + e), 0.5 * (s + n), FREEBOARD_M)
            parts.append(quads(corners, np.broadcast_to([u, v], (*corners.shape[:2], 2))))
    return joined(tuple(parts))


def _faces(
    x: float, y: float, wall: float
) -> tuple[Sequence[Sequence[_Corner]], Sequence[Sequence[_Corner]]]:
    """Walls with gables, and roofs, of a shed of half sizes `x` and `y` around the origin."""
    ridge = wall + _ROOF_M
    floor = ((-x, -y), (x, -y), (x, y), (-x, y))
    walls = [
        ((*a, 0.0), (*b, 0.0), (*b, wall), (*a, wall))
        for a, b in zip(floor, (*floor[1:], floor[0]), strict=True)
    ]
    walls.append(((x, -y, wall), (x, y, wall), (x, 0.0, ridge), (x, 0.0, ridge)))
    walls.append(((-x, y, wall), (-x, -y, wall), (-x, 0.0, ridge), (-x, 0.0, ridge)))
    # The roof passes over the top of the wall, so its eaves lie lower.
    eaves, out, wide = wall - _ROOF_M * _OVERHANG_M / y, x + _OVERHANG_M, y + _OVERHANG_M
    roofs = [
        ((-out, -wide, eaves), (out, -wide, eaves), (out, 0.0, ridge), (-out, 0.0, ridge)),
        ((out, wide, eaves), (-out, wide, eaves), (-out, 0.0, ridge), (out, 0.0, ridge)),
    ]
    return walls, roofs
