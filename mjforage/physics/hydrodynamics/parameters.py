"""A vessel's numbers as a record for kernels; `pack` fills it."""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjforage.controllers.records import record_type
from mjforage.physics.vessels import CrossFlow, Propeller, Vessel
from mjforage.scenario.debris import AIR_DENSITY_KGPM3

Float64Array = NDArray[np.float64]


class VesselParameters:
    """The fields of the record `VESSEL`, SI units, for readers and type checkers; it is never made.

    Everything refers to midships, in body axes.
    """

    # Inertia: rigid body with its centre of gravity cog_x ahead of midships, and added mass.
    length: float
    mass: float
    cog_x: float
    inertia_z: float
    added_surge: float
    added_sway: float
    added_yaw: float
    # Damping; yaw_growth [s/rad] is that of the linear part with the rate.
    linear_surge: float
    linear_sway: float
    linear_yaw: float
    quadratic_surge: float
    quadratic_sway: float
    quadratic_yaw: float
    yaw_growth: float
    # Cross-flow: kind (below), 1/2 rho Cd T [kg/m2], length.
    cross_kind: float
    cross_factor: float
    cross_length: float
    # Thrust per side: kind (below), coefficients (1 for forces), range of the command, dead zone.
    thrust_kind: float
    k_ahead: float
    k_astern: float
    command_max: float
    command_min: float
    dead_zone: float
    lever: float
    lag: float
    # Wind: 1/2 rho A of front and side [kg/m], coefficients, centroid of the side area ahead.
    wind_front: float
    wind_side: float
    wind_cdt: float
    wind_cdl_bow: float
    wind_cdl_stern: float
    wind_delta: float
    wind_sl: float
    # What one item aboard adds: mass [kg] and quadratic surge drag [N s2/m2].
    load_mass: float
    load_drag: float
    # Propulsion: 2 rho A of a propeller's disc [kg/m] (0: thrust does not fall with speed), most
    # thrust moored, a motor's power for it, power of all else.
    disc: float
    rated_thrust: float
    motor: float
    hotel: float


VESSEL = record_type(VesselParameters.__annotations__)
VesselArray: TypeAlias = NDArray[Any]  # (vessel,) of `VESSEL`

CROSS_NONE, CROSS_INTEGRATED, CROSS_STRIPS = 0.0, 1.0, 2.0
THRUST_FORCE, THRUST_PROPELLER = 0.0, 1.0

_CROSS_KINDS = {"integrated": CROSS_INTEGRATED, "strips-otter": CROSS_STRIPS}


def pack(vessel: Vessel) -> VesselParameters:
    """Parameters of one vessel without load, as a record of `VESSEL`."""
    v = vessel
    wind, air = v.windage, 0.5 * AIR_DENSITY_KGPM3
    # fmt: off
    entries = (
        v.length_m, v.mass_kg, v.cog_x_m, v.inertia_z_kgm2,
        v.added_mass_surge_kg, v.added_mass_sway_kg, v.added_mass_yaw_kgm2,
        v.linear_surge, v.linear_sway, v.linear_yaw,
        v.quadratic_surge, v.quadratic_sway, v.quadratic_yaw, v.yaw_linear_growth,
        *_cross_flow(v.crossflow),
        *_thrust(v), v.lever_m, v.lag_s,
        air * wind.area_front_m2, air * wind.area_side_m2,
        wind.cdt, wind.cdl_bow, wind.cdl_stern, wind.delta, wind.s_l_m,
        v.load.mass_per_item_kg, v.load.drag_per_item,
        *_propulsion(v),
    )
    # fmt: on
    record: VesselParameters = np.array([entries], VESSEL)[0]
    return record


def pack_fleet(vessels: Sequence[Vessel]) -> VesselArray:
    """(vessel,) `pack` of each."""
    return np.array([pack(vessel) for vessel in vessels], VESSEL)


def _cross_flow(flow: CrossFlow | None) -> list[float]:
    if flow is None:
        return [CROSS_NONE, 0.0, 0.0]
    factor = 0.5 * flow.water_density_kgpm3 * flow.coefficient * flow.draft_m
    return [_CROSS_KINDS[flow.kind], factor, flow.length_m]


def _propulsion(vessel: Vessel) -> list[float]:
    most, power = max(map(abs, vessel.thruster.thrust_range)), vessel.power
    if power is None:
        return [0.0, most, 0.0, 0.0]
    return [power.disc_kgpm, most, power.motor_w, power.hotel_w]


def _thrust(vessel: Vessel) -> list[float]:
    thruster = vessel.thruster
    low, high = thruster.command_range
    if isinstance(thruster, Propeller):
        return [THRUST_PROPELLER, thruster.k_ahead, thruster.k_astern, high, low, 0.0]
    return [THRUST_FORCE, 1.0, 1.0, high, low, thruster.dead_zone_newton]
