"""Thrust of a propeller under way, of a command that takes the same power at any speed.

A motor with a set power: the water gets what it gets moored, where a disc of area A gives the
thrust T0 with an induced velocity w0 = sqrt(T0 / (2 rho A)). In an inflow u momentum theory
(Carlton, Marine Propellers and Propulsion, chapter 8) has

    T = 2 rho A w (u + w),    T (u + w) = T0 w0,

so that v = u + w is the root of v^3 - u v^2 = w0^3, and T = T0 w0 / v. An inflow from astern counts
as none. The electrical power is the motor's at full thrust times (T0 / T0_max)^(3/2).
"""

import math

from mjforage.base.compiled import kernel

WATER_DENSITY_KGPM3 = 1025.0  # sea water


@kernel
def through_disc(moored: float, inflow: float, disc: float) -> tuple[float, float]:
    """Speed of the water through a disc, moored and in an inflow [m/s].

    Parameters
    ----------
    moored : thrust [N], above 0
    inflow : [m/s], at least 0
    disc : 2 rho A [kg/m], above 0
    """
    still = math.sqrt(moored / disc)
    cube, third = still * still * still, inflow / 3.0
    middle = third * third * third + 0.5 * cube
    root = (middle + math.sqrt(cube * (middle - 0.25 * cube))) ** (1.0 / 3.0)
    return still, third + root + third * third / root


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
    if disc == 0.0 or moored == 0.0 or inflow <= 0.0:
        return moored
    still, through = through_disc(abs(moored), inflow, disc)
    return moored * still / through


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
    """Fall of the thrust ahead with the speed [N s/m], at least 0: T / (3 v - 2 u)."""
    inflow = speed if moored > 0.0 else -speed
    if disc == 0.0 or moored == 0.0 or inflow <= 0.0:
        return 0.0
    still, through = through_disc(abs(moored), inflow, disc)
    return abs(moored) * still / (through * (3.0 * through - 2.0 * inflow))
