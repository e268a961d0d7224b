"""One vessel in the plane: its loads, its inertia, and its own equation of motion.

Midships is the reference point and the hinge of the MuJoCo body; the centre of gravity lies x_g
ahead of it. MuJoCo solves M(yaw) q'' + bias = force in world axes. Water resists acceleration with
-M_A nu_r' - C_A(nu_r) nu_r, where nu_r = R^T (q' - current) (Fossen 2021, sections 6.5 and 10.3)
and, under a steady current, nu_r' = R^T q'' + (r v_r, -r u_r). The first part of M_A nu_r' goes
into M as R diag(X_a, Y_a) R^T and N_a, the second is a force (`hull_force`). Only relative
velocities enter, so a steady current is an exact translation.
"""

import math
from typing import NamedTuple

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.crossflow import cross_flow_slope
from mjforage.physics.hydrodynamics.parameters import VesselParameters
from mjforage.physics.hydrodynamics.thruster import (
    force_of_sides,
    saturated,
    thrust,
    thrust_in_step,
    thruster_slope,
)
from mjforage.physics.hydrodynamics.water_load import hull_force, load_drag, load_mass
from mjforage.physics.hydrodynamics.wind_load import wind_force, wind_slope


class Surroundings(NamedTuple):
    """Wind, water, load and faults of a vessel, constant over a step."""

    wind_x: float  # air over ground [m/s]
    wind_y: float
    water_x: float  # water over ground [m/s]
    water_y: float
    load: float  # items aboard
    port_left: float  # share of its thrust that a thruster has left
    starboard_left: float
    mass: float  # factor on mass and yaw inertia of the rigid body
    drag: float  # factor on drag, without that of items aboard


class Inertia(NamedTuple):
    """Total inertia in body axes, added mass included, and the moment of the rigid mass."""

    surge: float  # [kg]
    sway: float  # [kg]
    yaw: float  # about midships [kg m2]
    moment: float  # rigid mass times x_g [kg m]


@kernel
def inertia(p: VesselParameters, load: float, factor: float) -> Inertia:
    """Inertia with `load` items aboard: they lie at midships and add mass only.

    `factor`: on the rigid body's own.
    """
    own = factor * p.mass
    mass = own + load_mass(p, load)
    return Inertia(
        mass + p.added_surge,
        mass + p.added_sway,
        factor * p.inertia_z + p.added_yaw,
        own * p.cog_x,
    )


@kernel
def loads(
    p: VesselParameters,
    yaw: float,
    vx: float,
    vy: float,
    r: float,
    port: float,
    starboard: float,
    around: Surroundings,
) -> tuple[float, float, float]:
    """Surge [N], sway [N] and yaw [N m] load at midships, body axes, for the right-hand side.

    Parameters
    ----------
    vx, vy, r : velocity over ground, world axes [m/s], yaw rate [rad/s]
    port, starboard : thrusts as the vessel has them moored [N]
    """
    c, s = math.cos(yaw), math.sin(yaw)
    dx, dy = vx - around.water_x, vy - around.water_y
    u_r, v_r = c * dx + s * dy, c * dy - s * dx
    dx, dy = around.wind_x - vx, around.wind_y - vy
    hull = hull_force(p, u_r, v_r, r, around.drag)
    wind = wind_force(p, c * dx + s * dy, c * dy - s * dx)
    left, right = around.port_left * port, around.starboard_left * starboard
    force, moment = force_of_sides(p, left, right, u_r, r)
    surge = hull[0] + wind[0] + force + load_drag(p, around.load, u_r)
    return surge, hull[1] + wind[1], hull[2] + wind[2] + moment


@kernel
def acceleration(
    p: VesselParameters,
    mass: Inertia,
    yaw: float,
    vx: float,
    vy: float,
    r: float,
    port: float,
    starboard: float,
    around: Surroundings,
) -> tuple[float, float, float]:
    """World acceleration of midships [m/s2] and yaw acceleration [rad/s2] of the free vessel."""
    surge, sway, turn = loads(p, yaw, vx, vy, r, port, starboard, around)
    ahead = (surge + mass.moment * r * r) / mass.surge
    determinant = mass.sway * mass.yaw - mass.moment * mass.moment
    aside = (mass.yaw * sway - mass.moment * turn) / determinant
    spin = (mass.sway * turn - mass.moment * sway) / determinant
    c, s = math.cos(yaw), math.sin(yaw)
    return c * ahead - s * aside, s * ahead + c * aside, spin


@kernel
def mean_acceleration(
    p: VesselParameters,
    mass: Inertia,
    ahead_yaw: float,
    vx: float,
    vy: float,
    r: float,
    command: tuple[float, float],
    lagged: tuple[float, float],
    around: Surroundings,
    step_s: float,
) -> tuple[float, float, float]:
    """Mean acceleration of the free vessel over the coming step, by one Runge-Kutta step.

    Parameters
    ----------
    ahead_yaw : heading half a step ahead [rad], where positions of the fast integrator are; the
        first of the four evaluations is at a heading without the yaw acceleration of that half step
    vx, vy, r : velocity now
    command, lagged : (port, starboard); the lag itself is solved exactly
    """
    port = thrust_in_step(p, saturated(p, command[0]), lagged[0], step_s)
    starboard = thrust_in_step(p, saturated(p, command[1]), lagged[1], step_s)
    h = 0.5 * step_s
    ax, ay, ar = acceleration(p, mass, ahead_yaw - h * r, vx, vy, r, port[0], starboard[0], around)
    yaw = ahead_yaw - h * (r + 0.5 * h * ar)
    bx, by, br = acceleration(
        p, mass, yaw + h * r, vx + h * ax, vy + h * ay, r + h * ar, port[1], starboard[1], around
    )
    cx, cy, cr = acceleration(
        p,
        mass,
        yaw + h * (r + h * ar),
        vx + h * bx,
        vy + h * by,
        r + h * br,
        port[1],
        starboard[1],
        around,
    )
    dx, dy, dr = acceleration(
        p,
        mass,
        yaw + step_s * (r + h * br),
        vx + step_s * cx,
        vy + step_s * cy,
        r + step_s * cr,
        port[2],
        starboard[2],
        around,
    )
    return (
        (ax + 2.0 * (bx + cx) + dx) / 6.0,
        (ay + 2.0 * (by + cy) + dy) / 6.0,
        (ar + 2.0 * (br + cr) + dr) / 6.0,
    )


@kernel
def damping(
    p: VesselParameters,
    yaw: float,
    vx: float,
    vy: float,
    r: float,
    lagged: tuple[float, float],
    around: Surroundings,
) -> tuple[float, float, float]:
    """Slope of drag and thrust, of water, air and load, in surge, sway [N s/m] and yaw [N m s].

    Each is at least 0.

    Parameters
    ----------
    vx, vy, r : velocity over ground, world axes [m/s], yaw rate [rad/s]
    lagged : commands of the thrusters, port and starboard
    """
    c, s = math.cos(yaw), math.sin(yaw)
    dx, dy = vx - around.water_x, vy - around.water_y
    u_r, v_r = c * dx + s * dy, c * dy - s * dx
    dx, dy = around.wind_x - vx, around.wind_y - vy
    air = wind_slope(p, c * dx + s * dy, c * dy - s * dx)
    cross = cross_flow_slope(p, v_r, r)
    drag, load = around.drag, p.load_drag * around.load
    surge = drag * p.linear_surge + 2.0 * (drag * p.quadratic_surge + load) * abs(u_r)
    port = around.port_left * thrust(p, lagged[0])
    starboard = around.starboard_left * thrust(p, lagged[1])
    slope = thruster_slope(p, port, starboard, u_r, r)
    growth = p.linear_yaw * p.yaw_growth + p.quadratic_yaw
    return (
        surge + air[0] + slope[0],
        drag * (p.linear_sway + 2.0 * p.quadratic_sway * abs(v_r) + cross[0]) + air[1],
        drag * (p.linear_yaw + 2.0 * growth * abs(r) + cross[1]) + slope[1],
    )


@kernel
def averaged_load(
    p: VesselParameters,
    body: Inertia,
    yaw: float,
    vx: float,
    vy: float,
    r: float,
    command: tuple[float, float],
    lagged: tuple[float, float],
    around: Surroundings,
    step_s: float,
) -> tuple[float, float, float, float, float, float]:
    """Loads in body axes that give a vessel its mean acceleration, and the inertia to feel.

    Half a step of damping joins the inertia: a contact that stops the vessel then meets the full
    load at rest, not the load that the free vessel would have had on average. For quadratic drag it
    is exact with the slope at a third of the step: the mean of (v + a t)^2 over h is
    v^2 + h a (v + a h/3). Free motion is the same. Parameters are as of `mean_acceleration`.

    Returns: surge, sway [N], yaw [N m]; inertia in surge, sway [kg] and yaw [kg m2].
    """
    h = step_s
    ax, ay, ar = mean_acceleration(p, body, yaw, vx, vy, r, command, lagged, around, h)
    c, s = math.cos(yaw), math.sin(yaw)
    d_surge, d_sway, d_yaw = damping(
        p, yaw, vx + h / 3.0 * ax, vy + h / 3.0 * ay, r + h / 3.0 * ar, lagged, around
    )
    m_surge, m_sway = body.surge + 0.5 * h * d_surge, body.sway + 0.5 * h * d_sway
    m_yaw = body.yaw + 0.5 * h * d_yaw
    ahead, aside = c * ax + s * ay, c * ay - s * ax
    surge = m_surge * ahead - p.mass * p.cog_x * r * r  # MuJoCo turns the model's mass
    sway = m_sway * aside + body.moment * ar
    return surge, sway, m_yaw * ar + body.moment * aside, m_surge, m_sway, m_yaw
