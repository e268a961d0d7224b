"""Wind load after Blendermann (1994), "Parameter identification of wind loads on ships"."""

import math

from mjforage.base.compiled import kernel
from mjforage.physics.hydrodynamics.parameters import VesselParameters


@kernel
def wind_slope(p: VesselParameters, wind_u: float, wind_v: float) -> tuple[float, float]:
    """Slope of the wind load as the vessel gives way: -dX/du, -dY/dv [N s/m], never below 0.

    Slopes of V u and V v; that of Blendermann's denominator is left out. Parameters as in
    `wind_force`.
    """
    speed = math.sqrt(wind_u * wind_u + wind_v * wind_v)
    if speed == 0.0:
        return 0.0, 0.0
    cdl = p.wind_cdl_bow if wind_u <= 0.0 else p.wind_cdl_stern
    return (
        p.wind_front * cdl * (speed + wind_u * wind_u / speed),
        p.wind_side * p.wind_cdt * (speed + wind_v * wind_v / speed),
    )


@kernel
def wind_force(p: VesselParameters, wind_u: float, wind_v: float) -> tuple[float, float, float]:
    """Wind load in body axes; mirror-symmetric, zero for zero areas.

    With g the angle between bow and where the wind comes from, 0 to pi on either side:
    X = q A_F CDl cos(g)/den aft, Y = q A_L CDt sin(g)/den to leeward, N = (s_L - 0.18 (g - pi/2) L)
    Y, den = 1 - delta/2 (1 - CDl/CDt) sin^2(2g), q = 1/2 rho V^2.

    `wind_u`, `wind_v`: velocity of the air relative to the vessel, forward and to port [m/s].
    Returns: x forward [N], Y to port [N], N counter-clockwise [N m], at midships.
    """
    squared = wind_u * wind_u + wind_v * wind_v
    if squared == 0.0 or (p.wind_front == 0.0 and p.wind_side == 0.0):
        return 0.0, 0.0, 0.0
    speed = math.sqrt(squared)
    cdt = p.wind_cdt
    cdl = p.wind_cdl_bow if wind_u <= 0.0 else p.wind_cdl_stern
    doubled = 2.0 * wind_u * wind_v / squared  # -+ sin(2g)
    den = 1.0 - 0.5 * p.wind_delta * (1.0 - cdl / cdt) * doubled * doubled
    x = p.wind_front * cdl * speed * wind_u / den
    y = p.wind_side * cdt * speed * wind_v / den
    g = math.atan2(abs(wind_v), -wind_u)
    return x, y, (p.wind_sl - 0.18 * (g - 0.5 * math.pi) * p.length) * y
