"""Following a leg: one straight line to a waypoint, ahead or astern, and choosing which."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import wrapped
from mjforage.controllers.guidance import (
    along_and_across,
    ilos_course,
    ilos_integral,
    ilos_rate,
    stopping_speed,
)
from mjforage.controllers.loops import turning_limit
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

ASTERN_HANDICAP_S = 0.5  # ahead is preferred by so much
REACTION_S = 0.1  # of a loop at 10 Hz, added to the thruster's lag
LEAST_SPEED_MPS = 0.2  # through the water, at which the line-of-sight integral learns
LEAST_LOOKAHEAD_M = 1.0  # near its end the line is left for the end itself, down to here
FERRY_MPS = 0.1  # a drift from which a leg is ferried
LONG_M = 20.0  # a leg of this length is followed by its integral, which knows no model
VIA_SPEED = 0.6  # of cruise, at which a via point is passed


@kernel
def made_good(speed: float, along: float, across: float) -> float:
    """Speed over ground along a line [m/s] at `speed` through the water in a drift [m/s]."""
    left = speed * speed - across * across
    return max((math.sqrt(left) if left > 0.0 else 0.0) + along, 0.1)


@kernel
def best_way(p: ModelRecord, error: float, distance: float, along: float, across: float) -> float:
    """1 to go ahead or -1 to go astern, whichever is sooner there.

    Parameters
    ----------
    error : course of the leg minus heading [rad]
    along, across : drift along the leg and to port of it [m/s]
    """
    turn = abs(wrapped(error))
    ahead = turn / p.yaw_rate_radps + distance / made_good(p.cruise_ahead_mps, along, across)
    astern = distance / made_good(p.cruise_astern_mps, along, across)
    astern += (math.pi - turn) / p.yaw_rate_radps + ASTERN_HANDICAP_S
    return 1.0 if ahead <= astern else -1.0


@kernel
def lay_leg(
    s: VesselState, p: ModelRecord, x0: float, y0: float, x1: float, y1: float, via: bool
) -> None:
    """Make the line from (x0, y0) to (x1, y1) the one to follow."""
    dx, dy = x1 - x0, y1 - y0
    length = math.sqrt(dx * dx + dy * dy)
    if length < 1e-6:
        dx, dy = x1 - s.x, y1 - s.y
    course = math.atan2(dy, dx)
    s.leg_x, s.leg_y, s.end_x, s.end_y = x0, y0, x1, y1
    s.course, s.leg_length, s.via = course, length, 1.0 if via else 0.0
    c, t = math.cos(course), math.sin(course)
    along, aside = c * s.drift_x + t * s.drift_y, c * s.drift_y - t * s.drift_x
    s.way = best_way(p, course - s.yaw, length, along, aside)
    cruise = p.cruise_ahead_mps if s.way > 0.0 else p.cruise_astern_mps
    s.across_integral = ilos_integral(aside, cruise, p.drift_gain_mps, p.lookahead_m)


@kernel
def stemming_speed(s: VesselState, wanted: float, error: float, steer: float) -> float:
    """Speed through the water along the way [m/s] that lets no drift across the course.

    While the vessel turns, its way m gives U (m . n) to port n of the course, which shall undo the
    drift D . n.

    Parameters
    ----------
    wanted : speed through the water once it has turned [m/s]
    error : of the heading [rad]
    steer : course over ground [rad]
    """
    c, t = s.way * math.cos(s.yaw), s.way * math.sin(s.yaw)
    across = t * math.cos(steer) - c * math.sin(steer)
    drift = math.cos(steer) * s.drift_y - math.sin(steer) * s.drift_x
    if across * drift >= 0.0 or abs(error) > 0.5 * math.pi:
        return 0.0
    return float(min(-drift / across, wanted))


@kernel
def follow_in_drift(
    s: VesselState, p: ModelRecord, across: float, left: float, speed: float
) -> tuple[float, float]:
    """Heading [rad] and signed speed over ground along the vessel [m/s] for a speed along the leg.

    Ferrying: through the water the vessel must make what it shall make over ground less the drift.
    """
    lookahead = min(p.lookahead_m, max(left, LEAST_LOOKAHEAD_M))
    steer = ilos_course(s.course, across, 0.0, p.drift_gain_mps, lookahead)
    wx = speed * math.cos(steer) - s.drift_x
    wy = speed * math.sin(steer) - s.drift_y
    through = math.sqrt(wx * wx + wy * wy)
    heading = math.atan2(wy, wx) if s.way > 0.0 else math.atan2(-wy, -wx)
    error = wrapped(heading - s.yaw)
    free = max(turning_limit(p, math.cos(error)), stemming_speed(s, through, error, steer))
    made = s.way * min(through, free)
    along = math.cos(s.yaw) * s.drift_x + math.sin(s.yaw) * s.drift_y
    return heading, made + along


@kernel
def follow_leg(s: VesselState, p: ModelRecord, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed over ground along the vessel [m/s] wanted."""
    along, across = along_and_across(s.x, s.y, s.leg_x, s.leg_y, s.course)
    left = s.leg_length - along
    cruise = p.cruise_ahead_mps if s.way > 0.0 else p.cruise_astern_mps
    room = left if s.via == 0.0 else left + 0.5 * (VIA_SPEED * cruise) ** 2 / p.brake_mps2
    speed = min(cruise, stopping_speed(room, p.brake_mps2, p.lag_s + REACTION_S))
    if s.via == 0.0 and s.clock < s.wait:
        speed = 0.0
    drift = math.sqrt(s.drift_x**2 + s.drift_y**2)
    if drift > FERRY_MPS and s.leg_length < LONG_M:
        return follow_in_drift(s, p, across, left, speed)
    lookahead = min(p.lookahead_m, max(left, LEAST_LOOKAHEAD_M))
    steer = ilos_course(s.course, across, s.across_integral, p.drift_gain_mps, lookahead)
    made = s.way * (math.cos(s.yaw) * s.vx + math.sin(s.yaw) * s.vy)
    heading = steer if s.way > 0.0 else steer + math.pi
    error = wrapped(heading - s.yaw)
    straight = abs(error) < 0.2 and abs(s.rate) < 0.15 and abs(across) < 0.3 * p.lookahead_m
    if straight and made > LEAST_SPEED_MPS:
        rate = ilos_rate(across, s.across_integral, p.drift_gain_mps, p.lookahead_m)
        s.across_integral += step_s * rate
    return heading, s.way * min(speed, turning_limit(p, math.cos(error)))
