"""Thrusters that weaken or die: noticed from what the hull does, and a model as weak as it is.

A Kalman filter estimates the share l of the thrust T that each side has lost, and a moment b of
wind and water that is not modelled. By the vessel's model, in units of one side's full thrust,

    (I r' + d(r) r - munk) / lever + T_p - T_s = l_p T_p - l_s T_s + b
    m u' + d(u) - m_sway v r - T_p - T_s = -(l_p T_p + l_s T_s).

Both sides are low-pass filtered, which needs no derivative (filtered equation error: Ioannou and
Sun, "Robust Adaptive Control", 1996, section 4.3). The losses are a random walk; b is a
Gauss-Markov process, as strong as the drift. What both sides have lost alike may be a load: the
difference counts. Where quays or vessels push, the filter stands still.
"""

import math
from typing import Any

from mjforage.base.compiled import kernel
from mjforage.controllers.allocation import thrust_of
from mjforage.controllers.angles import clipped
from mjforage.controllers.loops import munk_moment, surge_drag, yaw_drag
from mjforage.controllers.state import FleetArray, VesselState
from mjforage.controllers.vessel_model import ModelArray, ModelRecord

SMOOTH_S = 1.0  # time constant of the low-pass filters
REST_S = 4.0  # after a contact, until the filters have forgotten it
WALK = 1e-5  # variance by which a loss may change [1/s]
MOST_VAR = 0.05  # of a loss, as at first
BIAS_S = 60.0  # memory of the moment that is not modelled
LEAST_BIAS, DRIFT_BIAS = 0.03, 1.0  # its deviation in calm water; and of the drift's load aside
NOISE_S = 0.03  # density of the noise of both equations [s]
MUNK, DRIFTING = 5.0, 10.0  # by which Munk's moment and a drift make noise grow
MOST_OFF = 0.4  # of an innovation
BEGINS, ENDS = 0.2, 0.1  # differences of the losses at which a fault begins and ends
SURE = 3.0  # standard deviations by which it is above that
MOST_LOSS = 0.9  # that is counted with
LAME_LOSS = 0.6  # of one side, from which the other cannot hold a course with it


@kernel
def is_lame(s: VesselState) -> bool:
    """True if one of a vessel's thrusters is nearly dead, as noticed."""
    return bool(max(s.port_loss, s.starboard_loss) > LAME_LOSS)


@kernel
def weigh(
    s: VesselState, port: float, starboard: float, bias: float, seen: float, noise: float
) -> None:
    """Correct the estimates by one measurement, seen = port l_p + starboard l_s + bias b + noise.

    Parameters
    ----------
    noise : its variance
    """
    to_port = s.port_var * port + s.cross_var * starboard + s.port_bias_var * bias
    to_starboard = s.cross_var * port + s.starboard_var * starboard + s.starboard_bias_var * bias
    to_bias = s.port_bias_var * port + s.starboard_bias_var * starboard + s.bias_var * bias
    spread = port * to_port + starboard * to_starboard + bias * to_bias + noise
    off = seen - port * s.port_off - starboard * s.starboard_off - bias * s.bias
    off = clipped(off, -MOST_OFF, MOST_OFF) / spread
    s.port_off += to_port * off
    s.starboard_off += to_starboard * off
    s.bias += to_bias * off
    s.port_var -= to_port * to_port / spread
    s.starboard_var -= to_starboard * to_starboard / spread
    s.bias_var -= to_bias * to_bias / spread
    s.cross_var -= to_port * to_starboard / spread
    s.port_bias_var -= to_port * to_bias / spread
    s.starboard_bias_var -= to_starboard * to_bias / spread


@kernel
def carry_on(s: VesselState, deviation: float, fades: float, step_s: float) -> None:
    """A step without a measurement: losses may have changed, the bias is forgotten.

    Parameters
    ----------
    deviation : standard deviation of a bias of which nothing is known
    fades : share of the bias that is left
    """
    s.port_var = min(s.port_var + step_s * WALK, MOST_VAR)
    s.starboard_var = min(s.starboard_var + step_s * WALK, MOST_VAR)
    s.bias *= fades
    s.port_bias_var *= fades
    s.starboard_bias_var *= fades
    s.bias_var = deviation**2 + fades * fades * (s.bias_var - deviation**2)


@kernel
def count_loss(s: VesselState) -> None:
    """Count with a loss once it is sure and large, until it is small."""
    lost = s.port_off - s.starboard_off
    sure = SURE * math.sqrt(s.port_var + s.starboard_var - 2.0 * s.cross_var)
    counts = s.port_loss > 0.0 or s.starboard_loss > 0.0
    if abs(lost) < (ENDS if counts else BEGINS + sure):
        lost = 0.0
    s.port_loss, s.starboard_loss = clipped(lost, 0.0, MOST_LOSS), clipped(-lost, 0.0, MOST_LOSS)


@kernel
def notice_losses(s: VesselState, p: ModelRecord, step_s: float) -> None:
    """Move the estimated losses of both thrusters on by a step."""
    c, t, full = math.cos(s.yaw), math.sin(s.yaw), p.thrust_high
    surge = c * (s.vx - s.drift_x) + t * (s.vy - s.drift_y)
    if s.port_var == 0.0:
        s.port_var = s.starboard_var = MOST_VAR
    if s.in_contact != 0.0 or s.free_s == 0.0:
        s.free_s = s.slow_moment = s.slow_force = s.slow_port = s.slow_starboard = 0.0
        s.slow_rate, s.slow_surge = s.rate, surge
    beside = p.lever_m * s.rate
    port = thrust_of(p, s.port, surge - beside)
    starboard = thrust_of(p, s.starboard, surge + beside)
    munk = munk_moment(s, p)
    moment = (yaw_drag(p, s.rate) - munk) / p.lever_m + port - starboard
    force = surge_drag(p, surge) - port - starboard - p.mass_sway_kg * s.sway * s.rate
    share = step_s / (SMOOTH_S + step_s)
    s.slow_moment += share * (moment - s.slow_moment)
    s.slow_force += share * (force - s.slow_force)
    s.slow_port += share * (port - s.slow_port)
    s.slow_starboard += share * (starboard - s.slow_starboard)
    s.slow_rate += share * (s.rate - s.slow_rate)
    s.slow_surge += share * (surge - s.slow_surge)
    s.free_s += step_s
    drift = math.sqrt(s.drift_x**2 + s.drift_y**2)
    load = (p.linear_sway + p.quadratic_sway * drift) * drift / full
    deviation = LEAST_BIAS + DRIFT_BIAS * load
    rests = s.free_s < REST_S
    carry_on(s, deviation, 0.0 if rests else math.exp(-step_s / BIAS_S), step_s)
    if rests:
        return
    left, right = s.slow_port / full, s.slow_starboard / full
    turned = p.inertia_yaw_kgm2 / p.lever_m * (s.rate - s.slow_rate) / SMOOTH_S + s.slow_moment
    noise = NOISE_S / step_s * (1.0 + (MUNK * munk / (p.lever_m * full)) ** 2)
    weigh(s, left, -right, 1.0, turned / full, noise)
    pushed = p.mass_surge_kg * (surge - s.slow_surge) / SMOOTH_S + s.slow_force
    noise = NOISE_S / step_s * (1.0 + (DRIFTING * deviation) ** 2)
    weigh(s, -left, -right, 0.0, pushed / full, noise)
    count_loss(s)


@kernel
def weaken(s: VesselState, p: Any) -> None:
    """Lower the speeds and accelerations of a vessel's own model by what its thrusters have lost.

    Straight on both sides give what the weaker can; turning takes the sum of both. Speeds are those
    that quadratic drag allows.

    Parameters
    ----------
    p : a `ModelRecord`, changed
    """
    straight = 1.0 - max(s.port_loss, s.starboard_loss)
    turning = 1.0 - 0.5 * (s.port_loss + s.starboard_loss)
    p.cruise_ahead_mps *= math.sqrt(straight)
    p.cruise_astern_mps *= math.sqrt(straight)
    p.yaw_rate_radps *= math.sqrt(turning)
    p.acceleration_mps2 *= straight
    p.brake_mps2 *= straight
    p.yaw_acceleration_radps2 *= turning


@kernel
def weaken_fleet(fleet: FleetArray, models: ModelArray, own: ModelArray) -> None:
    """Fill in the models `own` (vessel,) of vessels as weak as they are."""
    for v in range(models.shape[0]):
        own[v] = models[v]
        weaken(fleet[v], own[v])
