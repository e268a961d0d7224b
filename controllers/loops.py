"""Heading and speed loops: model-based feedback on references, integrals with anti-windup.

References are headings and speeds that a vessel can follow towards those commanded.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import clipped, wrapped
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

MOST_LEAD_RAD = 0.35  # of the heading reference before the vessel; more would be windup
ASIDE = 0.12  # lengths that a turn under way may lead aside
MOST_LEAD_S = 0.6  # of the speed reference before the vessel, in seconds of its acceleration


@kernel
def heading_reference(
    heading: float,
    rate: float,
    wanted: float,
    most_rate: float,
    most_acceleration: float,
    step_s: float,
) -> tuple[float, float]:
    """Heading reference and its rate after a step, by the short way and without overshoot.

    The rate goes for the largest from which the rest of the turn still allows to stop,
    min(most_rate, sqrt(2 a |e|)), changing by at most `most_acceleration`; half of that is used
    to stop, so that the steps of time leave no overshoot.

    Returns
    -------
    heading [rad], rate [rad/s]
    """
    error = wrapped(wanted - heading)
    reach = min(math.sqrt(most_acceleration * abs(error)), abs(error) / (2.0 * step_s))
    target = math.copysign(min(most_rate, reach), error)
    change = most_acceleration * step_s
    following = rate + clipped(target - rate, -change, change)
    return heading + 0.5 * (rate + following) * step_s, following


@kernel
def speed_reference(
    speed: float, wanted: float, acceleration: float, brake: float, step_s: float
) -> float:
    """Speed reference after a step; away from rest with `acceleration`, towards it with `brake`."""
    if speed * wanted < 0.0:
        return math.copysign(max(abs(speed) - brake * step_s, 0.0), speed)
    if abs(wanted) < abs(speed):
        return math.copysign(max(abs(speed) - brake * step_s, abs(wanted)), speed)
    return math.copysign(min(abs(speed) + acceleration * step_s, abs(wanted)), wanted)


@kernel
def surge_drag(p: ModelRecord, speed: float) -> float:
    """Drag along the vessel [N] at `speed` [m/s]."""
    return float((p.linear_surge + p.quadratic_surge * abs(speed)) * speed)


@kernel
def yaw_drag(p: ModelRecord, rate: float) -> float:
    """Moment of drag [N m] at `rate` [rad/s]."""
    return float((p.linear_yaw + p.quadratic_yaw * abs(rate)) * rate)


@kernel
def integrated(integral: float, rate: float, wanted: float, given: float, step_s: float) -> float:
    """Integral after a step, with anti-windup: it stands still where more would change nothing.

    That is where the thrusters gave less than `wanted`, or more, and `rate` asks for still more of
    it (conditional integration, Astrom and Hagglund 1995).
    """
    return integral if (wanted - given) * rate > 0.0 else integral + step_s * rate


@kernel
def munk_moment(s: VesselState, p: ModelRecord) -> float:
    """Moment [N m] against that of the water on a vessel that moves ahead and aside."""
    return float(p.munk_kg * s.sway * (math.cos(s.yaw) * s.vx + math.sin(s.yaw) * s.vy))


@kernel
def heading_moment(
    s: VesselState, p: ModelRecord, wanted: float, most_rate: float, step_s: float
) -> float:
    """Moment [N m] that turns the vessel to the heading `wanted` along its reference.

    N = d(r_d) r_d + m (r_d' + 2 zeta w (r_d - r) + w^2 (psi_d - psi)) + M x_g u r_d + Munk moment
    + integral.
    """
    lead = wrapped(s.heading_ref - s.yaw)
    if abs(lead) > MOST_LEAD_RAD:
        s.heading_ref = s.yaw + clipped(lead, -MOST_LEAD_RAD, MOST_LEAD_RAD)
    before = s.rate_ref
    s.heading_ref, s.rate_ref = heading_reference(
        s.heading_ref, before, wanted, most_rate, p.yaw_acceleration_radps2, step_s
    )
    acceleration = (s.rate_ref - before) / step_s
    w = p.heading_bandwidth_radps
    damping = 2.0 * p.heading_damping * w * (s.rate_ref - s.rate)
    spring = w * w * wrapped(s.heading_ref - s.yaw)
    free = p.inertia_yaw_kgm2 * (acceleration + damping + spring)
    carried = p.offset_kgm * s.rate_ref * (math.cos(s.yaw) * s.vx + math.sin(s.yaw) * s.vy)
    return float(yaw_drag(p, s.rate_ref) + carried + free + munk_moment(s, p) + s.moment_integral)


@kernel
def heading_windup(
    s: VesselState, p: ModelRecord, wanted: float, given: float, step_s: float
) -> None:
    """Move the heading loop's integral on, knowing the moment that the thrusters gave [N m]."""
    w, t = p.heading_bandwidth_radps, p.heading_integral_s
    pull = p.inertia_yaw_kgm2 * w * w * wrapped(s.heading_ref - s.yaw) / t
    s.moment_integral = integrated(s.moment_integral, pull, wanted, given, step_s)


@kernel
def surge_force(
    s: VesselState, p: ModelRecord, speed: float, wanted: float, step_s: float
) -> float:
    """Force [N] that brings the vessel from `speed` to `wanted` [m/s] along its reference."""
    reach = MOST_LEAD_S * p.acceleration_mps2
    before = clipped(s.speed_ref, speed - reach, speed + reach)
    s.speed_ref = speed_reference(before, wanted, p.acceleration_mps2, p.brake_mps2, step_s)
    acceleration = (s.speed_ref - before) / step_s + p.speed_bandwidth_radps * (s.speed_ref - speed)
    return float(surge_drag(p, s.speed_ref) + p.mass_surge_kg * acceleration + s.surge_integral)


@kernel
def surge_windup(
    s: VesselState, p: ModelRecord, speed: float, wanted: float, given: float, step_s: float
) -> None:
    """Move the speed loop's integral on, knowing the force that the thrusters gave [N]."""
    pull = p.mass_surge_kg * p.speed_bandwidth_radps * (s.speed_ref - speed) / p.speed_integral_s
    s.surge_integral = integrated(s.surge_integral, pull, wanted, given, step_s)


@kernel
def turning_limit(p: ModelRecord, cosine: float) -> float:
    """Speed [m/s] at which the rest of a turn leads at most `ASIDE` lengths aside.

    Turning through e at rate r and speed u leads u/r (1 - cos e) aside; beyond 90 degrees nothing
    would be gained.

    Parameters
    ----------
    cosine : of the heading error e
    """
    if cosine <= 0.0:
        return 0.0
    return float(ASIDE * p.length_m * p.yaw_rate_radps / max(1.0 - cosine, 1e-3))
