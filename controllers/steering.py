"""One vessel, one tick: what it does now, and the commands that follow."""

import math

from controllers._compiled import kernel
from controllers.allocation import allocate, command_for, lagged, led_command
from controllers.angles import clipped
from controllers.guidance import along_and_across
from controllers.helm import (
    BRAKE,
    LAG,
    LEVER,
    LIN_SURGE,
    M_SURGE,
    QUAD_SURGE,
    THRUST_HIGH,
    THRUST_LOW,
    YAW_RATE,
    FloatArray,
)
from controllers.holding import hold_force, hold_windup
from controllers.legs import REACTION_S, follow_leg, lay_leg
from controllers.loops import (
    heading_moment,
    heading_windup,
    surge_drag,
    surge_force,
    surge_windup,
)
from controllers.pickup import in_room, pick_up
from controllers.state import (
    ARRIVED,
    CLOCK,
    COURSE,
    DRIFT_X,
    DRIFT_Y,
    END_X,
    END_Y,
    HOLD,
    HOLD_FX,
    HOLD_FY,
    ITEM_X,
    LEG_LENGTH,
    LEG_X,
    LEG_Y,
    MODE,
    MOST_AHEAD,
    MOST_ASTERN,
    MOST_RATE,
    ORIGIN_X,
    ORIGIN_Y,
    PLACE_X,
    PLACE_Y,
    PORT,
    PROMOTED,
    SPEED_REF,
    STARBOARD,
    STUCK,
    SURGE_INTEGRAL,
    TARGET_X,
    TARGET_Y,
    TRANSIT,
    UP,
    VIA,
    VX,
    VY,
    WAIT,
    WANTED,
    YAW,
    X,
    Y,
)

AT_M = 0.3  # from its place: there
PAST_M = 0.75  # beside the target when passing it: there
LEAVE_M = 1.5  # from its place: no longer there
SAFE_SHARE = 0.3  # of the moment that is left to a hull that brakes for something
SLOW_MPS = 0.15  # a hull slower than this is not braking
ON_LINE_M = 0.4  # from the line between nodes: follow that line, else one of its own


@kernel
def surge_speed(s: FloatArray) -> float:
    """Speed over ground along the hull [m/s]."""
    return float(math.cos(s[YAW]) * s[VX] + math.sin(s[YAW]) * s[VY])


@kernel
def distance_to(s: FloatArray, x: float, y: float) -> float:
    """Distance from the hull to a point [m]."""
    return math.sqrt((s[X] - x) ** 2 + (s[Y] - y) ** 2)


@kernel
def start_transit(s: FloatArray, p: FloatArray, x: float, y: float, via: bool) -> None:
    """Set out from here to (x, y)."""
    lay_leg(s, p, s[X], s[Y], x, y, via)
    if s[MODE] != TRANSIT:
        s[SPEED_REF] = surge_speed(s)
        s[SURGE_INTEGRAL] = math.cos(s[YAW]) * s[HOLD_FX] + math.sin(s[YAW]) * s[HOLD_FY]
    s[MODE] = TRANSIT


@kernel
def start_hold(s: FloatArray, p: FloatArray) -> None:
    """Keep position from now on, with the heading of now and the force that the drift takes."""
    if s[MODE] != HOLD:
        s[WANTED] = s[YAW]
        drag = p[LIN_SURGE] + p[QUAD_SURGE] * math.sqrt(s[DRIFT_X] ** 2 + s[DRIFT_Y] ** 2)
        s[HOLD_FX], s[HOLD_FY] = -drag * s[DRIFT_X], -drag * s[DRIFT_Y]
    s[MODE] = HOLD


@kernel
def start_decision(s: FloatArray, p: FloatArray, room: float) -> None:
    """Set out for a new target: on the line between the nodes, if the hull is on it."""
    x, y = s[TARGET_X], s[TARGET_Y]
    s[PLACE_X], s[PLACE_Y], s[CLOCK], s[WAIT] = x, y, 0.0, 0.0
    s[STUCK] = s[PROMOTED] = 0.0
    stay = s[ORIGIN_X] == x and s[ORIGIN_Y] == y
    if stay and not math.isnan(s[ITEM_X]) and in_room(s, room):
        s[ARRIVED] = 1.0  # it may be off its place for picking up
        start_hold(s, p)
        return
    if stay and distance_to(s, x, y) < LEAVE_M:
        start_hold(s, p)
        return
    start_transit(s, p, x, y, False)
    course = math.atan2(y - s[ORIGIN_Y], x - s[ORIGIN_X])
    along, across = along_and_across(s[X], s[Y], s[ORIGIN_X], s[ORIGIN_Y], course)
    length = math.sqrt((x - s[ORIGIN_X]) ** 2 + (y - s[ORIGIN_Y]) ** 2)
    if abs(across) < ON_LINE_M and -2.0 * LEAVE_M < along < length:
        lay_leg(s, p, s[ORIGIN_X], s[ORIGIN_Y], x, y, False)


@kernel
def change_mode(s: FloatArray, p: FloatArray) -> None:
    """Change between going and keeping, by where the hull is."""
    if distance_to(s, s[TARGET_X], s[TARGET_Y]) < PAST_M:
        s[ARRIVED] = 1.0
    x, y = s[PLACE_X], s[PLACE_Y]
    far = distance_to(s, x, y)
    if s[MODE] == HOLD:
        if far > LEAVE_M and (math.isnan(s[ITEM_X]) or s[ARRIVED] == 0.0):
            start_transit(s, p, x, y, False)
        return
    along, across = along_and_across(s[X], s[Y], s[LEG_X], s[LEG_Y], s[COURSE])
    passed = along > s[LEG_LENGTH] - 0.1
    if s[VIA] != 0.0:
        if passed or distance_to(s, s[END_X], s[END_Y]) < AT_M:
            start_transit(s, p, x, y, False)
    elif far < AT_M or (passed and abs(across) < PAST_M):
        start_hold(s, p)
    elif passed:
        start_transit(s, p, x, y, False)


@kernel
def commands(
    s: FloatArray, p: FloatArray, port: float, starboard: float, step_s: float
) -> tuple[float, float]:
    """Commands for thrusts [N], with a lead on the thrusters' lag; keeps the state of the lag."""
    left = led_command(p, s[PORT], command_for(p, port), step_s)
    right = led_command(p, s[STARBOARD], command_for(p, starboard), step_s)
    s[PORT] = lagged(p, s[PORT], left, step_s)
    s[STARBOARD] = lagged(p, s[STARBOARD], right, step_s)
    return left, right


@kernel
def too_fast(s: FloatArray, speed: float) -> bool:
    """Whether the hull goes faster than it safely may."""
    return bool(speed > s[MOST_AHEAD] or speed < -s[MOST_ASTERN])


@kernel
def emergency_force(p: FloatArray, speed: float, safe: float, force: float) -> float:
    """The force [N] of the speed loop, or more: what brings a hull to its safe speed [m/s] at once.

    At once is after the thrusters' lag and a tick, or with the brake that safe speeds count on.
    """
    stop = clipped((safe - speed) / (p[LAG] + REACTION_S), -p[BRAKE], p[BRAKE])
    needed = surge_drag(p, speed) + p[M_SURGE] * stop
    return float(min(force, needed) if speed > safe else max(force, needed))


@kernel
def braking_moment(
    s: FloatArray, p: FloatArray, surge: float, speed: float, moment: float
) -> float:
    """The moment [N m], less where the hull brakes.

    Yaw has priority in the allocation, and a hull that turns at full moment does not stop: turning
    must leave half the thrust for braking, and most of it where the hull is too fast to be safe.
    """
    if surge * speed >= 0.0 or abs(speed) < SLOW_MPS:
        return moment
    share = SAFE_SHARE if too_fast(s, speed) else 1.0
    most = share * p[LEVER] * (-p[THRUST_LOW] if speed > 0.0 else p[THRUST_HIGH])
    return clipped(moment, -most, most)


@kernel
def drive(
    s: FloatArray, p: FloatArray, heading: float, speed: float, step_s: float
) -> tuple[float, float]:
    """Commands towards a heading [rad] at a signed speed [m/s]."""
    now = surge_speed(s)
    wanted = clipped(speed, -s[MOST_ASTERN], s[MOST_AHEAD])
    if too_fast(s, now):
        s[SPEED_REF] = wanted  # braking for something does not wait for the reference
    surge = surge_force(s, p, now, wanted, step_s)
    if too_fast(s, now):
        surge = emergency_force(p, now, wanted, surge)
    moment = heading_moment(s, p, heading, min(p[YAW_RATE], s[MOST_RATE]), step_s)
    port, starboard = allocate(p, surge, braking_moment(s, p, surge, now, moment))
    surge_windup(s, p, now, surge, port + starboard, step_s)
    heading_windup(s, p, moment, (starboard - port) * p[LEVER], step_s)
    return commands(s, p, port, starboard, step_s)


@kernel
def keep(s: FloatArray, p: FloatArray, x: float, y: float, step_s: float) -> tuple[float, float]:
    """Commands that keep the hull at (x, y)."""
    heading, surge, ahead = hold_force(s, p, x, y)
    now, stiff = surge_speed(s), p[M_SURGE] / (p[LAG] + REACTION_S)
    most = surge_drag(p, s[MOST_AHEAD]) + stiff * (s[MOST_AHEAD] - now)
    least = -surge_drag(p, s[MOST_ASTERN]) - stiff * (s[MOST_ASTERN] + now)
    limited = clipped(surge, least, most)
    moment = heading_moment(s, p, heading, min(p[YAW_RATE], s[MOST_RATE]), step_s)
    port, starboard = allocate(p, limited, braking_moment(s, p, limited, now, moment))
    hold_windup(s, p, ahead, surge, port + starboard, step_s)
    heading_windup(s, p, moment, (starboard - port) * p[LEVER], step_s)
    return commands(s, p, port, starboard, step_s)


@kernel
def steer(s: FloatArray, p: FloatArray, room: float, step_s: float) -> tuple[float, float]:
    """Commands of one vessel: port, starboard.

    Parameters
    ----------
    room : how far from the target on each axis midships may go to pick up an item [m]
    """
    if s[MODE] == TRANSIT:
        heading, speed = follow_leg(s, p, step_s)
        return drive(s, p, heading, speed, step_s)
    at_target = s[PLACE_X] == s[TARGET_X] and s[PLACE_Y] == s[TARGET_Y]
    if not math.isnan(s[ITEM_X]) and s[ARRIVED] != 0.0 and at_target:
        heading, speed = pick_up(s, p, room)
        s[WANTED] = s[YAW]
        return drive(s, p, heading, speed, step_s)
    if s[UP] > 0.0:
        shift = s[UP] / math.sqrt(s[DRIFT_X] ** 2 + s[DRIFT_Y] ** 2)
        x, y = s[PLACE_X] - shift * s[DRIFT_X], s[PLACE_Y] - shift * s[DRIFT_Y]
        return keep(s, p, x, y, step_s)
    return keep(s, p, s[PLACE_X], s[PLACE_Y], step_s)
