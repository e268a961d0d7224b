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
from controllers.helm import BEAM, LENGTH, FloatArray
from controllers.state import (
    APPROACH,
    APPROACH_S,
    BACKING,
    ITEM_X,
    ITEM_Y,
    RATE,
    STILL_S,
    TARGET_X,
    TARGET_Y,
    VX,
    VY,
    YAW,
    X,
    Y,
)

APPROACH_MPS = 0.5
BACK_MPS = 0.5
BERTH_M = 0.25  # between an item and the turning bow
SLACK_M = 0.5  # beyond its room a hull still counts as inside its node
AFRESH_M = 0.35  # more than that is made by backing off
AIM = 0.6  # share of the half beam within which the item must lie to be taken straight on


STRAIGHT, ALONG = 0.0, 2.0  # ways of picking up; 1 and 3 are backing off
STILL_MPS, STILL_RADPS, STUCK_S = 0.08, 0.1, 1.5  # so slow for so long is stuck
OFF_S, ALONG_S = 3.0, 10.0  # longest times of backing off and of trying along a quay
EDGE_M = 0.05  # from the edge of the mouth to an item that is taken along a quay
LOOKAHEAD_M = 0.8


@kernel
def in_room(s: FloatArray, room: float) -> bool:
    """Whether midships is within `room` [m] of the target on each axis."""
    return bool(max(abs(s[X] - s[TARGET_X]), abs(s[Y] - s[TARGET_Y])) < room + SLACK_M)


@kernel
def leaves_room(s: FloatArray, speed: float, room: float) -> bool:
    """Whether going on at `speed` takes midships farther than `room` [m] from the target."""
    dx, dy = s[X] - s[TARGET_X], s[Y] - s[TARGET_Y]
    mx, my = speed * math.cos(s[YAW]), speed * math.sin(s[YAW])
    return bool((abs(dx) > room and dx * mx > 0.0) or (abs(dy) > room and dy * my > 0.0))


@kernel
def note_progress(s: FloatArray, step_s: float) -> None:
    """Go on to the next way of picking up when the hull is stuck, or took too long."""
    still = math.sqrt(s[VX] ** 2 + s[VY] ** 2) < STILL_MPS and abs(s[RATE]) < STILL_RADPS
    s[STILL_S] = s[STILL_S] + step_s if still else 0.0
    s[APPROACH_S] += step_s
    off = s[APPROACH] != STRAIGHT and s[APPROACH] != ALONG
    over = (off and s[APPROACH_S] > OFF_S) or (s[APPROACH] == ALONG and s[APPROACH_S] > ALONG_S)
    if over or s[STILL_S] > STUCK_S:
        s[APPROACH] = (s[APPROACH] + 1.0) % 4.0
        s[STILL_S] = s[APPROACH_S] = s[BACKING] = 0.0


@kernel
def along_quay(s: FloatArray, p: FloatArray) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] along the axis of the map on which the item lies outward."""
    east, north = s[ITEM_X] - s[TARGET_X], s[ITEM_Y] - s[TARGET_Y]
    course = 0.5 * math.pi * round(math.atan2(north, east) / (0.5 * math.pi))
    c, t = math.cos(course), math.sin(course)
    outward = math.copysign(1.0, c * north - t * east)
    across = c * (s[Y] - s[ITEM_Y]) - t * (s[X] - s[ITEM_X])
    across += outward * (0.5 * p[BEAM] - EDGE_M)
    heading = course - math.atan(across / LOOKAHEAD_M)
    error = abs(wrapped(heading - s[YAW]))
    return heading, APPROACH_MPS * max(math.cos(2.0 * error), 0.0) if error < 0.7 else 0.0


@kernel
def pick_up(s: FloatArray, p: FloatArray, room: float, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed [m/s] that bring the mouth over the item.

    Parameters
    ----------
    room : distance from the target on each axis that midships should not exceed [m]
    """
    note_progress(s, step_s)
    if s[APPROACH] == ALONG:
        return along_quay(s, p)
    if s[APPROACH] != STRAIGHT:
        return s[YAW], -BACK_MPS
    dx, dy = s[ITEM_X] - s[X], s[ITEM_Y] - s[Y]
    c, t = math.cos(s[YAW]), math.sin(s[YAW])
    ahead, aside = c * dx + t * dy, c * dy - t * dx
    far, bearing = math.sqrt(dx * dx + dy * dy), math.atan2(dy, dx)
    reach = 0.5 * math.sqrt(p[LENGTH] ** 2 + p[BEAM] ** 2) + BERTH_M
    if ahead > 0.4 * p[LENGTH] and abs(aside) < AIM * 0.5 * p[BEAM]:
        s[BACKING] = 0.0
        # Close to the bow the bearing swings, while holding the heading already takes it.
        near = ahead < 0.5 * p[LENGTH] + BERTH_M
        return s[YAW] if near else bearing, APPROACH_MPS
    if far < reach:
        s[BACKING] = 1.0 if ahead >= 0.0 else -1.0
    elif far > reach + AFRESH_M:
        s[BACKING] = 0.0
    speed = -s[BACKING] * BACK_MPS
    if s[BACKING] != 0.0 and not leaves_room(s, speed, room):
        return s[YAW], speed
    error = abs(wrapped(bearing - s[YAW]))
    closing = APPROACH_MPS * max(math.cos(2.0 * error), 0.0) if error < 0.5 * math.pi else 0.0
    return bearing, closing if far > reach else 0.0
