"""Moving the items that have no body, by the integrators of `simulation.integrators`."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.device import Launch
from mjforage.physics.callback.model_layout import CLASS_WIDTH
from mjforage.physics.floating.quays import Quays, beside_quays, is_clear
from mjforage.physics.hydrodynamics.item_drag import item_load

Float64Array = NDArray[np.float64]


class Afloat(NamedTuple):
    """The items of all simulations; (simulation, item) each, world axes."""

    q: Float64Array  # (..., 2) as MuJoCo would hold them, see `simulation.integrators` [m]
    v: Float64Array  # (..., 2) velocity over ground [m/s]
    wind: Float64Array  # (..., 2) velocity of the air over ground [m/s]
    water: Float64Array  # (..., 2) velocity of the water over ground [m/s]
    kind: Float64Array  # row of `kinds`, negative if not on the water
    kinds: Float64Array  # (class, 3) mass incl. added mass [kg], air and water drag [N s2/m2]
    active: NDArray[np.bool_]  # whether it has a body for the moment

    @classmethod
    def of(cls, classes: int, simulations: int, items: int) -> "Afloat":
        """Items, not yet on the water."""
        q, v, wind, water = np.zeros((4, simulations, items, 2))
        shape = simulations, items
        kind, kinds = np.full(shape, -1.0), np.zeros((classes, CLASS_WIDTH))
        return cls(q, v, wind, water, kind, kinds, np.zeros(shape, np.bool_))


class Item(NamedTuple):
    """Mass, drag, wind and water of one item."""

    mass_kg: float  # with the water that moves with it
    air: float  # drag [N s2/m2]
    water: float
    wind_x: float  # velocities over ground [m/s]
    wind_y: float
    water_x: float
    water_y: float


@inlined
def _acceleration(
    item: Item,
    x: float,
    y: float,
    vx: float,
    vy: float,
    quays: Quays,
    land: NDArray[np.bool_],
    step_s: float,
    averaged: bool,
) -> tuple[float, float]:
    """Acceleration [m/s2] of one item; `land` is that of `quays`."""
    force_x, force_y, mass = item_load(
        item.mass_kg,
        item.air,
        item.water,
        item.wind_x - vx,
        item.wind_y - vy,
        item.water_x - vx,
        item.water_y - vy,
        step_s,
        averaged,
    )
    ax, ay = force_x / mass, force_y / mass
    if land.size and not is_clear(land, quays.pitch_m, quays.radius_m, x, y):
        ax, ay = beside_quays(quays, x, y, vx, vy, ax, ay, mass)
    return ax, ay


@inlined
def _runge_kutta(
    item: Item,
    x: float,
    y: float,
    vx: float,
    vy: float,
    quays: Quays,
    land: NDArray[np.bool_],
    step_s: float,
) -> tuple[float, float, float, float]:
    """Position and velocity after a step of the classical method of order 4."""
    ahead_x = ahead_y = ax = ay = 0.0
    sum_vx = sum_vy = sum_ax = sum_ay = 0.0
    for stage in range(4):
        share = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5
        weight = 1.0 / 6.0 if stage in (0, 3) else 1.0 / 3.0
        at_x, at_y = x + share * step_s * ahead_x, y + share * step_s * ahead_y
        ahead_x, ahead_y = vx + share * step_s * ax, vy + share * step_s * ay
        ax, ay = _acceleration(item, at_x, at_y, ahead_x, ahead_y, quays, land, step_s, False)
        sum_vx, sum_vy = sum_vx + weight * ahead_x, sum_vy + weight * ahead_y
        sum_ax, sum_ay = sum_ax + weight * ax, sum_ay + weight * ay
    return x + step_s * sum_vx, y + step_s * sum_vy, vx + step_s * sum_ax, vy + step_s * sum_ay


@kernel
def drift(
    afloat: Afloat, quays: Quays, step_s: float, averaged: bool, ids: NDArray[np.int64], steps: int
) -> tuple[int, int]:
    """Move the items of simulations `ids` that are on the water and have no body.

    `averaged`: by the fast integrator (velocity first, then position by it), else by the reference.
    Returns: simulation and item that are no finite numbers any more, -1 and -1 if all are.
    """
    q, v, wind, water = afloat.q, afloat.v, afloat.wind, afloat.water
    kind, kinds, active, land = afloat.kind, afloat.kinds, afloat.active, quays.land
    for e in ids:
        for k in range(kind.shape[1]):
            if kind[e, k] < 0.0 or active[e, k]:
                continue
            which = int(kind[e, k])
            item = Item(
                kinds[which, 0],
                kinds[which, 1],
                kinds[which, 2],
                wind[e, k, 0],
                wind[e, k, 1],
                water[e, k, 0],
                water[e, k, 1],
            )
            x, y, vx, vy = q[e, k, 0], q[e, k, 1], v[e, k, 0], v[e, k, 1]
            for _ in range(steps):
                if averaged:
                    ax, ay = _acceleration(item, x, y, vx, vy, quays, land, step_s, True)
                    vx, vy = vx + step_s * ax, vy + step_s * ay
                    x, y = x + step_s * vx, y + step_s * vy
                else:
                    x, y, vx, vy = _runge_kutta(item, x, y, vx, vy, quays, land, step_s)
            q[e, k, 0], q[e, k, 1], v[e, k, 0], v[e, k, 1] = x, y, vx, vy
            if not math.isfinite(x + y):
                return e, k
    return -1, -1


DRIFT = Launch(drift, shared="kinds quays")
