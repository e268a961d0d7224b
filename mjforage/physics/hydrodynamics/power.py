"""Electrical power that a vessel draws: of its thrusters, and of all else on board (the hotel)."""

import math

from mjforage.base.compiled import inlined
from mjforage.physics.hydrodynamics.parameters import VesselParameters
from mjforage.physics.hydrodynamics.thruster import thrust

WATER_DENSITY_KGPM3 = 1025.0  # sea water


@inlined
def least_power(disc_m2: float, force: float, inflow_mps: float) -> float:
    """Least power [W] that makes a thrust T in an inflow u: T (u + sqrt(u^2 + 2 T / (rho A))) / 2.

    Momentum theory of an actuator disc (Carlton, Marine Propellers and Propulsion, chapter 8).
    Inflow against the thrust counts as none.
    """
    size, along = abs(force), max(0.0, inflow_mps if force > 0.0 else -inflow_mps)
    wash = math.sqrt(along * along + 2.0 * size / (WATER_DENSITY_KGPM3 * disc_m2))
    return 0.5 * size * (along + wash)


@inlined
def drawn_power(p: VesselParameters, port: float, starboard: float, u_r: float) -> float:
    """Power [W] from the battery: of both thrusters, and of all else on board.

    Parameters
    ----------
    port, starboard : lagged commands [rad/s or N]
    u_r : surge velocity relative to the water [m/s]
    """
    left = least_power(p.disc, thrust(p, port), u_r)
    right = least_power(p.disc, thrust(p, starboard), u_r)
    return p.hotel + (left + right) / p.efficiency
