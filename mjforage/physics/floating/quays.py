"""An item against quays, as MuJoCo's solver has it: soft contacts of a sphere, without friction.

Equations of MuJoCo's documentation, chapters "Computation" and "Modeling: Solver parameters". The
cells that an item touches at once are at right angles, so that each contact is solved by itself;
walls at other angles are so one after the other.
"""

import math
from typing import NamedTuple

import mujoco

from mjforage.base.compiled import inlined, kernel
from mjforage.base.wholes import floor
from mjforage.controllers.chart import (
    WALL_M,
    LandArray,
    framed_is_land,
    grid_shape,
    is_open,
    walls_at,
    way_to_wall,
)

_LEAST = 1e-15  # MuJoCo's mjMINVAL


class Quays(NamedTuple):
    """Land, and the softness of a contact with it."""

    land: LandArray  # as `controllers.Chart.land`
    pitch_m: float
    radius_m: float  # of an item
    stiffness: float  # k of the reference acceleration -b v - k d r [1/s2]
    damping: float  # b of it [1/s]
    d_0: float  # impedance d of a contact that just begins
    d_width: float  # and of one of a depth of `width_m` and more
    width_m: float
    midpoint: float
    power: float
    mobility: float  # inverse mass that MuJoCo takes for the softness of contacts [1/kg]


def quays_of(model: mujoco.MjModel, item: int, land: LandArray, pitch_m: float) -> Quays:
    """Quays for the items of a model.

    Parameters
    ----------
    model : prepared for its time step
    item : number of the body of an item in it
    land, pitch_m : as in `Quays`
    """
    geom = int(model.body_geomadr[item])
    lag_s, ratio = model.geom_solref[geom]
    lag_s = max(lag_s, 2.0 * model.opt.timestep)  # MuJoCo's own safeguard
    d_0, d_width, width_m, midpoint, power = (float(v) for v in model.geom_solimp[geom])
    return Quays(
        land,
        pitch_m,
        float(model.geom_size[geom, 0]),
        1.0 / max(_LEAST, (d_width * lag_s * ratio) ** 2),
        2.0 / max(_LEAST, d_width * lag_s),
        d_0,
        d_width,
        width_m,
        midpoint,
        power,
        float(model.body_invweight0[item, 0]),
    )


@kernel
def impedance(quays: Quays, depth_m: float) -> float:
    """Impedance d of a contact, from `d_0` at no depth to `d_width` at `width_m`."""
    share = depth_m / quays.width_m
    if share >= 1.0:
        return quays.d_width
    if share <= quays.midpoint:
        y = share**quays.power / quays.midpoint ** (quays.power - 1.0)
    else:
        left = 1.0 - quays.midpoint
        y = 1.0 - (1.0 - share) ** quays.power / left ** (quays.power - 1.0)
    return float(quays.d_0 + y * (quays.d_width - quays.d_0))


@kernel
def push(quays: Quays, depth_m: float, speed: float, free: float, mass_kg: float) -> float:
    """Acceleration away from the quay that a contact adds [m/s2].

    Parameters
    ----------
    depth_m : depth of the item in the quay
    speed, free : its velocity [m/s] and its acceleration without the contact [m/s2], away from it
    """
    if depth_m <= 0.0:
        return 0.0
    d = impedance(quays, depth_m)
    missing = quays.stiffness * d * depth_m - quays.damping * speed - free
    if missing <= 0.0:
        return 0.0
    return missing / (1.0 + max(_LEAST, quays.mobility * (1.0 - d) / d) * mass_kg)


@inlined
def is_clear(land: LandArray, pitch_m: float, radius_m: float, x: float, y: float) -> bool:
    """True if an item at (x, y) [m] touches nothing, since it is amid the water of its cell."""
    i, j = floor(x / pitch_m + 0.5), floor(y / pitch_m + 0.5)
    off = max(abs(x - i * pitch_m), abs(y - j * pitch_m))
    columns, rows = grid_shape(land)
    inside = 0 <= i < columns - 2 and 0 <= j < rows - 2
    return bool(off <= 0.5 * pitch_m - radius_m and inside and is_open(land, i + 1, j + 1))


@kernel
def beside_quays(
    quays: Quays, x: float, y: float, vx: float, vy: float, ax: float, ay: float, mass_kg: float
) -> tuple[float, float]:
    """Acceleration [m/s2] of an item with its contacts, from that without them.

    Parameters
    ----------
    x, y, vx, vy : its position [m] and velocity over ground [m/s]
    ax, ay : its acceleration without contacts [m/s2]
    """
    land, pitch, radius = quays.land, quays.pitch_m, quays.radius_m
    i, j = floor(x / pitch + 0.5), floor(y / pitch + 0.5)
    off_x, off_y = x - i * pitch, y - j * pitch
    side_x, side_y = 1 if off_x > 0.0 else -1, 1 if off_y > 0.0 else -1
    gap_x, gap_y = 0.5 * pitch - abs(off_x), 0.5 * pitch - abs(off_y)
    i, j = i + 1, j + 1  # of the frame
    columns, rows = grid_shape(land)
    if not (0 <= i < columns and 0 <= j < rows):
        return ax, ay
    if framed_is_land(land, i, j):
        return _off_land(quays, i, j, off_x, off_y, vx, vy, ax, ay, mass_kg)
    by_x, by_y = framed_is_land(land, i + side_x, j), framed_is_land(land, i, j + side_y)
    if by_x:
        ax -= side_x * push(quays, radius - gap_x, -side_x * vx, -side_x * ax, mass_kg)
    if by_y:
        ay -= side_y * push(quays, radius - gap_y, -side_y * vy, -side_y * ay, mass_kg)
    if not by_x and not by_y and framed_is_land(land, i + side_x, j + side_y):
        gap = math.sqrt(gap_x * gap_x + gap_y * gap_y)
        if 0.0 < gap < radius:
            nx, ny = -side_x * gap_x / gap, -side_y * gap_y / gap
            more = push(quays, radius - gap, nx * vx + ny * vy, nx * ax + ny * ay, mass_kg)
            ax, ay = ax + nx * more, ay + ny * more
    for k in walls_at(land, i, j):
        to_x, to_y, beyond = way_to_wall(land, k, x, y)
        gap = math.hypot(to_x, to_y)
        if 0.0 < gap < radius + WALL_M and beyond < 0.0:  # the next wall has its end
            nx, ny = -to_x / gap, -to_y / gap
            speed, free = nx * vx + ny * vy, nx * ax + ny * ay
            more = push(quays, radius + WALL_M - gap, speed, free, mass_kg)
            ax, ay = ax + nx * more, ay + ny * more
    return ax, ay


@kernel
def _off_land(
    quays: Quays,
    i: int,
    j: int,
    off_x: float,
    off_y: float,
    vx: float,
    vy: float,
    ax: float,
    ay: float,
    mass_kg: float,
) -> tuple[float, float]:
    """Acceleration of an item whose middle is in land: out by the nearest side with water."""
    land, half, least, nx, ny = quays.land, 0.5 * quays.pitch_m, math.inf, 0, 0
    columns, rows = grid_shape(land)
    for side in (1, -1):
        west_east = 0 <= i + side < columns and not framed_is_land(land, i + side, j)
        if west_east and half - side * off_x < least:
            least, nx, ny = half - side * off_x, side, 0
        south_north = 0 <= j + side < rows and not framed_is_land(land, i, j + side)
        if south_north and half - side * off_y < least:
            least, nx, ny = half - side * off_y, 0, side
    if nx == 0 and ny == 0:
        return ax, ay
    speed, free = nx * vx + ny * vy, nx * ax + ny * ay
    more = push(quays, least + quays.radius_m, speed, free, mass_kg)
    return ax + nx * more, ay + ny * more
