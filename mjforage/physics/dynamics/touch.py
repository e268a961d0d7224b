"""Contacts of vessels with quays and each other, and their speeds: boxes in the plane.

Two convex boxes touch unless one of their four axes separates them (separating axis theorem); the
axis of least overlap is taken as the direction of the contact.
"""

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.wholes import floor
from mjforage.controllers.chart import (
    WALL_M,
    LandArray,
    framed_is_land,
    grid_shape,
    has_walls,
    wall_at,
    walls_at,
)

TOLERANCE_M = 0.005  # a gap below this counts as a touch: a hull that slides is lifted so far
CORNER_M = 0.05  # corners this much farther than the deepest one are in the contact too
PARALLEL_M = 1e-6  # overlaps that differ by less are those of parallel sides
FloatArray = NDArray[np.float64]
Triple: TypeAlias = tuple[float, float, float] | FloatArray
Pair: TypeAlias = tuple[float, float] | FloatArray


@inlined
def _reach(ax: float, ay: float, yaw: float, half_length: float, half_beam: float) -> float:
    """Half the width of a box along the unit axis (ax, ay)."""
    c, s = math.cos(yaw), math.sin(yaw)
    return half_length * abs(c * ax + s * ay) + half_beam * abs(c * ay - s * ax)


@kernel
def contact(a: Triple, b: Triple, size_a: Pair, size_b: Pair) -> tuple[bool, float, float, bool]:
    """Contact of boxes a and b: True if they touch, unit normal from b to a, True if of a's side.

    `a`, `b`: x, y [m], yaw [rad]; `size_a`, `size_b`: half length, half beam [m].
    """
    least, nx, ny, of_a = np.inf, 0.0, 0.0, False
    dx, dy = a[0] - b[0], a[1] - b[1]
    for axis in range(4):
        angle = (b[2] if axis < 2 else a[2]) + 0.5 * math.pi * (axis % 2)
        ux, uy = math.cos(angle), math.sin(angle)
        apart = dx * ux + dy * uy
        overlap = (
            _reach(ux, uy, a[2], size_a[0], size_a[1])
            + _reach(ux, uy, b[2], size_b[0], size_b[1])
            - abs(apart)
        )
        if overlap < -TOLERANCE_M:
            return False, 0.0, 0.0, False
        if overlap < least - PARALLEL_M:  # of parallel sides b's is taken
            sign = 1.0 if apart >= 0.0 else -1.0
            least, nx, ny, of_a = overlap, sign * ux, sign * uy, axis >= 2
    return True, nx, ny, of_a


@inlined
def _corner(box: Triple, size: Pair, number: int) -> tuple[float, float]:
    """One of the four corners of a box."""
    along = size[0] if number & 1 else -size[0]
    aside = size[1] if number & 2 else -size[1]
    c, s = math.cos(box[2]), math.sin(box[2])
    return box[0] + c * along - s * aside, box[1] + s * along + c * aside


@inlined
def _speed_at(pose: Triple, velocity: Triple, px: float, py: float) -> tuple[float, float]:
    """Velocity of the vessel's point at (px, py)."""
    return (
        velocity[0] - velocity[2] * (py - pose[1]),
        velocity[1] + velocity[2] * (px - pose[0]),
    )


@kernel
def closing_speed(
    a: Triple,
    b: Triple,
    velocity_a: Triple,
    velocity_b: Triple,
    size_a: Pair,
    size_b: Pair,
    nx: float,
    ny: float,
    of_a: bool,
) -> float:
    """Fastest approach [m/s] of what touches along the normal (nx, ny): a corner, or the ends of
    the stretch in which an edge lies along the other box's side.

    Parameters
    ----------
    velocity_a, velocity_b : world axes [m/s], [rad/s]
    of_a : True if the normal belongs to a side of a: corners of b touch it, else those of a
    """
    deepest, fastest = np.inf, -np.inf
    sign = -1.0 if of_a else 1.0  # towards the other box
    tx, ty = -ny, nx  # along the side, which reaches `half` both ways from its box's middle
    side, size = (a, size_a) if of_a else (b, size_b)
    half = _reach(tx, ty, side[2], size[0], size[1])
    for number in range(4):
        px, py = _corner(b, size_b, number) if of_a else _corner(a, size_a, number)
        deepest = min(deepest, sign * (px * nx + py * ny))
    for number in range(4):
        px, py = _corner(b, size_b, number) if of_a else _corner(a, size_a, number)
        if sign * (px * nx + py * ny) < deepest + CORNER_M:
            along = (px - side[0]) * tx + (py - side[1]) * ty
            beyond = along - min(max(along, -half), half)
            px, py = px - beyond * tx, py - beyond * ty
            ux, uy = _speed_at(a, velocity_a, px, py)
            vx, vy = _speed_at(b, velocity_b, px, py)
            fastest = max(fastest, -((ux - vx) * nx + (uy - vy) * ny))
    return fastest


@kernel
def _open_side(
    land: LandArray, i: int, j: int, nx: float, ny: float, own: bool
) -> tuple[float, float, bool]:
    """The normal of a vessel's touch of a land cell, at seams that of the quay that cells make up.

    A side between two cells is none of the quay, and their corners are none unless they jut out:
    the open side beside them counts, if there is one; else nothing, for a neighbour is touched too.

    Returns: the same three; a normal of 0 where the cell has no open side there.

    `land`, `i`, `j`: the cell, counted as by `framed_is_land`; `nx`, `ny`, `own`: as of `contact`.
    """
    east, north = (1 if nx > 0.0 else -1), (1 if ny > 0.0 else -1)
    by_x = abs(nx) > 1e-9 and not framed_is_land(land, i + east, j)
    by_y = abs(ny) > 1e-9 and not framed_is_land(land, i, j + north)
    if own and by_x and by_y:
        return nx, ny, own
    if by_x:
        return float(east), 0.0, False
    return 0.0, float(north) if by_y else 0.0, False


@kernel
def _touch_quays(
    pose: Triple, velocity: Triple, size: Pair, land: LandArray, pitch_m: float
) -> tuple[bool, float]:
    """Contact of one vessel with land: True if it touches, fastest approach [m/s], at least 0."""
    columns, rows = grid_shape(land)
    half, still = (0.5 * pitch_m, 0.5 * pitch_m), (0.0, 0.0, 0.0)
    touching, closing = False, 0.0
    wide = math.hypot(size[0], size[1])
    low_i = floor((pose[0] - wide) / pitch_m + 0.5) + 1
    high_i = floor((pose[0] + wide) / pitch_m + 0.5) + 1
    low_j = floor((pose[1] - wide) / pitch_m + 0.5) + 1
    high_j = floor((pose[1] + wide) / pitch_m + 0.5) + 1
    for j in range(max(0, low_j), min(rows, high_j + 1)):
        for i in range(max(0, low_i), min(columns, high_i + 1)):
            if has_walls(land):
                hit, speed = _touch_walls(pose, velocity, size, land, i, j)
                touching, closing = touching or hit, max(closing, speed)
                if 0 < i < columns - 1 and 0 < j < rows - 1:
                    continue  # the frame alone has no walls
            if not framed_is_land(land, i, j):
                continue
            cell = (i - 1) * pitch_m, (j - 1) * pitch_m, 0.0
            hit, nx, ny, own = contact(pose, cell, size, half)
            if hit:
                touching = True
                nx, ny, own = _open_side(land, i, j, nx, ny, own)
                if nx != 0.0 or ny != 0.0:
                    speed = closing_speed(pose, cell, velocity, still, size, half, nx, ny, own)
                    closing = max(closing, speed)
    return touching, closing


@inlined
def _triple(rows: FloatArray, v: int) -> Triple:
    """Row `v` of (vessel, 3)."""
    return rows[v, 0], rows[v, 1], rows[v, 2]


@kernel
def _touch_walls(
    pose: Triple, velocity: Triple, size: Pair, land: LandArray, i: int, j: int
) -> tuple[bool, float]:
    """As `_touch_quays`, of the walls of a cell."""
    touching, closing, still = False, 0.0, (0.0, 0.0, 0.0)
    for k in walls_at(land, i, j):
        x, y, c, s, half_length = wall_at(land, k)
        wall, half = (x, y, math.atan2(s, c)), (half_length, WALL_M)
        hit, nx, ny, own = contact(pose, wall, size, half)
        if hit:
            touching = True
            speed = closing_speed(pose, wall, velocity, still, size, half, nx, ny, own)
            closing = max(closing, speed)
    return touching, closing


@kernel
def touches(
    pose: FloatArray,
    velocity: FloatArray,
    size: FloatArray,
    land: LandArray,
    pitch_m: float,
    touching: NDArray[np.bool_],
    closing: FloatArray,
) -> None:
    """Contacts of the vessels of one episode with quays, the map's edge and each other.

    MuJoCo's contact sensors do not give this: they know no speed.

    Parameters
    ----------
    pose : (vessel, 3) x, y [m], yaw [rad] now, as contacts have it (`Simulation.contact_pose`)
    velocity : (vessel, 3) over ground, world axes, before the contact acts [m/s], [rad/s]
    size : (vessel, 2) half length, half beam [m]
    land : of a chart; walls, if it has some, are the quays in the place of the cells
    touching, closing : (vessel,) written: in contact, and the fastest approach [m/s]
    """
    for v in range(pose.shape[0]):
        a, moves, size_a = _triple(pose, v), _triple(velocity, v), (size[v, 0], size[v, 1])
        touching[v], closing[v] = _touch_quays(a, moves, size_a, land, pitch_m)
        wide = math.hypot(size[v, 0], size[v, 1])
        for w in range(v):
            reach = wide + math.hypot(size[w, 0], size[w, 1])
            if math.hypot(pose[v, 0] - pose[w, 0], pose[v, 1] - pose[w, 1]) > reach:
                continue
            b, other, size_b = _triple(pose, w), _triple(velocity, w), (size[w, 0], size[w, 1])
            hit, nx, ny, own = contact(a, b, size_a, size_b)
            if hit:
                touching[v] = touching[w] = True
                speed = closing_speed(a, b, moves, other, size_a, size_b, nx, ny, own)
                closing[v], closing[w] = max(closing[v], speed), max(closing[w], speed)
