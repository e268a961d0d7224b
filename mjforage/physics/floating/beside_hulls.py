"""Items beside hulls without bodies in MuJoCo: points that hulls push after a step, and feel.

The law of the contact is that of an item's body (`quays.push`): a sphere against the box of a hull,
soft, without friction. An item weighs a hundredth of a hull and less: it is pushed by the hull as
that has moved without it, and its force is then taken from the hull's way.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.device import Launch
from mjforage.physics.callback.vessel_motion import inertia
from mjforage.physics.floating.body_pool import is_near
from mjforage.physics.floating.drift import Afloat
from mjforage.physics.floating.quays import Quays, beside_quays, is_clear, push
from mjforage.physics.hydrodynamics.item_drag import item_load

Float64Array = NDArray[np.float64]


class Hulls(NamedTuple):
    """The vessels of all simulations over a step."""

    parameters: Any  # (vessel,) records of `VESSEL`
    load: Float64Array  # (simulation, vessel) items aboard
    heavier: Float64Array  # (simulation, vessel) by what share, see `model_layout.SPREAD`
    size: Float64Array  # (vessel, 2) half length, half beam [m]
    pose: Float64Array  # (simulation, vessel, 3) x, y [m], yaw [rad] before the step
    before: Float64Array  # (simulation, vessel, 3) velocity before it [m/s], [rad/s]
    after: Float64Array  # (simulation, vessel, 3) velocity after it; written
    ahead: Float64Array  # (simulation, vessel, 3) x, y, yaw after it; written


@inlined
def out_of_box(
    along: float, aside: float, length: float, beam: float
) -> tuple[float, float, float]:
    """Depth [m] of a point in a box, less than 0 outside, and the way out along the box's axes.

    Parameters
    ----------
    along, aside : of the point, from the box's middle along its axes [m]
    length, beam : half of the box's [m]
    """
    off_x, off_y = abs(along) - length, abs(aside) - beam
    to_x, to_y = math.copysign(1.0, along), math.copysign(1.0, aside)
    if off_x > 0.0 and off_y > 0.0:
        gap = math.sqrt(off_x * off_x + off_y * off_y)
        return -gap, to_x * off_x / gap, to_y * off_y / gap
    return (-off_x, to_x, 0.0) if off_x > off_y else (-off_y, 0.0, to_y)


@kernel
def _beside_hull(
    quays: Quays,
    size: Float64Array,
    pose: Float64Array,
    before: Float64Array,
    after: Float64Array,
    state: tuple[float, float, float, float],
    free: tuple[float, float],
    mass_kg: float,
    step_s: float,
) -> tuple[float, float]:
    """Acceleration [m/s2] of an item with its contact with one hull, from that without it.

    `state`: x, y [m], velocity [m/s] of the item.
    """
    x, y, vx, vy = state
    dx, dy = x - pose[0], y - pose[1]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    depth, out_x, out_y = out_of_box(c * dx + s * dy, c * dy - s * dx, size[0], size[1])
    if depth <= -quays.radius_m:
        return free
    nx, ny, r = c * out_x - s * out_y, s * out_x + c * out_y, before[2]
    speed = nx * (vx - before[0] + r * dy) + ny * (vy - before[1] - r * dx)
    turn = (after[2] - r) / step_s
    ax = (after[0] - before[0]) / step_s - turn * dy - r * r * dx
    ay = (after[1] - before[1]) / step_s + turn * dx - r * r * dy
    missing = nx * (free[0] - ax) + ny * (free[1] - ay)
    more = push(quays, depth + quays.radius_m, speed, missing, mass_kg)
    return free[0] + nx * more, free[1] + ny * more


@kernel
def _recoil(hulls: Hulls, e: int, n: int, force: Float64Array, step_s: float) -> None:
    """Let a hull feel a force (3,) of the step that is past, world axes [N], [N m]."""
    factor, yaw = 1.0 + hulls.heavier[e, n], hulls.pose[e, n, 2]
    body = inertia(hulls.parameters[n], hulls.load[e, n], factor)
    c, s = math.cos(yaw), math.sin(yaw)
    surge, sway, turn = c * force[0] + s * force[1], c * force[1] - s * force[0], force[2]
    determinant = body.sway * body.yaw - body.moment * body.moment
    ahead, aside = surge / body.surge, (body.yaw * sway - body.moment * turn) / determinant
    spin = (body.sway * turn - body.moment * sway) / determinant
    faster = c * ahead - s * aside, s * ahead + c * aside, spin
    for axis in range(3):
        hulls.after[e, n, axis] += step_s * faster[axis]
        hulls.ahead[e, n, axis] += step_s * step_s * faster[axis]


@kernel
def drift_beside(
    afloat: Afloat,
    quays: Quays,
    hulls: Hulls,
    reach_m: float,
    step_s: float,
    memory: Float64Array,
    ids: NDArray[np.int64],
) -> None:
    """Move the items of simulations `ids` within reach of hulls, for which `active` is set.

    Steps are those of the fast integrator. Hulls are slowed and turned by what they push.

    `memory`: (2, vessel, 3).
    """
    q, v, wind, water = afloat.q, afloat.v, afloat.wind, afloat.water
    kind, kinds, active, land = afloat.kind, afloat.kinds, afloat.active, quays.land
    size, poses, before, after = hulls.size, hulls.pose, hulls.before, hulls.after
    vessels, force, will = size.shape[0], memory[0], memory[1]
    for e in ids:
        for n in range(vessels):
            for axis in range(3):
                force[n, axis], will[n, axis] = 0.0, after[e, n, axis]  # before it feels an item
        for k in range(kind.shape[1]):
            x, y = q[e, k, 0], q[e, k, 1]
            active[e, k] = kind[e, k] >= 0.0 and is_near(poses[e], size, x, y, reach_m)
            if not active[e, k]:
                continue
            which, vx, vy = int(kind[e, k]), v[e, k, 0], v[e, k, 1]
            force_x, force_y, mass = item_load(
                kinds[which, 0],
                kinds[which, 1],
                kinds[which, 2],
                wind[e, k, 0] - vx,
                wind[e, k, 1] - vy,
                water[e, k, 0] - vx,
                water[e, k, 1] - vy,
                step_s,
                True,
            )
            there, free = (x, y, vx, vy), (force_x / mass, force_y / mass)
            for n in range(vessels):
                own, was = poses[e, n], before[e, n]
                ax, ay = _beside_hull(quays, size[n], own, was, will[n], there, free, mass, step_s)
                force_x, force_y = mass * (free[0] - ax), mass * (free[1] - ay)
                force[n, 0] += force_x
                force[n, 1] += force_y
                force[n, 2] += (x - own[0]) * force_y - (y - own[1]) * force_x
                free = ax, ay
            ax, ay = free
            if land.size and not is_clear(land, quays.pitch_m, quays.radius_m, x, y):
                ax, ay = beside_quays(quays, x, y, vx, vy, ax, ay, mass)
            v[e, k, 0], v[e, k, 1] = vx + step_s * ax, vy + step_s * ay
            q[e, k, 0], q[e, k, 1] = x + step_s * v[e, k, 0], y + step_s * v[e, k, 1]
        for n in range(vessels):
            if force[n, 0] != 0.0 or force[n, 1] != 0.0:
                _recoil(hulls, e, n, force[n], step_s)


DRIFT_BESIDE = Launch(drift_beside, shared="kinds quays parameters size", memory="memory")
