"""A vessel as a flat vector for kernels: `pack`, and the index of every entry (SI units)."""

import numpy as np
from numpy.typing import NDArray

from mjforage.physics.vessels import CrossFlow, Propeller, Vessel

Float64Array = NDArray[np.float64]

AIR_DENSITY_KGPM3 = 1.224  # Blendermann's tables, as in MSS

# Inertia: rigid body with its centre of gravity COG_X ahead of midships, added mass at midships.
LENGTH, MASS, COG_X, INERTIA_Z, ADDED_SURGE, ADDED_SWAY, ADDED_YAW = range(7)
# Damping.
LINEAR_SURGE, LINEAR_SWAY, LINEAR_YAW, QUAD_SURGE, QUAD_SWAY, QUAD_YAW, YAW_GROWTH = range(7, 14)
# Cross-flow: kind (below), 1/2 rho Cd T [kg/m2], length [m].
CROSS_KIND, CROSS_FACTOR, CROSS_LENGTH = range(14, 17)
# Thrust per side: kind (below), coefficients (1 for forces), range of the command, dead zone.
THRUST_KIND, K_AHEAD, K_ASTERN, COMMAND_MAX, COMMAND_MIN, DEAD_ZONE, LEVER, LAG = range(17, 25)
# Wind: 1/2 rho A of front and side [kg/m], coefficients, centroid ahead of midships.
WIND_FRONT, WIND_SIDE, WIND_CDT, WIND_CDL_BOW, WIND_CDL_STERN, WIND_DELTA, WIND_SL = range(25, 32)
# Load: mass [kg] and quadratic surge drag [N s2/m2] of one item.
LOAD_MASS, LOAD_DRAG = range(32, 34)
SIZE = 34

CROSS_NONE, CROSS_INTEGRATED, CROSS_STRIPS = 0.0, 1.0, 2.0
THRUST_FORCE, THRUST_PROPELLER = 0.0, 1.0

_CROSS_KINDS = {"integrated": CROSS_INTEGRATED, "strips-otter": CROSS_STRIPS}


def pack(vessel: Vessel) -> Float64Array:
    """Parameters of one vessel without load, in the order of this file's indices.

    Returns
    -------
    ndarray, shape (SIZE,), SI units
    """
    v = vessel
    wind, air = v.windage, 0.5 * AIR_DENSITY_KGPM3
    # fmt: off
    entries = [
        v.length_m, v.mass_kg, v.cog_x_m, v.inertia_z_kgm2,
        v.added_mass_surge_kg, v.added_mass_sway_kg, v.added_mass_yaw_kgm2,
        v.linear_surge, v.linear_sway, v.linear_yaw,
        v.quadratic_surge, v.quadratic_sway, v.quadratic_yaw, v.yaw_linear_growth,
        *_cross_flow(v.crossflow),
        *_thrust(v), v.lever_m, v.lag_s,
        air * wind.area_front_m2, air * wind.area_side_m2,
        wind.cdt, wind.cdl_bow, wind.cdl_stern, wind.delta, wind.s_l_m,
        v.load.mass_per_item_kg, v.load.drag_per_item,
    ]
    # fmt: on
    return np.array(entries)


def _cross_flow(flow: CrossFlow | None) -> list[float]:
    if flow is None:
        return [CROSS_NONE, 0.0, 0.0]
    factor = 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m
    return [_CROSS_KINDS[flow.kind], factor, flow.length_m]


def _thrust(vessel: Vessel) -> list[float]:
    thruster = vessel.thruster
    low, high = thruster.command_range
    if isinstance(thruster, Propeller):
        return [THRUST_PROPELLER, thruster.k_ahead, thruster.k_astern, high, low, 0.0]
    return [THRUST_FORCE, 1.0, 1.0, high, low, thruster.dead_zone_newton]
