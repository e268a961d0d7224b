"""Electrical power that a vessel draws: of its thrusters, and of all else on board (the hotel)."""

import math

from mjforage.base.compiled import inlined
from mjforage.physics.hydrodynamics.parameters import VesselParameters
from mjforage.physics.hydrodynamics.thruster import thrust


@inlined
def drawn_power(p: VesselParameters, port: float, starboard: float) -> float:
    """Power [W] from the battery, of both thrusters and of all else on board, at any speed.

    A motor takes its rated power times (T0 / T0_max)^(3/2) of the thrust moored: momentum theory
    with one efficiency (`controllers.propulsion`).

    `port`, `starboard`: lagged commands [rad/s or N].
    """
    left, right = abs(thrust(p, port)) / p.rated_thrust, abs(thrust(p, starboard)) / p.rated_thrust
    return float(p.hotel + p.motor * (left * math.sqrt(left) + right * math.sqrt(right)))
