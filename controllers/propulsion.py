"""Thrust of a propeller under way, of a command that takes the same power at any speed.

A motor with a set power: the water gets what it gets moored, where a disc of area A gives the
thrust T0 with an induced velocity w0 = sqrt(T0 / (2 rho A)). In an inflow u momentum theory
(Carlton, Marine Propellers and Propulsion, chapter 8) has

    T = 2 rho A w (u + w),    T (u + w) = T0 w0,

so that the share y = T / T0 that is left is the root of y^3 + (u / w0) y = 1. An inflow from astern
counts as none. The electrical power is the motor's at full thrust times (T0 / T0_max)^(3/2).
"""

import math

from mjforage.base.compiled import inlined, kernel

WATER_DENSITY_KGPM3 = 1025.0  # sea water
LEAST_N = 1e-12  # of a thrust that falls; less, as of a command that dies away, is next to none


@inlined
def share_left(advance: float) -> float:
    """Share y of the thrust moored that is left: the root of y^3 + a y = 1.

    Newton's steps from an estimate that is right for small and for large a: to 4e-15 of y.

    Parameters
    ----------
    advance : a, inflow over the induced velocity moored, at least 0
    """
    y = (3.0 + advance) / (3.0 + advance * (2.0 + advance))
    for _ in range(3):
        square = y * y
        y = (2.0 * square * y + 1.0) / (3.0 * square + advance)
    return y


@kernel
def thrust_under_way(moored: float, speed: float, disc: float) -> float:
    """Thrust [N] at a speed through the water, of a command whose thrust moored is known.

    Parameters
    ----------
    moored : [N], ahead positive
    speed : of the propeller ahead through the water [m/s]
    disc : 2 rho A of each propeller [kg/m]; 0: thrust does not fall with speed
    """
    inflow = speed if moored > 0.0 else -speed
    if disc == 0.0 or abs(moored) < LEAST_N or inflow <= 0.0:
        return moored
    return moored * share_left(inflow / math.sqrt(abs(moored) / disc))


@kernel
def moored_thrust(thrust: float, speed: float, disc: float) -> float:
    """Thrust [N] that the command for `thrust` at a speed gives moored, see `thrust_under_way`."""
    inflow = speed if thrust > 0.0 else -speed
    if disc == 0.0 or thrust == 0.0 or inflow <= 0.0:
        return thrust
    size = abs(thrust)
    through = 0.5 * (inflow + math.sqrt(inflow * inflow + 4.0 * size / disc))
    return math.copysign(disc * (size * through / disc) ** (2.0 / 3.0), thrust)


@kernel
def thrust_slope(moored: float, speed: float, disc: float) -> float:
    """Fall of the thrust ahead with the speed [N s/m], at least 0: T0 / w0 y / (3 y^2 + a)."""
    inflow = speed if moored > 0.0 else -speed
    if disc == 0.0 or abs(moored) < LEAST_N or inflow <= 0.0:
        return 0.0
    still = math.sqrt(abs(moored) / disc)
    y = share_left(inflow / still)
    return disc * still * y / (3.0 * y * y + inflow / still)
