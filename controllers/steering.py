"""Control tick of one vessel: mode (transit, station keeping, collecting) and commands."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.allocation import allocate, command_for, lagged, led_command
from mjforage.controllers.angles import clipped, wrapped
from mjforage.controllers.collecting import (
    can_be_ready,
    collect_item,
    get_ready,
    in_room,
    is_free,
    meet_item,
    meets_item,
)
from mjforage.controllers.getting_off import OFF_MPS, heading_off
from mjforage.controllers.guidance import along_and_across
from mjforage.controllers.holding import hold_force, hold_windup
from mjforage.controllers.lee_shore import evasive_turn
from mjforage.controllers.legs import REACTION_S, follow_leg, lay_leg
from mjforage.controllers.loops import (
    heading_moment,
    heading_windup,
    munk_moment,
    surge_drag,
    surge_force,
    surge_windup,
    yaw_drag,
)
from mjforage.controllers.quayside import COMING, come_in, comes_in, is_cornered, is_in, is_quayed
from mjforage.controllers.state import HOLD, TRANSIT, VesselState
from mjforage.controllers.vessel_model import ModelRecord

AT_M = 0.3  # from its place: there
PAST_M = 0.75  # beside the target when passing it: there
LEAVE_M = 1.5  # from its place: no longer there
SAFE_SHARE = 0.3  # of half the thrust, to turn a vessel that brakes for something
LIFTED_RAD = 0.1  # off the heading wanted, from which all of the water's load is lifted
OFF_SHARE = 1.5  # of the thrust of one side astern, to turn a vessel off a lee shore
FOLLOWS_MPS, FOLLOWS_RADPS = 0.05, 0.05  # above limits: from there as fast as they fall
SLOW_MPS = 0.15  # a vessel slower than this has more of its thrust to turn than to brake
LOOK_RAD = 1.0  # by which the heading wanted is ahead of a vessel that looks round
ON_LINE = 0.1  # of what is left of the line between nodes: so near, follow it, else one of its own


@kernel
def surge_speed(s: VesselState) -> float:
    """Speed over ground along the vessel [m/s]."""
    return float(math.cos(s.yaw) * s.vx + math.sin(s.yaw) * s.vy)


@kernel
def speed_through_water(s: VesselState) -> float:
    """Speed through the water along the vessel [m/s], by its drift."""
    dx, dy = s.vx - s.drift_x, s.vy - s.drift_y
    return float(math.cos(s.yaw) * dx + math.sin(s.yaw) * dy)


@kernel
def distance_to(s: VesselState, x: float, y: float) -> float:
    """Distance from the vessel to a point [m]."""
    return math.sqrt((s.x - x) ** 2 + (s.y - y) ** 2)


@kernel
def start_transit(s: VesselState, p: ModelRecord, x: float, y: float, via: bool) -> None:
    """Set out from here to (x, y)."""
    lay_leg(s, p, s.x, s.y, x, y, via)
    if s.mode != TRANSIT:
        s.speed_ref = surge_speed(s)
        s.surge_integral = math.cos(s.yaw) * s.hold_fx + math.sin(s.yaw) * s.hold_fy
    s.mode = TRANSIT


@kernel
def start_hold(s: VesselState, p: ModelRecord) -> None:
    """Keep position from now on, with the heading of now and the force that the drift takes."""
    if s.mode != HOLD:
        s.wanted = s.yaw
        drag = p.linear_surge + p.quadratic_surge * math.sqrt(s.drift_x**2 + s.drift_y**2)
        s.hold_fx, s.hold_fy = -drag * s.drift_x, -drag * s.drift_y
    s.mode = HOLD


@kernel
def start_decision(s: VesselState, p: ModelRecord, room: float) -> None:
    """Set out for a new target: on the line between the nodes, if the vessel is on it."""
    x, y = s.target_x, s.target_y
    s.place_x, s.place_y, s.clock, s.wait = x, y, 0.0, 0.0
    s.stuck = s.promoted = 0.0
    stay = s.origin_x == x and s.origin_y == y
    sought = not (math.isnan(s.item_x) and math.isnan(s.next_x))
    if stay and sought and in_room(s, room):
        s.arrived = 1.0  # it may be off its place for picking up
        start_hold(s, p)
        return
    if stay and distance_to(s, x, y) < LEAVE_M:
        start_hold(s, p)
        return
    start_transit(s, p, x, y, False)
    course = math.atan2(y - s.origin_y, x - s.origin_x)
    along, across = along_and_across(s.x, s.y, s.origin_x, s.origin_y, course)
    length = math.sqrt((x - s.origin_x) ** 2 + (y - s.origin_y) ** 2)
    if abs(across) < ON_LINE * (length - along) and along > -2.0 * LEAVE_M:
        lay_leg(s, p, s.origin_x, s.origin_y, x, y, False)


@kernel
def change_mode(s: VesselState, p: ModelRecord) -> None:
    """Change between going and keeping, by where the vessel is."""
    if distance_to(s, s.target_x, s.target_y) < PAST_M:
        s.arrived = 1.0
    x, y = s.place_x, s.place_y
    far = distance_to(s, x, y)
    if s.mode == HOLD:
        if far > LEAVE_M and (math.isnan(s.item_x) or s.arrived == 0.0):
            start_transit(s, p, x, y, False)
        return
    if is_free(s) and is_quayed(s) and is_in(s, p):
        start_hold(s, p)
        s.arrived = 1.0
        if is_cornered(s):
            s.approach = COMING
        return
    along, across = along_and_across(s.x, s.y, s.leg_x, s.leg_y, s.course)
    passed = along > s.leg_length - 0.1
    if s.via != 0.0:
        if passed or distance_to(s, s.end_x, s.end_y) < AT_M:
            start_transit(s, p, x, y, False)
    elif far < AT_M or (passed and abs(across) < PAST_M):
        start_hold(s, p)
    elif passed:
        start_transit(s, p, x, y, False)


@kernel
def commands(
    s: VesselState, p: ModelRecord, port: float, starboard: float, step_s: float
) -> tuple[float, float]:
    """Commands for thrusts [N], with a lead on the thrusters' lag; keeps the state of the lag."""
    speed, beside = speed_through_water(s), p.lever_m * s.rate
    port, starboard = port / (1.0 - s.port_loss), starboard / (1.0 - s.starboard_loss)
    left = led_command(p, s.port, command_for(p, port, speed - beside), step_s)
    right = led_command(p, s.starboard, command_for(p, starboard, speed + beside), step_s)
    s.port = lagged(p, s.port, left, step_s)
    s.starboard = lagged(p, s.starboard, right, step_s)
    return left, right


@kernel
def too_fast(s: VesselState, speed: float) -> bool:
    """True if the vessel goes faster than it safely may."""
    return bool(speed > s.most_ahead or speed < -s.most_astern)


@kernel
def most_gain(p: ModelRecord, speed: float, most: float) -> float:
    """Most acceleration [m/s2] of a vessel at a speed that may be `most` [m/s].

    A faster vessel brakes, and as fast as the limit falls besides: where it is that from which a
    vessel can stop, v_max, by a v / (v_max + a t_r) of the brake a and the reaction time t_r.
    """
    reaction = p.lag_s + REACTION_S
    gain = (most - speed) / reaction
    if speed > max(most, 0.0):
        falls = p.brake_mps2 * speed / (max(most, 0.0) + p.brake_mps2 * reaction)
        gain -= min((speed - most) / FOLLOWS_MPS, 1.0) * falls
    return max(gain, -p.brake_mps2)


@kernel
def safe_force(s: VesselState, p: ModelRecord, speed: float, force: float) -> float:
    """The part of a surge force [N] within the safe speeds, or the force that leads back to
    them.

    That is after the thrusters' lag and a tick, or with the brake that safe speeds count on.
    """
    along = math.cos(s.yaw) * s.drift_x + math.sin(s.yaw) * s.drift_y
    more, less = most_gain(p, speed, s.most_ahead), most_gain(p, -speed, s.most_astern)
    most = surge_drag(p, s.most_ahead - along) + p.mass_surge_kg * more
    least = -surge_drag(p, s.most_astern + along) - p.mass_surge_kg * less
    return clipped(force, min(least, most), most)


@kernel
def most_spin(p: ModelRecord, rate: float, most: float) -> float:
    """Most acceleration [rad/s2] of a turn whose rate may be `most` [rad/s], as `most_gain`."""
    reaction = p.lag_s + REACTION_S
    gain = (most - rate) / reaction
    if rate > most:
        brake = p.yaw_acceleration_radps2
        falls = brake * rate / (most + brake * reaction)
        gain -= min((rate - most) / FOLLOWS_RADPS, 1.0) * falls
    return float(gain)


@kernel
def safe_moment(s: VesselState, p: ModelRecord, moment: float) -> float:
    """The part of a moment [N m] within the safe rates of turn, or one that leads back to them."""
    munk, inertia = munk_moment(s, p), p.inertia_yaw_kgm2
    most = yaw_drag(p, s.most_port) + inertia * most_spin(p, s.rate, s.most_port) + munk
    least = -yaw_drag(p, s.most_starboard) - inertia * most_spin(p, -s.rate, s.most_starboard)
    least += munk
    return clipped(moment, least - s.load_starboard, most + s.load_port)


@kernel
def braking_moment(
    s: VesselState, p: ModelRecord, share: float, surge: float, speed: float, moment: float
) -> float:
    """The moment [N m], less where the vessel brakes.

    Yaw has priority in the allocation, and a vessel that turns at full moment does not stop:
    `share` 1 leaves half the thrust for braking, 0 all. The slower a vessel is, the more of its
    thrust it turns with: all of it at rest, which pushes it on again. One that leans has all.
    """
    if surge * speed >= 0.0 or (s.in_contact != 0.0 and abs(speed) < SLOW_MPS):
        return moment
    brake = -p.thrust_low if speed > 0.0 else p.thrust_high
    slow = max(1.0 - abs(speed) / SLOW_MPS, 0.0)
    most = p.lever_m * (share * brake * (1.0 - slow) + (p.thrust_high - p.thrust_low) * slow)
    return clipped(moment, -most, most)


@kernel
def most_difference(s: VesselState, p: ModelRecord, surge: float) -> float:
    """Most difference of the two thrusts [N] that a vessel turns with, for a safe surge force [N].

    Yaw has first share of the thrust, and full thrust both ways pushes ahead. So some is kept near
    a lee shore, and in contact as much as the surge needs, but for what one side gives astern. A
    vessel that leans on a lee shore turns off with all that it has.
    """
    lee = s.lee_x != 0.0 or s.lee_y != 0.0
    if lee and s.in_contact == 0.0:
        return -OFF_SHARE * p.thrust_low
    if s.in_contact != 0.0 and not lee:
        left = min(surge - 2.0 * p.thrust_low, 2.0 * p.thrust_high - surge)
        return max(left, -p.thrust_low)
    return p.thrust_high - p.thrust_low


@kernel
def push(
    s: VesselState, p: ModelRecord, heading: float, surge: float, step_s: float
) -> tuple[float, float]:
    """Thrusts of port and starboard [N] towards a heading [rad], with a surge force [N], safely."""
    now = surge_speed(s)
    limited = safe_force(s, p, now, surge)
    to_port = wrapped(heading - s.heading_ref) > 0.0
    most_rate = min(p.yaw_rate_radps, s.most_port if to_port else s.most_starboard)
    moment = heading_moment(s, p, heading, most_rate, step_s)
    off = wrapped(heading - s.yaw)
    moment += s.load_port * clipped(off / LIFTED_RAD, 0.0, 1.0)
    moment -= s.load_starboard * clipped(-off / LIFTED_RAD, 0.0, 1.0)
    fast = too_fast(s, now)
    given = braking_moment(s, p, SAFE_SHARE if fast else 1.0, limited, now, moment)
    given = safe_moment(s, p, given)
    if fast:
        given = braking_moment(s, p, 1.0, limited, now, given)
    most = most_difference(s, p, limited) * p.lever_m
    given = clipped(given, -most, most)
    about = speed_through_water(s), s.rate, s.port_loss, s.starboard_loss
    port, starboard = allocate(p, limited, given, *about)
    heading_windup(s, p, moment, (starboard - port) * p.lever_m, step_s)
    return port, starboard


@kernel
def drive(
    s: VesselState, p: ModelRecord, heading: float, speed: float, step_s: float
) -> tuple[float, float]:
    """Commands towards a heading [rad] at a signed speed [m/s]."""
    now = surge_speed(s)
    heading, speed = evasive_turn(s, p, heading, speed)
    wanted = clipped(speed, -s.most_astern, s.most_ahead)
    if too_fast(s, now):
        s.speed_ref = wanted  # braking for something does not wait for the reference
    surge = surge_force(s, p, now, wanted, step_s)
    port, starboard = push(s, p, heading, surge, step_s)
    surge_windup(s, p, now, surge, port + starboard, step_s)
    return commands(s, p, port, starboard, step_s)


@kernel
def keep(s: VesselState, p: ModelRecord, x: float, y: float, step_s: float) -> tuple[float, float]:
    """Commands that keep the vessel at (x, y)."""
    heading, surge, ahead = hold_force(s, p, x, y)
    if s.looks != 0.0:
        s.wanted, heading = s.yaw, s.yaw + LOOK_RAD
    heading, _ = evasive_turn(s, p, heading, 0.0)
    port, starboard = push(s, p, heading, surge, step_s)
    hold_windup(s, p, ahead, surge, port + starboard, step_s)
    return commands(s, p, port, starboard, step_s)


@kernel
def steer(s: VesselState, p: ModelRecord, room: float, step_s: float) -> tuple[float, float]:
    """Commands of one vessel: port, starboard.

    Parameters
    ----------
    room : largest offset of midships from the target on each axis to collect an item [m]
    """
    if s.off_s > 0.0:
        return drive(s, p, heading_off(s), OFF_MPS * s.off_way, step_s)
    if s.mode == TRANSIT:
        if meets_item(s, p):
            heading, speed = meet_item(s, p)
        elif is_free(s) and is_quayed(s) and comes_in(s, p):
            heading, speed = come_in(s, p)
        else:
            heading, speed = follow_leg(s, p, step_s)
        return drive(s, p, heading, speed, step_s)
    at_target = s.place_x == s.target_x and s.place_y == s.target_y
    if not math.isnan(s.item_x) and s.arrived != 0.0 and at_target:
        heading, speed = collect_item(s, p, room, step_s)
        s.wanted = s.yaw
        return drive(s, p, heading, speed, step_s)
    if math.isnan(s.item_x):
        s.approach = s.still_s = 0.0
    if can_be_ready(s):
        heading, speed = get_ready(s, p, room)
        s.wanted = s.yaw
        return drive(s, p, heading, speed, step_s)
    if s.up > 0.0:
        shift = s.up / math.sqrt(s.drift_x**2 + s.drift_y**2)
        x, y = s.place_x - shift * s.drift_x, s.place_y - shift * s.drift_y
        return keep(s, p, x, y, step_s)
    return keep(s, p, s.place_x, s.place_y, step_s)
