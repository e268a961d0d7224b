"""Line-of-sight guidance along a straight line, and the speed that can still stop in time.

LOS: Fossen (2021), "Handbook of Marine Craft Hydrodynamics and Motion Control", section 12.3.
ILOS: Borhaug, Pavlov and Pettersen (2008), "Integral LOS control for path following of
underactuated marine surface vessels in the presence of constant ocean currents".
"""

import math

from mjforage.base.compiled import kernel


@kernel
def along_and_across(
    x: float, y: float, x0: float, y0: float, course: float
) -> tuple[float, float]:
    """Distance along a line from (x0, y0) at `course` [rad], and cross-track error to port [m]."""
    dx, dy = x - x0, y - y0
    c, s = math.cos(course), math.sin(course)
    return c * dx + s * dy, c * dy - s * dx


@kernel
def ilos_course(
    course: float, across: float, integral: float, kappa: float, lookahead: float
) -> float:
    """Course to steer [rad]: the path's, minus atan((y_e + kappa y_int) / Delta); LOS with y_int 0.

    Parameters
    ----------
    across : cross-track error y_e to port [m]
    integral : y_int [s]
    kappa : integral gain [m/s]
    lookahead : Delta [m]
    """
    return course - math.atan((across + kappa * integral) / lookahead)


@kernel
def ilos_rate(across: float, integral: float, kappa: float, lookahead: float) -> float:
    """d(y_int)/dt = Delta y_e / (Delta^2 + (y_e + kappa y_int)^2)."""
    sum_ = across + kappa * integral
    return lookahead * across / (lookahead * lookahead + sum_ * sum_)


@kernel
def ilos_integral(drift: float, speed: float, kappa: float, lookahead: float) -> float:
    """y_int [s] at which a vessel of `speed` through the water stays on the line.

    Parameters
    ----------
    drift : speed to port of the line at which the surroundings carry the vessel [m/s]
    """
    ratio = min(max(drift / max(speed, 1e-6), -0.9), 0.9)
    return lookahead * ratio / math.sqrt(1.0 - ratio * ratio) / kappa


@kernel
def stopping_distance(speed: float, brake: float, reaction_s: float) -> float:
    """Distance [m] to rest from `speed`, braking after a reaction time."""
    return speed * reaction_s + 0.5 * speed * speed / brake


@kernel
def stopping_speed(distance: float, brake: float, reaction_s: float) -> float:
    """Inverse of `stopping_distance`: the speed [m/s] that stops within `distance`, 0 if none."""
    if distance <= 0.0:
        return 0.0
    lost = brake * reaction_s
    return math.sqrt(lost * lost + 2.0 * brake * distance) - lost


@kernel
def striking_speed(distance: float, brake: float, reaction_s: float, touch: float) -> float:
    """Speed [m/s] from which braking after a reaction time leaves at most `touch` at `distance`.

    From v, what is left is v^2 - 2 a (d - v t_r), or all of it if d < v t_r.
    """
    lost = brake * reaction_s
    room = max(distance, 0.0)
    return max(math.sqrt(lost * lost + 2.0 * brake * room + touch * touch) - lost, touch)
