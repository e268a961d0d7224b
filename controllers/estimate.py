"""Pose and drift from noisy measurements.

The pose is dead reckoning on the measured velocity, drawn to the fixes. The drift, how current and
wind together carry the vessel, is what the measured velocity has over a model of the vessel's own
speed through the water.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.allocation import thrust_of
from mjforage.controllers.angles import wrapped
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import FloatArray, ModelRecord

LOST_M = 3.0  # a fix farther from the estimate is believed at once
DRIFT_S = 3.0  # time constant of the drift
SLOW_MPS = 0.4  # above this, the vessel's unknown load spoils the drift along it


@kernel
def surge_after(p: ModelRecord, surge: float, force: float, step_s: float) -> float:
    """Speed ahead through the water [m/s] after a step: m u' = T - d(u), drag taken implicitly."""
    drag = p.linear_surge + p.quadratic_surge * abs(surge)
    return float((p.mass_surge_kg * surge + step_s * force) / (p.mass_surge_kg + step_s * drag))


@kernel
def sway_after(p: ModelRecord, sway: float, surge: float, rate: float, step_s: float) -> float:
    """Speed to port through the water [m/s] that turning gives, after a step.

    m_sway v' = -m_surge u r - d(v) v, drag taken implicitly. Measured sway would not do: it has
    the current in it.
    """
    drag = p.linear_sway + p.quadratic_sway * abs(sway)
    pushed = p.mass_sway_kg * sway - step_s * p.mass_surge_kg * surge * rate
    return float(pushed / (p.mass_sway_kg + step_s * drag))


@kernel
def learn_drift(s: VesselState, p: ModelRecord, step_s: float) -> None:
    """Move the modelled speeds through the water and the drift on by a step."""
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, aside = c * s.vx + t * s.vy, c * s.vy - t * s.vx
    if s.in_contact != 0.0:  # what it leans on holds it, by an unknown force
        s.surge = ahead - c * s.drift_x - t * s.drift_y
        s.sway = aside - c * s.drift_y + t * s.drift_x
        return
    beside = p.lever_m * s.rate
    force = thrust_of(p, s.port, s.surge - beside) * (1.0 - s.port_loss)
    force += thrust_of(p, s.starboard, s.surge + beside) * (1.0 - s.starboard_loss)
    s.surge = surge_after(p, s.surge, force, step_s)
    s.sway = sway_after(p, s.sway, s.surge, s.rate, step_s)
    share = step_s / (DRIFT_S + step_s)
    more_aside = share * (aside - s.sway - (c * s.drift_y - t * s.drift_x))
    more_ahead = 0.0
    if abs(s.surge) < SLOW_MPS:
        more_ahead = share * (ahead - s.surge - (c * s.drift_x + t * s.drift_y))
    s.drift_x += c * more_ahead - t * more_aside
    s.drift_y += t * more_ahead + c * more_aside


@kernel
def estimate(
    s: VesselState, p: ModelRecord, pose: FloatArray, velocity: FloatArray, step_s: float
) -> None:
    """Take in a pose x, y [m], yaw [rad] and a velocity over ground, world axes [m/s, rad/s]."""
    x = s.x + 0.5 * step_s * (s.vx + velocity[0])
    y = s.y + 0.5 * step_s * (s.vy + velocity[1])
    yaw = s.yaw + 0.5 * step_s * (s.rate + velocity[2])
    dx, dy = pose[0] - x, pose[1] - y
    s.vx, s.vy, s.rate = velocity[0], velocity[1], velocity[2]
    if s.known == 0.0 or math.sqrt(dx * dx + dy * dy) > LOST_M:
        s.x, s.y, s.yaw, s.known = pose[0], pose[1], pose[2], 1.0
        s.heading_ref = s.wanted = pose[2]
        return
    s.known += 1.0
    share = max(step_s / (p.filter_s + step_s), 1.0 / s.known)  # the first fixes count alike
    s.x, s.y = x + share * dx, y + share * dy
    s.yaw = yaw + share * wrapped(pose[2] - yaw)
    learn_drift(s, p, step_s)
