"""Acceleration of a hull alone: (M_RB + M_A) d(nu_r)/dt = forces, in body axes (Fossen 2021)."""

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.parameters import HullParameters
from mjforage.physics.hydrodynamics.thruster import thruster_force
from mjforage.physics.hydrodynamics.water_load import hull_force
from mjforage.physics.hydrodynamics.wind_load import wind_force


@kernel
def rigid_coriolis(p: HullParameters, u: float, v: float, r: float) -> tuple[float, float, float]:
    """-C_RB(nu) nu with the centre of gravity ahead of midships, for body-axes accelerations."""
    mass, x_g = p.mass, p.cog_x
    return mass * (v + x_g * r) * r, -mass * u * r, -mass * x_g * u * r


@kernel
def acceleration(
    p: HullParameters,
    velocity: tuple[float, float, float],
    thrusters: tuple[float, float],
    wind: tuple[float, float],
) -> tuple[float, float, float]:
    """d(u_r, v_r, r)/dt, for a current that is constant in the world.

    Parameters
    ----------
    velocity : of midships relative to the water, forward and to port, and yaw rate [m/s, rad/s]
    thrusters : lagged commands of port and starboard [rad/s or N]
    wind : velocity of the air relative to the water, forward and to port [m/s]
    """
    u, v, r = velocity
    x_h, y_h, n_h = hull_force(p, u, v, r)
    x_c, y_c, n_c = rigid_coriolis(p, u, v, r)
    x_w, y_w, n_w = wind_force(p, wind[0] - u, wind[1] - v)
    x_t, n_t = thruster_force(p, thrusters[0], thrusters[1])
    surge = (x_h + x_c + x_w + x_t) / (p.mass + p.added_surge)
    y, n = y_h + y_c + y_w, n_h + n_c + n_w + n_t
    m22, m23 = p.mass + p.added_sway, p.mass * p.cog_x
    m33 = p.inertia_z + p.added_yaw
    determinant = m22 * m33 - m23 * m23
    return surge, (m33 * y - m23 * n) / determinant, (m22 * n - m23 * y) / determinant


@kernel
def kinetic_energy(p: HullParameters, u: float, v: float, r: float) -> float:
    """1/2 nu^T (M_RB + M_A) nu [J]."""
    straight = (p.mass + p.added_surge) * u * u + (p.mass + p.added_sway) * v * v
    turning = (p.inertia_z + p.added_yaw) * r * r
    return float(0.5 * (straight + turning) + p.mass * p.cog_x * v * r)
