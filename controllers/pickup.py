"""Picking up an item: bring the mouth, the full beam at the bow, over it, going ahead.

An item ahead of the bow is steered for. One farther away than the bow reaches is turned to first.
One beside the hull or behind it, within reach of the turning bow, would be pushed away: the hull
first backs off from it, or draws ahead of it.

A hull that comes to a stop on the way, for the item lies in a corner of quays, backs off and tries
along the quay: parallel to it, the item at the edge of the mouth.
"""

import math

from controllers._compiled import kernel
from controllers.angles import wrapped
from controllers.helm import PackedHelm
from controllers.state import VesselState

APPROACH_MPS = 0.5  # towards an item
BACK_MPS = 0.5  # backing off from it
BERTH_M = 0.25  # between an item and the turning bow
SLACK_M = 0.5  # beyond its room a hull still counts as inside its node
AFRESH_M = 0.35  # more than that is made by backing off
AIM = 0.6  # share of the half beam within which the item must lie to be taken straight on

STRAIGHT, ALONG = 0.0, 2.0  # ways of picking up; 1 and 3 are backing off
STILL_MPS, STILL_RADPS, STUCK_S = 0.08, 0.1, 1.5  # so slow for so long is stuck
OFF_S, ALONG_S = 3.0, 10.0  # longest times of backing off and of trying along a quay
EDGE_M = 0.05  # from the edge of the mouth to an item that is taken along a quay
LOOKAHEAD_M = 0.8  # of the guidance along a quay


@kernel
def in_room(s: VesselState, room: float) -> bool:
    """Whether midships is within `room` [m] of the target on each axis."""
    return bool(max(abs(s.x - s.target_x), abs(s.y - s.target_y)) < room + SLACK_M)


@kernel
def leaves_room(s: VesselState, speed: float, room: float) -> bool:
    """Whether going on at `speed` takes midships farther than `room` [m] from the target."""
    dx, dy = s.x - s.target_x, s.y - s.target_y
    mx, my = speed * math.cos(s.yaw), speed * math.sin(s.yaw)
    return bool((abs(dx) > room and dx * mx > 0.0) or (abs(dy) > room and dy * my > 0.0))


@kernel
def note_progress(s: VesselState, step_s: float) -> None:
    """Go on to the next way of picking up when the hull is stuck, or took too long."""
    still = math.sqrt(s.vx**2 + s.vy**2) < STILL_MPS and abs(s.rate) < STILL_RADPS
    s.still_s = s.still_s + step_s if still else 0.0
    s.approach_s += step_s
    off = s.approach != STRAIGHT and s.approach != ALONG
    over = (off and s.approach_s > OFF_S) or (s.approach == ALONG and s.approach_s > ALONG_S)
    if over or s.still_s > STUCK_S:
        s.approach = (s.approach + 1.0) % 4.0
        s.still_s = s.approach_s = s.backing = 0.0


@kernel
def along_quay(s: VesselState, p: PackedHelm) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] along the axis of the map on which the item lies outward."""
    east, north = s.item_x - s.target_x, s.item_y - s.target_y
    course = 0.5 * math.pi * round(math.atan2(north, east) / (0.5 * math.pi))
    c, t = math.cos(course), math.sin(course)
    outward = math.copysign(1.0, c * north - t * east)
    across = c * (s.y - s.item_y) - t * (s.x - s.item_x)
    across += outward * (0.5 * p.beam_m - EDGE_M)
    heading = course - math.atan(across / LOOKAHEAD_M)
    error = abs(wrapped(heading - s.yaw))
    return heading, APPROACH_MPS * max(math.cos(2.0 * error), 0.0) if error < 0.7 else 0.0


@kernel
def pick_up(s: VesselState, p: PackedHelm, room: float, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed [m/s] that bring the mouth over the item.

    Parameters
    ----------
    room : distance from the target on each axis that midships should not exceed [m]
    """
    note_progress(s, step_s)
    if s.approach == ALONG:
        return along_quay(s, p)
    if s.approach != STRAIGHT:
        return s.yaw, -BACK_MPS
    dx, dy = s.item_x - s.x, s.item_y - s.y
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, aside = c * dx + t * dy, c * dy - t * dx
    far, bearing = math.sqrt(dx * dx + dy * dy), math.atan2(dy, dx)
    reach = 0.5 * math.sqrt(p.length_m**2 + p.beam_m**2) + BERTH_M
    if ahead > 0.4 * p.length_m and abs(aside) < AIM * 0.5 * p.beam_m:
        s.backing = 0.0
        # Close to the bow the bearing swings, while holding the heading already takes it.
        near = ahead < 0.5 * p.length_m + BERTH_M
        return s.yaw if near else bearing, APPROACH_MPS
    if far < reach:
        s.backing = 1.0 if ahead >= 0.0 else -1.0
    elif far > reach + AFRESH_M:
        s.backing = 0.0
    speed = -s.backing * BACK_MPS
    if s.backing != 0.0 and not leaves_room(s, speed, room):
        return s.yaw, speed
    error = abs(wrapped(bearing - s.yaw))
    closing = APPROACH_MPS * max(math.cos(2.0 * error), 0.0) if error < 0.5 * math.pi else 0.0
    return bearing, closing if far > reach else 0.0
