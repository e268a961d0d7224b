"""Picking up an item beside a quay: along a line on which the mouth comes to it undisturbed.

At a straight quay that is square on, for an oblique bow touches the quay before the mouth is there.
Into a corner of two quays a full-beam mouth fits only along one of them, the item near the edge of
the mouth. The hull backs off until it lies near its line, and comes in; stuck, it begins anew.
"""

import math

from controllers._compiled import kernel
from controllers.angles import clipped, wrapped
from controllers.chart import LandArray, is_land
from controllers.guidance import stopping_speed
from controllers.helm import PackedHelm
from controllers.legs import REACTION_S
from controllers.loops import turning_limit
from controllers.state import VesselState

BESIDE_M = 0.6  # a quay nearer than that to an item is beside it
APPROACH_MPS = 0.5  # towards an item, and backing off from it
CONTACT_MPS = 0.8  # at which an item on the way enters the mouth
EDGE_M = 0.05  # from the edge of the mouth to an item in a corner
LOOKAHEAD_M, MOST_TILT_RAD = 0.8, 0.6  # of the guidance along the line
STAND_OFF_M, NEAR_M = 2.2, 0.6  # most and least that the bow backs off from the item
ON_LINE_M, ON_EDGE_M = 0.4, 0.15  # so near is on the line: square on, and into a corner
IN_M = 1.5  # of the bow before the item: a hull under way on its line comes in from here
ALIGNED_RAD = 0.3  # so near is the heading along it
PAST_M = 0.3  # by which the bow has missed the item
STILL_MPS, STILL_RADPS, STUCK_S = 0.08, 0.1, 1.5  # so slow for so long is stuck

COMING, OFF = 0.0, 1.0  # ways of `VesselState.approach`


@kernel
def is_quayed(s: VesselState) -> bool:
    """Whether the item to pick up lies beside a quay."""
    return bool(s.quay_x != 0.0 or s.quay_y != 0.0)


@kernel
def is_cornered(s: VesselState) -> bool:
    """Whether it lies in a corner of two."""
    return bool(s.quay_x != 0.0 and s.quay_y != 0.0)


@kernel
def meeting_speed(p: PackedHelm, left: float) -> float:
    """Speed [m/s] towards an item `left` metres before the bow, to meet it at `CONTACT_MPS`."""
    room = left + 0.5 * CONTACT_MPS**2 / p.brake_mps2
    speed = min(p.cruise_ahead_mps, stopping_speed(room, p.brake_mps2, p.lag_s + REACTION_S))
    return float(max(speed, APPROACH_MPS))


@kernel
def note_quays(s: VesselState, p: PackedHelm, land: LandArray, pitch: float) -> None:
    """Find the quays beside the item, and if they are others than before, the course to come in on.

    In a corner that is the one with water behind, to back off into, and of two such the one nearer
    ahead.
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
    if not is_quayed(s) or (s.quay_x == before_x and s.quay_y == before_y):
        return
    east, north = 0.5 * math.pi * (1.0 - s.quay_x), 0.5 * math.pi * s.quay_y
    by_east = s.quay_x != 0.0
    if is_cornered(s):
        room = p.length_m + STAND_OFF_M
        east_shut = is_land(land, pitch, x - s.quay_x * room, y)
        north_shut = is_land(land, pitch, x, y - s.quay_y * room)
        nearer = abs(wrapped(east - s.yaw)) <= abs(wrapped(north - s.yaw))
        by_east = nearer if east_shut == north_shut else north_shut
    s.run = east if by_east else north
    s.approach, s.still_s = OFF, 0.0


@kernel
def line_to_item(s: VesselState, p: PackedHelm) -> tuple[float, float]:
    """Where the hull is on its line [m]: of the bow past the item, of midships to port of the line.

    In a corner the item lies `EDGE_M` within the edge of the mouth of a hull on the line.
    """
    c, t = math.cos(s.run), math.sin(s.run)
    dx, dy = s.x - s.item_x, s.y - s.item_y
    across = c * dy - t * dx
    if is_cornered(s):
        to_port = c * s.quay_y if abs(c) > 0.5 else -t * s.quay_x
        across += math.copysign(0.5 * p.beam_m - EDGE_M, to_port)
    return c * dx + t * dy + 0.5 * p.length_m, across


@kernel
def comes_in(s: VesselState, p: PackedHelm) -> bool:
    """Whether a hull under way has room left to come to its line before the quay."""
    past, across = line_to_item(s, p)
    ahead = abs(wrapped(s.run - s.yaw)) < 0.5 * math.pi
    return bool(ahead and -past > NEAR_M + abs(across))


@kernel
def come_in(s: VesselState, p: PackedHelm) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] of a hull under way towards its line."""
    past, across = line_to_item(s, p)
    heading = s.run - math.atan(across / (2.0 * LOOKAHEAD_M))
    off = wrapped(heading - s.yaw)
    return heading, min(meeting_speed(p, -past), turning_limit(p, math.cos(off)))


@kernel
def is_in(s: VesselState, p: PackedHelm) -> bool:
    """Whether a hull under way is near the item and on its line."""
    past, across = line_to_item(s, p)
    aligned = abs(wrapped(s.run - s.yaw)) < ALIGNED_RAD
    return bool(aligned and -past < IN_M and abs(across) < ON_LINE_M)


@kernel
def run_in(s: VesselState, p: PackedHelm, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed [m/s] at the node: back off to the line, and in along it."""
    past, across = line_to_item(s, p)
    still = math.sqrt(s.vx**2 + s.vy**2) < STILL_MPS and abs(s.rate) < STILL_RADPS
    s.still_s = s.still_s + step_s if still else 0.0
    if s.approach == OFF:
        near = ON_EDGE_M if is_cornered(s) else ON_LINE_M
        on_line = abs(across) < near and abs(wrapped(s.run - s.yaw)) < ALIGNED_RAD
        if (on_line and past < -NEAR_M) or past < -STAND_OFF_M or s.still_s > 2.0 * STUCK_S:
            s.approach, s.still_s = COMING, 0.0
    elif s.still_s > STUCK_S or past > PAST_M:
        s.approach, s.still_s = OFF, 0.0
    tilt = clipped(math.atan(across / LOOKAHEAD_M), -MOST_TILT_RAD, MOST_TILT_RAD)
    heading = s.run + tilt if s.approach == OFF else s.run - tilt
    off = abs(wrapped(heading - s.yaw))
    speed = APPROACH_MPS * max(math.cos(1.5 * off), 0.0) if off < 1.0 else 0.0
    return heading, -speed if s.approach == OFF else speed
