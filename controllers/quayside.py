"""Collecting an item beside a quay: along a line on which the mouth comes to it undisturbed.

At a straight quay a vessel comes in as it bears, up to an angle: an oblique bow touches the quay
with one corner first, so the item must lie the nearer to that corner the more oblique it comes.
Into a corner of two quays a full-beam mouth fits only along one of them, the item near the edge of
the mouth; the vessel first backs off until it lies near its line. Stuck, it begins anew.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import clipped, wrapped
from mjforage.controllers.chart import LandArray, is_land
from mjforage.controllers.guidance import stopping_speed
from mjforage.controllers.legs import REACTION_S
from mjforage.controllers.loops import turning_limit
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

BESIDE_M = 0.6  # a quay nearer than that to an item is beside it
APPROACH_MPS = 0.5  # towards an item, and backing off from it
CONTACT_MPS = 0.8  # at which an item on the way enters the mouth
CREEP_MPS = 0.15  # the least, whatever is left to turn
EDGE_M = 0.05  # from the edge of the mouth to an item in a corner
MOST_OBLIQUE_RAD = 1.1  # from square on
INNER_M = 0.1  # over the sine of that angle: farthest from the corner that touches, to the item
FIXED_M = 1.0  # so near before the bow the course in is kept
LOOKAHEAD_M, MOST_TILT_RAD = 0.8, 0.6  # of the guidance along the line
STAND_OFF_M, NEAR_M = 2.2, 0.6  # most and least that the bow backs off from the item
ON_LINE_M, ON_EDGE_M = 0.4, 0.15  # so near is on the line into a corner, under way and backing off
IN_M = 1.5  # of the bow before the item: a vessel under way on its line comes in from here
ALIGNED_RAD = 0.3  # so near is the heading along it
OFF_LINE_M = 0.3  # from its line when the bow is at the item: missed
PAST_M = 0.3  # by which the bow has missed the item
STILL_MPS, STILL_RADPS, STUCK_S = 0.08, 0.1, 1.5  # so slow for so long is stuck

SET_MPS = 0.1  # a drift onto a quay from which a vessel does not come in along it
CLEARLY = 1.5  # times the drift onto the other quay, from which a course is changed for that

COMING, OFF = 0.0, 1.0  # ways of `VesselState.approach`


@kernel
def is_quayed(s: VesselState) -> bool:
    """True if the item to collect lies beside a quay."""
    return bool(s.quay_x != 0.0 or s.quay_y != 0.0)


@kernel
def is_cornered(s: VesselState) -> bool:
    """True if it lies in a corner of two."""
    return bool(s.quay_x != 0.0 and s.quay_y != 0.0)


@kernel
def meeting_speed(p: ModelRecord, left: float) -> float:
    """Speed [m/s] towards an item `left` metres before the bow, to meet it at `CONTACT_MPS`."""
    room = left + 0.5 * CONTACT_MPS**2 / p.brake_mps2
    speed = min(p.cruise_ahead_mps, stopping_speed(room, p.brake_mps2, p.lag_s + REACTION_S))
    return float(max(speed, APPROACH_MPS))


@kernel
def note_quays(s: VesselState, p: ModelRecord, land: LandArray, pitch: float) -> None:
    """Find the quays beside the item, and if they are others than before, the course to come in on.

    In a corner: `course_in`.
    """
    before_x, before_y = s.quay_x, s.quay_y
    s.quay_x = s.quay_y = 0.0
    if math.isnan(s.item_x):
        return
    x, y = s.item_x, s.item_y
    for side in (1.0, -1.0):
        if is_land(land, pitch, x + side * BESIDE_M, y):
            s.quay_x = side
        if is_land(land, pitch, x, y + side * BESIDE_M):
            s.quay_y = side
    new = s.quay_x != before_x or s.quay_y != before_y
    if not is_quayed(s):
        return
    if not is_cornered(s):
        aim_in(s, p, new)
    elif new or sets_beside(s):
        course = course_in(s, p, land, pitch)
        if new or course != s.run:
            s.run, s.approach, s.still_s = course, OFF, 0.0


@kernel
def sets_beside(s: VesselState) -> bool:
    """True if a drift sets a vessel that comes into a corner onto the quay beside its course."""
    set_east, set_north = s.drift_x * s.quay_x, s.drift_y * s.quay_y
    by_east = abs(math.cos(s.run)) > 0.5
    beside, before = (set_north, set_east) if by_east else (set_east, set_north)
    return bool(beside > SET_MPS and beside > CLEARLY * before)


@kernel
def course_in(s: VesselState, p: ModelRecord, land: LandArray, pitch: float) -> float:
    """Course [rad] into a corner: along the quay with water behind, to back off into.

    Of two such, towards the quay that a drift sets onto, for beside that it would be broadside;
    without a drift the one nearer to how the vessel heads and the item bears.
    """
    east, north = 0.5 * math.pi * (1.0 - s.quay_x), 0.5 * math.pi * s.quay_y
    room = p.length_m + STAND_OFF_M
    east_shut = is_land(land, pitch, s.item_x - s.quay_x * room, s.item_y)
    north_shut = is_land(land, pitch, s.item_x, s.item_y - s.quay_y * room)
    bearing = math.atan2(s.item_y - s.y, s.item_x - s.x)
    to_east = abs(wrapped(east - s.yaw)) + abs(wrapped(east - bearing))
    to_north = abs(wrapped(north - s.yaw)) + abs(wrapped(north - bearing))
    by_east = to_east <= to_north
    set_east, set_north = s.drift_x * s.quay_x, s.drift_y * s.quay_y
    if max(set_east, set_north) > SET_MPS:
        by_east = set_east > set_north
    if east_shut != north_shut:
        by_east = north_shut
    return east if by_east else north


@kernel
def aim_in(s: VesselState, p: ModelRecord, new: bool) -> None:
    """Course to a straight quay: as the item bears, at most `MOST_OBLIQUE_RAD` from square on."""
    dx, dy = s.item_x - s.x, s.item_y - s.y
    far = math.sqrt(dx * dx + dy * dy)
    if new or s.approach == OFF or far > FIXED_M + 0.5 * p.length_m:
        square = math.atan2(s.quay_y, s.quay_x)
        off = wrapped(math.atan2(dy, dx) - square)
        s.run = square + clipped(off, -MOST_OBLIQUE_RAD, MOST_OBLIQUE_RAD)
    if new:
        s.approach, s.still_s = COMING if has_room(s, p) else OFF, 0.0


@kernel
def has_room(s: VesselState, p: ModelRecord) -> bool:
    """True if the vessel has room left to come to its line before the quay."""
    past, across = line_to_item(s, p)
    return bool(-past > NEAR_M + abs(across))


@kernel
def misses(s: VesselState, p: ModelRecord) -> bool:
    """True if a vessel that comes in passes the item by."""
    past, across = line_to_item(s, p)
    return bool(past > PAST_M or (not is_cornered(s) and abs(across) > OFF_LINE_M - past))


@kernel
def line_to_item(s: VesselState, p: ModelRecord) -> tuple[float, float]:
    """Place on its line [m]: of the bow past the item, of midships to port of the
    line.

    In a corner the item lies `EDGE_M` within the edge of the mouth of a vessel on the line; at a
    straight quay near that edge which comes to the quay first.
    """
    c, t = math.cos(s.run), math.sin(s.run)
    dx, dy = s.x - s.item_x, s.y - s.item_y
    across = c * dy - t * dx
    if is_cornered(s):
        to_port = c * s.quay_y if abs(c) > 0.5 else -t * s.quay_x
        across += math.copysign(0.5 * p.beam_m - EDGE_M, to_port)
    else:
        oblique = math.sin(wrapped(s.run - math.atan2(s.quay_y, s.quay_x)))
        inner = INNER_M / max(abs(oblique), 1e-3)
        across -= math.copysign(max(0.5 * p.beam_m - inner, 0.0), oblique)
    return c * dx + t * dy + 0.5 * p.length_m, across


@kernel
def comes_in(s: VesselState, p: ModelRecord) -> bool:
    """True if a vessel under way steers for its line: into a corner only if its way is ahead."""
    if not is_cornered(s):
        return True
    past, _ = line_to_item(s, p)
    ahead = abs(wrapped(s.run - s.yaw)) < 0.5 * math.pi
    return bool((has_room(s, p) and ahead) or past < -STAND_OFF_M)


@kernel
def come_in(s: VesselState, p: ModelRecord) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] of a vessel under way towards its line, or where it begins."""
    past, across = line_to_item(s, p)
    if is_cornered(s) and not has_room(s, p):
        return go_before(s, p, past, across)
    heading = s.run - math.atan(across / (2.0 * LOOKAHEAD_M))
    return heading, speed_in(s, p, heading, past)


@kernel
def go_before(s: VesselState, p: ModelRecord, past: float, across: float) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] to where the line into a corner begins, to turn there."""
    ahead = -STAND_OFF_M - past
    far = math.sqrt(ahead * ahead + across * across)
    heading = s.run + math.atan2(-across, ahead)
    stop = stopping_speed(far, p.brake_mps2, p.lag_s + REACTION_S)
    now = turning_limit(p, math.cos(wrapped(heading - s.yaw)))
    return heading, float(min(p.cruise_ahead_mps, max(stop, CREEP_MPS), now))


@kernel
def speed_in(s: VesselState, p: ModelRecord, heading: float, past: float) -> float:
    """Speed [m/s] at which the vessel has turned to its line when the bow is at the item."""
    left = max(-past, 0.0)
    turn = p.yaw_rate_radps * left / max(abs(wrapped(s.run - s.yaw)), 1e-3)
    now = turning_limit(p, math.cos(wrapped(heading - s.yaw)))
    return float(min(meeting_speed(p, left), max(turn, CREEP_MPS), now))


@kernel
def is_in(s: VesselState, p: ModelRecord) -> bool:
    """True if a vessel under way is so near the item that the rest is done at the node."""
    past, across = line_to_item(s, p)
    aligned = abs(wrapped(s.run - s.yaw)) < ALIGNED_RAD and abs(across) < ON_LINE_M
    return bool(-past < IN_M and (aligned or not is_cornered(s)))


@kernel
def run_in(s: VesselState, p: ModelRecord, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed [m/s] at the node: back off to the line, and in along it."""
    past, across = line_to_item(s, p)
    still = math.sqrt(s.vx**2 + s.vy**2) < STILL_MPS and abs(s.rate) < STILL_RADPS
    s.still_s = s.still_s + step_s if still else 0.0
    if s.approach == OFF:
        aligned = abs(wrapped(s.run - s.yaw)) < ALIGNED_RAD
        ready = aligned and (
            abs(across) < ON_EDGE_M and past < -NEAR_M if is_cornered(s) else has_room(s, p)
        )
        if ready or past < -STAND_OFF_M or s.still_s > 2.0 * STUCK_S:
            s.approach, s.still_s = COMING, 0.0
    elif s.still_s > STUCK_S or misses(s, p):
        s.approach, s.still_s = OFF, 0.0
    tilt = clipped(math.atan(across / LOOKAHEAD_M), -MOST_TILT_RAD, MOST_TILT_RAD)
    heading = s.run + tilt if s.approach == OFF else s.run - tilt
    if s.approach == COMING:
        return heading, speed_in(s, p, heading, past)
    off = abs(wrapped(heading - s.yaw))
    return heading, -APPROACH_MPS * max(math.cos(1.5 * off), 0.0) if off < 1.0 else 0.0
