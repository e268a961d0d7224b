"""Acceleration of a hull alone: (M_RB + M_A) d(nu_r)/dt = forces, in body axes (Fossen 2021)."""

from graph_planner.compiled import kernel
from mjforage.physics.hydrodynamics.parameters import (
    ADDED_SURGE,
    ADDED_SWAY,
    ADDED_YAW,
    COG_X,
    INERTIA_Z,
    MASS,
    Float64Array,
)
from mjforage.physics.hydrodynamics.thruster import thruster_force
from mjforage.physics.hydrodynamics.water_load import hull_force
from mjforage.physics.hydrodynamics.wind_load import wind_force


@kernel
def rigid_coriolis(p: Float64Array, u: float, v: float, r: float) -> tuple[float, float, float]:
    """-C_RB(nu) nu with the centre of gravity ahead of midships, for body-axes accelerations."""
    mass, x_g = p[MASS], p[COG_X]
    return mass * (v + x_g * r) * r, -mass * u * r, -mass * x_g * u * r


@kernel
def acceleration(
    p: Float64Array,
    velocity: tuple[float, float, float],
    thrusters: tuple[float, float],
    wind: tuple[float, float],
) -> tuple[float, float, float]:
    """d(u_r, v_r, r)/dt, for a current that is constant in the world.

    Parameters
    ----------
    p : (SIZE,) of `pack`
    velocity : of midships relative to the water, forward and to port, and yaw rate [m/s, rad/s]
    thrusters : lagged commands of port and starboard [rad/s or N]
    wind : velocity of the air relative to the water, forward and to port [m/s]
    """
    u, v, r = velocity
    x_h, y_h, n_h = hull_force(p, u, v, r)
    x_c, y_c, n_c = rigid_coriolis(p, u, v, r)
    x_w, y_w, n_w = wind_force(p, wind[0] - u, wind[1] - v)
    x_t, n_t = thruster_force(p, thrusters[0], thrusters[1])
    surge = (x_h + x_c + x_w + x_t) / (p[MASS] + p[ADDED_SURGE])
    y, n = y_h + y_c + y_w, n_h + n_c + n_w + n_t
    m22, m23 = p[MASS] + p[ADDED_SWAY], p[MASS] * p[COG_X]
    m33 = p[INERTIA_Z] + p[ADDED_YAW]
    determinant = m22 * m33 - m23 * m23
    return surge, (m33 * y - m23 * n) / determinant, (m22 * n - m23 * y) / determinant


@kernel
def kinetic_energy(p: Float64Array, u: float, v: float, r: float) -> float:
    """1/2 nu^T (M_RB + M_A) nu [J]."""
    straight = (p[MASS] + p[ADDED_SURGE]) * u * u + (p[MASS] + p[ADDED_SWAY]) * v * v
    turning = (p[INERTIA_Z] + p[ADDED_YAW]) * r * r
    return float(0.5 * (straight + turning) + p[MASS] * p[COG_X] * v * r)
