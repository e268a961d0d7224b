"""Following a leg: one straight line to a waypoint, ahead or astern, and choosing which."""

import math

from controllers._compiled import kernel
from controllers.angles import wrapped
from controllers.guidance import (
    along_and_across,
    ilos_course,
    ilos_integral,
    ilos_rate,
    los_course,
    stopping_speed,
)
from controllers.helm import (
    BRAKE,
    CRUISE_AHEAD,
    CRUISE_ASTERN,
    KAPPA,
    LAG,
    LOOKAHEAD,
    YAW_RATE,
    FloatArray,
)
from controllers.loops import turning_limit
from controllers.state import (
    ACROSS_INTEGRAL,
    CLOCK,
    COURSE,
    DRIFT_X,
    DRIFT_Y,
    END_X,
    END_Y,
    LEG_LENGTH,
    LEG_X,
    LEG_Y,
    RATE,
    VIA,
    VX,
    VY,
    WAIT,
    WAY,
    YAW,
    X,
    Y,
)

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
def best_way(p: FloatArray, error: float, distance: float, along: float, across: float) -> float:
    """1 to go ahead or -1 to go astern, whichever is sooner there.

    Parameters
    ----------
    error : course of the leg minus heading [rad]
    along, across : drift along the leg and to port of it [m/s]
    """
    turn = abs(wrapped(error))
    ahead = turn / p[YAW_RATE] + distance / made_good(p[CRUISE_AHEAD], along, across)
    astern = distance / made_good(p[CRUISE_ASTERN], along, across)
    astern += (math.pi - turn) / p[YAW_RATE] + ASTERN_HANDICAP_S
    return 1.0 if ahead <= astern else -1.0


@kernel
def lay_leg(
    s: FloatArray, p: FloatArray, x0: float, y0: float, x1: float, y1: float, via: bool
) -> None:
    """Make the line from (x0, y0) to (x1, y1) the one to follow."""
    dx, dy = x1 - x0, y1 - y0
    length = math.sqrt(dx * dx + dy * dy)
    if length < 1e-6:
        dx, dy = x1 - s[X], y1 - s[Y]
    course = math.atan2(dy, dx)
    s[LEG_X], s[LEG_Y], s[END_X], s[END_Y] = x0, y0, x1, y1
    s[COURSE], s[LEG_LENGTH], s[VIA] = course, length, 1.0 if via else 0.0
    c, t = math.cos(course), math.sin(course)
    along, aside = c * s[DRIFT_X] + t * s[DRIFT_Y], c * s[DRIFT_Y] - t * s[DRIFT_X]
    s[WAY] = best_way(p, course - s[YAW], length, along, aside)
    cruise = p[CRUISE_AHEAD] if s[WAY] > 0.0 else p[CRUISE_ASTERN]
    s[ACROSS_INTEGRAL] = ilos_integral(aside, cruise, p[KAPPA], p[LOOKAHEAD])


@kernel
def stemming_speed(s: FloatArray, wanted: float, error: float, steer: float) -> float:
    """Speed through the water along the way [m/s] that lets no drift across the course.

    While the hull turns, its way m gives U (m . n) to port n of the course, which shall undo the
    drift D . n.

    Parameters
    ----------
    wanted : speed through the water once it has turned [m/s]
    error : of the heading [rad]
    steer : course over ground [rad]
    """
    c, t = s[WAY] * math.cos(s[YAW]), s[WAY] * math.sin(s[YAW])
    across = t * math.cos(steer) - c * math.sin(steer)
    drift = math.cos(steer) * s[DRIFT_Y] - math.sin(steer) * s[DRIFT_X]
    if across * drift >= 0.0 or abs(error) > 0.5 * math.pi:
        return 0.0
    return float(min(-drift / across, wanted))


@kernel
def follow_in_drift(
    s: FloatArray, p: FloatArray, across: float, left: float, speed: float
) -> tuple[float, float]:
    """Heading [rad] and signed speed over ground along the hull [m/s] for a speed along the leg.

    Ferrying: through the water the hull must make what it shall make over ground less the drift.
    """
    lookahead = min(p[LOOKAHEAD], max(left, LEAST_LOOKAHEAD_M))
    steer = los_course(s[COURSE], across, lookahead)
    wx = speed * math.cos(steer) - s[DRIFT_X]
    wy = speed * math.sin(steer) - s[DRIFT_Y]
    through = math.sqrt(wx * wx + wy * wy)
    heading = math.atan2(wy, wx) if s[WAY] > 0.0 else math.atan2(-wy, -wx)
    error = wrapped(heading - s[YAW])
    free = max(turning_limit(p, math.cos(error)), stemming_speed(s, through, error, steer))
    made = s[WAY] * min(through, free)
    along = math.cos(s[YAW]) * s[DRIFT_X] + math.sin(s[YAW]) * s[DRIFT_Y]
    return heading, made + along


@kernel
def follow_leg(s: FloatArray, p: FloatArray, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed over ground along the hull [m/s] wanted."""
    along, across = along_and_across(s[X], s[Y], s[LEG_X], s[LEG_Y], s[COURSE])
    left = s[LEG_LENGTH] - along
    cruise = p[CRUISE_AHEAD] if s[WAY] > 0.0 else p[CRUISE_ASTERN]
    room = left if s[VIA] == 0.0 else left + 0.5 * (VIA_SPEED * cruise) ** 2 / p[BRAKE]
    speed = min(cruise, stopping_speed(room, p[BRAKE], p[LAG] + REACTION_S))
    if s[VIA] == 0.0 and s[CLOCK] < s[WAIT]:
        speed = 0.0
    drift = math.sqrt(s[DRIFT_X] ** 2 + s[DRIFT_Y] ** 2)
    if drift > FERRY_MPS and s[LEG_LENGTH] < LONG_M:
        return follow_in_drift(s, p, across, left, speed)
    lookahead = min(p[LOOKAHEAD], max(left, LEAST_LOOKAHEAD_M))
    steer = ilos_course(s[COURSE], across, s[ACROSS_INTEGRAL], p[KAPPA], lookahead)
    made = s[WAY] * (math.cos(s[YAW]) * s[VX] + math.sin(s[YAW]) * s[VY])
    heading = steer if s[WAY] > 0.0 else steer + math.pi
    error = wrapped(heading - s[YAW])
    straight = abs(error) < 0.2 and abs(s[RATE]) < 0.15 and abs(across) < 0.3 * p[LOOKAHEAD]
    if straight and made > LEAST_SPEED_MPS:
        rate = ilos_rate(across, s[ACROSS_INTEGRAL], p[KAPPA], p[LOOKAHEAD])
        s[ACROSS_INTEGRAL] += step_s * rate
    return heading, s[WAY] * min(speed, turning_limit(p, math.cos(error)))
