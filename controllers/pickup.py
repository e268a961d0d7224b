"""Picking up an item: bring the mouth, the full beam at the bow, over it, going ahead.

An item ahead of the bow is steered for. One farther away than the bow reaches is turned to first.
One beside the hull or behind it, within reach of the turning bow, would be pushed away: the hull
first backs off from it, or draws ahead of it.
"""

import math

from controllers._compiled import kernel
from controllers.angles import wrapped
from controllers.helm import BEAM, LENGTH, FloatArray
from controllers.state import BACKING, ITEM_X, ITEM_Y, TARGET_X, TARGET_Y, YAW, X, Y

APPROACH_MPS = 0.5
BACK_MPS = 0.5
BERTH_M = 0.25  # between an item and the turning bow
SLACK_M = 0.5  # beyond its room a hull still counts as inside its node
AFRESH_M = 0.35  # more than that is made by backing off
AIM = 0.6  # share of the half beam within which the item must lie to be taken straight on


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
def pick_up(s: FloatArray, p: FloatArray, room: float) -> tuple[float, float]:
    """Heading [rad] and signed speed [m/s] that bring the mouth over the item.

    Parameters
    ----------
    room : distance from the target on each axis that midships should not exceed [m]
    """
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
