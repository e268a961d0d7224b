"""Forces of the water on a vessel, from velocities relative to the water, in body axes.

Equations of motion: Fossen (2021), "Handbook of Marine Craft Hydrodynamics and Motion Control",
chapters 3 and 6, in surge, sway and yaw. x forward, y port, yaw counter-clockwise; the equations
read the same as with y to starboard and yaw clockwise.
"""

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.crossflow import cross_flow
from mjforage.physics.hydrodynamics.parameters import VesselParameters


@kernel
def damping(p: VesselParameters, u_r: float, v_r: float, r: float) -> tuple[float, float, float]:
    """Linear, quadratic and cross-flow drag: (X [N], Y [N], N [N m]).

    In yaw N = -(d (1 + g |r|) + q |r|) r.
    """
    side, turn = cross_flow(p, v_r, r)
    return (
        -(p.linear_surge + p.quadratic_surge * abs(u_r)) * u_r,
        side - (p.linear_sway + p.quadratic_sway * abs(v_r)) * v_r,
        turn - (p.linear_yaw * (1.0 + p.yaw_growth * abs(r)) + p.quadratic_yaw * abs(r)) * r,
    )


@kernel
def added_inertial(
    p: VesselParameters, u_r: float, v_r: float, r: float
) -> tuple[float, float, float]:
    """Forces of added mass, the Munk moment included, for accelerations in axes that do not turn.

    M_A, turned into those axes, multiplies the acceleration of midships over ground:
    M_A d(u, v)/dt = M_A (a - r x (u, v)), so that M_A (r v, -r u) is moved to this side.
    """
    difference = p.added_sway - p.added_surge
    return difference * v_r * r, difference * u_r * r, -difference * u_r * v_r


@kernel
def hull_force(
    p: VesselParameters, u_r: float, v_r: float, r: float, drag: float
) -> tuple[float, float, float]:
    """Damping, cross-flow and added-mass forces, for accelerations in WORLD axes, as MuJoCo's are.

    The solver has R M_A R^T in its mass matrix but does not know that M_A turns with the vessel;
    this has the terms that follow from it. The force itself is in body axes.

    Returns: x forward [N], Y to port [N], N counter-clockwise [N m], at midships.

    Parameters
    ----------
    u_r, v_r : velocity of midships relative to the water, forward and to port [m/s]
    r : yaw rate [rad/s]
    drag : factor on damping and cross-flow
    """
    x, y, n = damping(p, u_r, v_r, r)
    x_a, y_a, n_a = added_inertial(p, u_r, v_r, r)
    return drag * x + x_a, drag * y + y_a, drag * n + n_a


@kernel
def load_drag(p: VesselParameters, items: float, u_r: float) -> float:
    """Surge force of the collected items [N], to be added to the vessel's."""
    return -float(p.load_drag) * items * abs(u_r) * u_r


@kernel
def load_mass(p: VesselParameters, items: float) -> float:
    """Mass of the collected items [kg], at midships: it adds to both diagonals of M, not to yaw."""
    return float(p.load_mass) * items
