"""Collecting an item: bring the mouth, the full beam at the bow, over it, going ahead.

On the way to its node an item is taken in passing. At the node, one ahead of the bow is steered
for, and one farther away than the bow reaches is turned to first. One beside the vessel or behind
it, within reach of the turning bow, would be pushed away: the vessel first backs off from it, or
draws ahead of it. Items beside quays: `quayside`. A vessel that has nothing left to do turns to the
next item, and goes towards it as far as its node reaches: turning takes longer than the way.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.angles import wrapped
from mjforage.controllers.guidance import stopping_speed
from mjforage.controllers.legs import FERRY_MPS, REACTION_S
from mjforage.controllers.loops import turning_limit
from mjforage.controllers.quayside import APPROACH_MPS, is_quayed, meeting_speed, run_in
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

BERTH_M = 0.25  # between an item and the turning bow
SLACK_M = 0.5  # beyond its room a vessel still counts as inside its node
AFRESH_M = 0.35  # more than that is made by backing off
AIM = 0.6  # share of the half beam within which the item must lie to be taken straight on


@kernel
def in_room(s: VesselState, room: float) -> bool:
    """True if midships is within `room` [m] of the target on each axis."""
    return bool(max(abs(s.x - s.target_x), abs(s.y - s.target_y)) < room + SLACK_M)


@kernel
def leaves_room(s: VesselState, speed: float, room: float) -> bool:
    """True if going on at `speed` takes midships farther than `room` [m] from the target."""
    dx, dy = s.x - s.target_x, s.y - s.target_y
    mx, my = speed * math.cos(s.yaw), speed * math.sin(s.yaw)
    return bool((abs(dx) > room and dx * mx > 0.0) or (abs(dy) > room and dy * my > 0.0))


@kernel
def is_free(s: VesselState) -> bool:
    """True if a vessel on its way to an item there need not give way."""
    straight = s.via == 0.0 and s.clock >= s.wait and s.stuck == 0.0
    at_target = s.place_x == s.target_x and s.place_y == s.target_y
    return bool(straight and at_target and not math.isnan(s.item_x))


@kernel
def meets_item(s: VesselState, p: ModelRecord) -> bool:
    """True if a vessel under way to its target can steer its mouth through the item there."""
    if not is_free(s) or is_quayed(s):
        return False
    dx, dy = s.item_x - s.x, s.item_y - s.y
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, aside = c * dx + t * dy, abs(c * dy - t * dx)
    reach = turning_reach(p)
    in_mouth = ahead > 0.4 * p.length_m and aside < 0.5 * p.beam_m
    return bool(in_mouth or dx * dx + dy * dy > reach * reach)


@kernel
def meet_item(s: VesselState, p: ModelRecord) -> tuple[float, float]:
    """Heading [rad] and speed over ground along the vessel [m/s] that take the item on the way.

    Through the water the vessel must make what it shall make over ground less the drift.
    """
    dx, dy = s.item_x - s.x, s.item_y - s.y
    far = math.sqrt(dx * dx + dy * dy)
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, aside = c * dx + t * dy, c * dy - t * dx
    speed = meeting_speed(p, far - 0.5 * p.length_m)
    if ahead < 0.5 * p.length_m + BERTH_M and abs(aside) < AIM * 0.5 * p.beam_m:
        return s.yaw, speed  # close to the bow the bearing swings
    wx, wy = speed * dx / far - s.drift_x, speed * dy / far - s.drift_y
    heading = math.atan2(wy, wx)
    error = wrapped(heading - s.yaw)
    made = min(math.sqrt(wx * wx + wy * wy), turning_limit(p, math.cos(error)))
    return heading, made + c * s.drift_x + t * s.drift_y


@kernel
def room_ahead(s: VesselState, room: float) -> float:
    """Way ahead until midships is `room` [m] from the target, 0 beyond that."""
    dx, dy = s.x - s.target_x, s.y - s.target_y
    along = math.cos(s.yaw) * dx + math.sin(s.yaw) * dy
    return math.sqrt(max(along * along + room * room - dx * dx - dy * dy, 0.0)) - along


@kernel
def turning_reach(p: ModelRecord) -> float:
    """Distance from midships [m] within which the turning bow would push an item away."""
    return 0.5 * math.sqrt(p.length_m**2 + p.beam_m**2) + BERTH_M


@kernel
def can_be_ready(s: VesselState) -> bool:
    """True if a vessel that has been at its target may turn to the next item.

    Not in a drift: facing it, a vessel that has no thrust aside would be carried off.
    """
    drift = math.sqrt(s.drift_x**2 + s.drift_y**2)
    calm = drift < FERRY_MPS and s.up == 0.0 and s.looks == 0.0
    at_target = s.arrived != 0.0 and s.place_x == s.target_x and s.place_y == s.target_y
    return bool(calm and at_target and not math.isnan(s.next_x))


@kernel
def get_ready(s: VesselState, p: ModelRecord, room: float) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] of a vessel with nothing left to do: towards the next item.

    One so near that the turning bow would push it away is left alone.

    Parameters
    ----------
    room : distance from the target that midships should not exceed [m]
    """
    dx, dy = s.next_x - s.x, s.next_y - s.y
    far, bearing = math.sqrt(dx * dx + dy * dy), math.atan2(dy, dx)
    left = far - turning_reach(p)
    if left < 0.0:
        return s.yaw, 0.0
    left = min(left, room_ahead(s, room))
    speed = stopping_speed(left, p.brake_mps2, p.lag_s + REACTION_S)
    return bearing, min(speed, turning_limit(p, math.cos(wrapped(bearing - s.yaw))))


@kernel
def collect_item(s: VesselState, p: ModelRecord, room: float, step_s: float) -> tuple[float, float]:
    """Heading [rad] and signed speed [m/s] that bring the mouth over the item.

    Parameters
    ----------
    room : distance from the target on each axis that midships should not exceed [m]
    """
    if is_quayed(s):
        return run_in(s, p, step_s)
    dx, dy = s.item_x - s.x, s.item_y - s.y
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, aside = c * dx + t * dy, c * dy - t * dx
    far, bearing = math.sqrt(dx * dx + dy * dy), math.atan2(dy, dx)
    reach, fast = turning_reach(p), meeting_speed(p, far - 0.5 * p.length_m)
    if ahead > 0.4 * p.length_m and abs(aside) < AIM * 0.5 * p.beam_m:
        s.backing = 0.0
        # Close to the bow the bearing swings, while holding the heading already takes it.
        near = ahead < 0.5 * p.length_m + BERTH_M
        return s.yaw if near else bearing, fast
    if far < reach:
        s.backing = 1.0 if ahead >= 0.0 else -1.0
    elif far > reach + AFRESH_M:
        s.backing = 0.0
    speed = -s.backing * APPROACH_MPS
    if s.backing != 0.0 and not leaves_room(s, speed, room):
        return s.yaw, speed
    closing = min(fast, turning_limit(p, math.cos(wrapped(bearing - s.yaw))))
    return bearing, closing if far > reach else 0.0
