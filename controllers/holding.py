"""Keeping position with two thrusters: the heading is free, so it follows the force needed."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import wrapped
from mjforage.controllers.loops import integrated
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

FARTHEST_M = 1.0  # a place farther away pulls no harder
LEAST_DRIFT_MPS = 0.06  # a slower drift does not turn the vessel
SLOW_MPS = 0.3  # a vessel faster than this brakes before it turns
SWITCH_RAD = 1.9  # bow and stern change roles beyond this


@kernel
def hold_force(s: VesselState, p: ModelRecord, x: float, y: float) -> tuple[float, float, float]:
    """Heading wanted [rad], surge force [N] and distance ahead [m] to stay at (x, y).

    A spring and a damper pull towards the place, an integral learns the steady force. Where the
    place is more than the hold radius away, or a drift carries the vessel off, bow or stern turn to
    where the vessel must go through the water: towards the place and against the drift.
    """
    dx, dy = x - s.x, y - s.y
    far = math.sqrt(dx * dx + dy * dy)
    if far > FARTHEST_M:
        dx, dy = dx * FARTHEST_M / far, dy * FARTHEST_M / far
    w, mass = p.hold_bandwidth_radps, p.mass_surge_kg
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    speed = c * s.vx + t * s.vy
    drifting = s.drift_x**2 + s.drift_y**2 > LEAST_DRIFT_MPS**2
    if drifting or (far > p.hold_radius_m and abs(speed) < SLOW_MPS):
        go_x, go_y = w * dx, w * dy
        if drifting:
            go_x, go_y = go_x - s.drift_x, go_y - s.drift_y
        if math.sqrt(go_x * go_x + go_y * go_y) > 0.5 * LEAST_DRIFT_MPS:
            towards = math.atan2(go_y, go_x)
            if abs(wrapped(towards - s.yaw)) > SWITCH_RAD:
                towards += math.pi
            s.wanted = towards
    fx, fy = mass * w * w * dx + s.hold_fx, mass * w * w * dy + s.hold_fy
    surge = c * fx + t * fy - 2.0 * mass * w * speed
    return s.wanted, surge, c * dx + t * dy


@kernel
def hold_windup(
    s: VesselState, p: ModelRecord, ahead: float, wanted: float, given: float, step_s: float
) -> None:
    """Move the integral on along the vessel, knowing the force that the thrusters gave [N]."""
    pull = (
        p.mass_surge_kg
        * p.hold_bandwidth_radps
        * p.hold_bandwidth_radps
        * ahead
        / p.hold_integral_s
    )
    change = integrated(0.0, pull, wanted, given, step_s)
    s.hold_fx += change * math.cos(s.yaw)
    s.hold_fy += change * math.sin(s.yaw)
