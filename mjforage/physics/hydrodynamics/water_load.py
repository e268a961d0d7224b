"""Forces of the water on a hull, from velocities relative to the water, in body axes.

Equations of motion: Fossen (2021), "Handbook of Marine Craft Hydrodynamics and Motion Control",
chapters 3 and 6, in surge, sway and yaw. x forward, y port, yaw counter-clockwise; the equations
read the same as with y to starboard and yaw clockwise.
"""

from graph_planner.compiled import kernel
from mjforage.physics.hydrodynamics.crossflow import cross_flow
from mjforage.physics.hydrodynamics.parameters import (
    ADDED_SURGE,
    ADDED_SWAY,
    LINEAR_SURGE,
    LINEAR_SWAY,
    LINEAR_YAW,
    LOAD_DRAG,
    LOAD_MASS,
    QUAD_SURGE,
    QUAD_SWAY,
    QUAD_YAW,
    YAW_GROWTH,
    Float64Array,
)


@kernel
def damping(p: Float64Array, u_r: float, v_r: float, r: float) -> tuple[float, float, float]:
    """Linear, quadratic and cross-flow drag: (X [N], Y [N], N [N m]).

    In yaw N = -(d (1 + g |r|) + q |r|) r.
    """
    side, turn = cross_flow(p, v_r, r)
    return (
        -(p[LINEAR_SURGE] + p[QUAD_SURGE] * abs(u_r)) * u_r,
        side - (p[LINEAR_SWAY] + p[QUAD_SWAY] * abs(v_r)) * v_r,
        turn - (p[LINEAR_YAW] * (1.0 + p[YAW_GROWTH] * abs(r)) + p[QUAD_YAW] * abs(r)) * r,
    )


@kernel
def added_coriolis(p: Float64Array, u_r: float, v_r: float, r: float) -> tuple[float, float, float]:
    """-C_A(nu_r) nu_r, the Munk moment included, for accelerations taken in body axes.

    To be used where M multiplies d(u, v, r)/dt.
    """
    a11, a22 = p[ADDED_SURGE], p[ADDED_SWAY]
    return a22 * v_r * r, -a11 * u_r * r, -(a22 - a11) * u_r * v_r


@kernel
def added_inertial(p: Float64Array, u_r: float, v_r: float, r: float) -> tuple[float, float, float]:
    """The same physics for accelerations taken in axes that do not turn, as MuJoCo's are.

    To be used where M_A, turned into those axes, multiplies the acceleration of midships over
    ground: M_A d(u, v)/dt = M_A (a - r x (u, v)), so that M_A (r v, -r u) is moved to this side.
    """
    difference = p[ADDED_SWAY] - p[ADDED_SURGE]
    return difference * v_r * r, difference * u_r * r, -difference * u_r * v_r


@kernel
def hull_force(p: Float64Array, u_r: float, v_r: float, r: float) -> tuple[float, float, float]:
    """Damping, cross-flow and added-mass Coriolis forces, for accelerations in BODY axes.

    Parameters
    ----------
    p : (SIZE,) of `pack`
    u_r, v_r : velocity of midships relative to the water, forward and to port [m/s]
    r : yaw rate [rad/s]

    Returns
    -------
    X forward [N], Y to port [N], N counter-clockwise [N m], at midships
    """
    x, y, n = damping(p, u_r, v_r, r)
    x_a, y_a, n_a = added_coriolis(p, u_r, v_r, r)
    return x + x_a, y + y_a, n + n_a


@kernel
def hull_force_inertial(
    p: Float64Array, u_r: float, v_r: float, r: float
) -> tuple[float, float, float]:
    """`hull_force` for a solver whose accelerations are in WORLD axes, such as MuJoCo.

    Such a solver has R M_A R^T in its mass matrix but does not know that M_A turns with the hull;
    this has the terms that follow from it. The force itself is still in body axes.
    """
    x, y, n = damping(p, u_r, v_r, r)
    x_a, y_a, n_a = added_inertial(p, u_r, v_r, r)
    return x + x_a, y + y_a, n + n_a


@kernel
def load_drag(p: Float64Array, items: float, u_r: float) -> float:
    """Surge force of the collected items [N], to be added to the hull's."""
    return -float(p[LOAD_DRAG]) * items * abs(u_r) * u_r


@kernel
def load_mass(p: Float64Array, items: float) -> float:
    """Mass of the collected items [kg], at midships: it adds to both diagonals of M, not to yaw."""
    return float(p[LOAD_MASS]) * items
