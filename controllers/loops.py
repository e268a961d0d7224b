"""Heading and speed loops: model-based feedback on references, integrals with anti-windup."""

import math

from controllers._compiled import kernel
from controllers.angles import clipped, wrapped
from controllers.helm import (
    ACCELERATION,
    BRAKE,
    HEADING_TI,
    HEADING_W,
    HEADING_ZETA,
    LENGTH,
    LIN_SURGE,
    LIN_YAW,
    M_SURGE,
    M_YAW,
    MUNK,
    QUAD_SURGE,
    QUAD_YAW,
    SPEED_TI,
    SPEED_W,
    YAW_ACCELERATION,
    YAW_RATE,
    FloatArray,
)
from controllers.reference import heading_reference, speed_reference
from controllers.state import (
    HEADING_REF,
    MOMENT_INTEGRAL,
    RATE,
    RATE_REF,
    SPEED_REF,
    SURGE_INTEGRAL,
    SWAY,
    VX,
    VY,
    YAW,
)

MOST_LEAD_RAD = 0.35  # of the heading reference before the hull; more would be windup
ASIDE = 0.12
MOST_LEAD_S = 0.6  # of the speed reference before the hull, in seconds of its acceleration


@kernel
def surge_drag(p: FloatArray, speed: float) -> float:
    """Drag along the hull [N] at `speed` [m/s]."""
    return float((p[LIN_SURGE] + p[QUAD_SURGE] * abs(speed)) * speed)


@kernel
def yaw_drag(p: FloatArray, rate: float) -> float:
    """Moment of drag [N m] at `rate` [rad/s]."""
    return float((p[LIN_YAW] + p[QUAD_YAW] * abs(rate)) * rate)


@kernel
def integrated(integral: float, rate: float, wanted: float, given: float, step_s: float) -> float:
    """Integral after a step, with anti-windup: it stands still where more would change nothing.

    That is where the thrusters gave less than `wanted`, or more, and `rate` asks for still more of
    it (conditional integration, Astrom and Hagglund 1995).
    """
    return integral if (wanted - given) * rate > 0.0 else integral + step_s * rate


@kernel
def heading_moment(
    s: FloatArray, p: FloatArray, wanted: float, most_rate: float, step_s: float
) -> float:
    """Moment [N m] that turns the hull to the heading `wanted` along its reference.

    N = d(r_d) r_d + m (r_d' + 2 zeta w (r_d - r) + w^2 (psi_d - psi)) + Munk moment + integral.
    """
    lead = wrapped(s[HEADING_REF] - s[YAW])
    if abs(lead) > MOST_LEAD_RAD:
        s[HEADING_REF] = s[YAW] + clipped(lead, -MOST_LEAD_RAD, MOST_LEAD_RAD)
    before = s[RATE_REF]
    s[HEADING_REF], s[RATE_REF] = heading_reference(
        s[HEADING_REF], before, wanted, most_rate, p[YAW_ACCELERATION], step_s
    )
    acceleration = (s[RATE_REF] - before) / step_s
    w = p[HEADING_W]
    damping = 2.0 * p[HEADING_ZETA] * w * (s[RATE_REF] - s[RATE])
    spring = w * w * wrapped(s[HEADING_REF] - s[YAW])
    free = p[M_YAW] * (acceleration + damping + spring)
    munk = p[MUNK] * s[SWAY] * (math.cos(s[YAW]) * s[VX] + math.sin(s[YAW]) * s[VY])
    return float(yaw_drag(p, s[RATE_REF]) + free + munk + s[MOMENT_INTEGRAL])


@kernel
def heading_windup(
    s: FloatArray, p: FloatArray, wanted: float, given: float, step_s: float
) -> None:
    """Move the heading loop's integral on, knowing the moment that the thrusters gave [N m]."""
    w, t = p[HEADING_W], p[HEADING_TI]
    pull = p[M_YAW] * w * w * wrapped(s[HEADING_REF] - s[YAW]) / t
    s[MOMENT_INTEGRAL] = integrated(s[MOMENT_INTEGRAL], pull, wanted, given, step_s)


@kernel
def surge_force(s: FloatArray, p: FloatArray, speed: float, wanted: float, step_s: float) -> float:
    """Force [N] that brings the hull from `speed` to `wanted` [m/s] along its reference."""
    reach = MOST_LEAD_S * p[ACCELERATION]
    before = clipped(s[SPEED_REF], speed - reach, speed + reach)
    s[SPEED_REF] = speed_reference(before, wanted, p[ACCELERATION], p[BRAKE], step_s)
    acceleration = (s[SPEED_REF] - before) / step_s + p[SPEED_W] * (s[SPEED_REF] - speed)
    return float(surge_drag(p, s[SPEED_REF]) + p[M_SURGE] * acceleration + s[SURGE_INTEGRAL])


@kernel
def surge_windup(
    s: FloatArray, p: FloatArray, speed: float, wanted: float, given: float, step_s: float
) -> None:
    """Move the speed loop's integral on, knowing the force that the thrusters gave [N]."""
    pull = p[M_SURGE] * p[SPEED_W] * (s[SPEED_REF] - speed) / p[SPEED_TI]
    s[SURGE_INTEGRAL] = integrated(s[SURGE_INTEGRAL], pull, wanted, given, step_s)


@kernel
def turning_limit(p: FloatArray, cosine: float) -> float:
    """Speed [m/s] at which the rest of a turn leads at most `ASIDE` lengths aside.

    Turning through e at rate r and speed u leads u/r (1 - cos e) aside; beyond 90 degrees nothing
    would be gained.

    Parameters
    ----------
    cosine : of the heading error e
    """
    if cosine <= 0.0:
        return 0.0
    return float(ASIDE * p[LENGTH] * p[YAW_RATE] / max(1.0 - cosine, 1e-3))
