"""A pool of bodies in MuJoCo for items near vessels: activated before steps, then read back."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.physics.floating.drift import Afloat

Float64Array = NDArray[np.float64]


class Bodies(NamedTuple):
    """The bodies of the pool in all simulations, (simulation, body) each: views of MuJoCo's."""

    q: Float64Array  # (..., 2) [m]
    v: Float64Array  # (..., 2) [m/s]
    wind: Float64Array  # (..., 2) [m/s]
    water: Float64Array  # (..., 2) [m/s]
    kind: Float64Array  # class of the item, -1 if the body lies parked
    parking: Float64Array  # (body, 2) [m]
    item_of: NDArray[np.int64]  # the item that has it, for the steps to come
    most: int  # so many of them are active


@kernel
def is_near(pose: Float64Array, size: Float64Array, x: float, y: float, reach_m: float) -> bool:
    """True if a point lies within `reach_m` of a vessel, on each of its axes.

    `pose`, `size`: (vessel, 3) x, y [m], yaw [rad]; (vessel, 2) half length, half beam [m].
    """
    for v in range(pose.shape[0]):
        dx, dy = x - pose[v, 0], y - pose[v, 1]
        wide = size[v, 0] + size[v, 1] + reach_m * 1.5
        if abs(dx) > wide or abs(dy) > wide:
            continue
        c, s = math.cos(pose[v, 2]), math.sin(pose[v, 2])
        along, aside = abs(c * dx + s * dy), abs(c * dy - s * dx)
        if along < size[v, 0] + reach_m and aside < size[v, 1] + reach_m:
            return True
    return False


@kernel
def activate(
    afloat: Afloat,
    bodies: Bodies,
    pose: Float64Array,
    size: Float64Array,
    reach_m: float,
    ids: NDArray[np.int64],
) -> int:
    """Give the items near vessels their bodies, the first item the first body.

    The assignment depends on nothing but the places.

    `pose`, `size`: as in `is_near`, with (simulation, ...) before the pose; `ids`: simulations.
    Returns: how many bodies the simulation wanted that wanted most; beyond `Bodies.most` none was
    given.
    """
    kind, active, item_of = afloat.kind, afloat.active, bodies.item_of
    pool, most = bodies.q.shape[1], 0
    for e in ids:
        wanted = 0
        for k in range(kind.shape[1]):
            active[e, k] = False
            if kind[e, k] < 0.0:
                continue
            if not is_near(pose[e], size, afloat.q[e, k, 0], afloat.q[e, k, 1], reach_m):
                continue
            if wanted < bodies.most:
                active[e, k], item_of[e, wanted] = True, k
                bodies.kind[e, wanted] = kind[e, k]
                for axis in range(2):
                    bodies.q[e, wanted, axis] = afloat.q[e, k, axis]
                    bodies.v[e, wanted, axis] = afloat.v[e, k, axis]
                    bodies.wind[e, wanted, axis] = afloat.wind[e, k, axis]
                    bodies.water[e, wanted, axis] = afloat.water[e, k, axis]
            wanted += 1
        for body in range(wanted, pool):
            item_of[e, body], bodies.kind[e, body] = -1, -1.0
            for axis in range(2):
                bodies.q[e, body, axis] = bodies.parking[body, axis]
                bodies.v[e, body, axis] = 0.0
        most = max(most, wanted)
    return most


@kernel
def sync_items(afloat: Afloat, bodies: Bodies, ids: NDArray[np.int64]) -> None:
    """Read where the items with bodies have come to."""
    item_of = bodies.item_of
    for e in ids:
        for body in range(item_of.shape[1]):
            k = item_of[e, body]
            if k < 0:
                break
            for axis in range(2):
                afloat.q[e, k, axis] = bodies.q[e, body, axis]
                afloat.v[e, k, axis] = bodies.v[e, body, axis]
