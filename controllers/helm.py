"""One hull as its controllers know it: size, inertia, drag, thrusters, tuning; and packed."""

from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Tuning:
    """What is chosen, not measured, of a hull's controllers."""

    cruise_ahead_mps: float  # speed over ground on a long leg
    cruise_astern_mps: float
    acceleration_mps2: float  # of the speed's reference
    brake_mps2: float  # deceleration that is always at hand; stopping distances count on it
    yaw_rate_radps: float  # of the heading's reference
    yaw_acceleration_radps2: float
    heading_bandwidth_radps: float
    heading_damping: float
    heading_integral_s: float  # time in which a steady moment is found
    speed_bandwidth_radps: float
    speed_integral_s: float
    lookahead_m: float  # of the line-of-sight guidance
    drift_gain_mps: float  # kappa of its integral
    hold_bandwidth_radps: float  # of keeping position
    hold_integral_s: float
    hold_radius_m: float  # how far beside its place a hull may lie before it turns
    clearance_m: float  # wanted between hulls, and between hull and quay
    filter_s: float  # time constant of the filters on measured position and heading


@dataclass(frozen=True)
class Helm:
    """The numbers of one hull that controllers need.

    Inertia includes added mass; drag is (linear + quadratic |v|) v along each axis. The thrust of
    one side is k c |c|^(exponent - 1) of the command c, with a k for each way, and nothing inside
    the dead zone.
    """

    length_m: float
    beam_m: float
    mass_surge_kg: float
    mass_sway_kg: float
    inertia_yaw_kgm2: float
    munk_kg: float  # added mass in sway minus that in surge
    linear_surge: float  # [N s/m]
    quadratic_surge: float  # [N s2/m2]
    linear_sway: float  # [N s/m]
    quadratic_sway: float  # [N s2/m2]
    linear_yaw: float  # [N m s]
    quadratic_yaw: float  # [N m s2]
    lever_m: float  # of each thruster
    lag_s: float
    k_ahead: float  # [N] per command to the exponent
    k_astern: float
    exponent: float  # 1: the command is a force; 2: a propeller's speed
    command_low: float
    command_high: float
    dead_zone: float  # of the command
    tuning: Tuning


# Places in a packed helm.
LENGTH, BEAM, M_SURGE, M_SWAY, M_YAW, MUNK = range(6)
LIN_SURGE, QUAD_SURGE, LIN_SWAY, QUAD_SWAY, LIN_YAW, QUAD_YAW = range(6, 12)
LEVER, LAG, K_AHEAD, K_ASTERN, EXPONENT, LOW, HIGH, DEAD = range(12, 20)
CRUISE_AHEAD, CRUISE_ASTERN, ACCELERATION, BRAKE, YAW_RATE, YAW_ACCELERATION = range(20, 26)
HEADING_W, HEADING_ZETA, HEADING_TI, SPEED_W, SPEED_TI, LOOKAHEAD, KAPPA = range(26, 33)
HOLD_W, HOLD_TI, HOLD_RADIUS, CLEARANCE, FILTER = range(33, 38)
THRUST_LOW, THRUST_HIGH = range(38, 40)  # steady thrust of one side [N]
SIZE = 40


def packed(helm: Helm) -> FloatArray:
    """(SIZE,) numbers of a helm in the order of this file's places, SI units."""
    own = [getattr(helm, f.name) for f in fields(Helm) if f.name != "tuning"]
    chosen = [getattr(helm.tuning, f.name) for f in fields(Tuning)]
    low = -helm.k_astern * abs(helm.command_low) ** helm.exponent
    high = helm.k_ahead * helm.command_high**helm.exponent
    return np.array([*own, *chosen, low, high], np.float64)
