"""Getting off: a vessel that is held although it wants to go leaves straight, first.

Each rule for a lee shore looks at one quay. In a corner of two, or at the head of a pier, what one
of them asks for another forbids, and the vessel swings to and fro where it is. After a while it
chooses the course on which its hull has most room, ahead or astern, and keeps to that. Room is up
to quays and to other vessels, where they are.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.boxes import box_gap
from mjforage.controllers.chart import LandArray, quay_gap
from mjforage.controllers.state import TRANSIT, FleetArray, VesselState
from mjforage.controllers.vessel_model import ModelArray, ModelRecord

HELD_M, HELD_S = 0.6, 10.0  # not farther from where it was for so long, and leaning: held
PICKING_S = 20.0  # the same with an item to pick up, which has ways of its own to begin anew
AWAY_M = 0.8  # from the place that it keeps
OFF_M, OFF_S = 2.5, 15.0  # it goes so far, but no longer than that
OFF_MPS = 0.5
TURNS = 4  # courses tried to either side,
TURN_RAD = 0.2  # so far apart
TOUCHING_M = 0.2  # a gap to one that gets off below which a vessel is in its way
ROOM_PER_RAD = 0.8  # room that a turn has to gain [m/rad]
MOST_ROOM_M = 1.0  # more room does not count
LOOKS, LOOK_M = 4, 0.5  # places along a course at which the room is looked at, and their distance


@kernel
def gap_to(
    x: float, y: float, c: float, t: float, p: ModelRecord, other: VesselState, model: ModelRecord
) -> float:
    """Gap [m] to another vessel of one at (x, y) [m], at a heading of cosine `c`, sine `t`."""
    dx, dy, co, to = other.x - x, other.y - y, math.cos(other.yaw), math.sin(other.yaw)
    half_length, half_beam = 0.5 * p.length_m, 0.5 * p.beam_m
    long, wide = 0.5 * model.length_m, 0.5 * model.beam_m
    return box_gap(dx, dy, c, t, half_length, half_beam, co, to, long, wide)


@kernel
def room_along(
    fleet: FleetArray,
    models: ModelArray,
    land: LandArray,
    pitch: float,
    i: int,
    heading: float,
    way: float,
) -> float:
    """Least gap [m] of vessel `i` that goes ahead (`way` 1) or astern (-1) at a heading.

    To quays and to the other vessels (vessel,) of its episode, at rest where they are.
    """
    c, t, p, least = math.cos(heading), math.sin(heading), models[i], MOST_ROOM_M
    for k in range(1, LOOKS + 1):
        x, y = fleet[i].x + way * k * LOOK_M * c, fleet[i].y + way * k * LOOK_M * t
        gap = quay_gap(land, pitch, x, y, c, t, 0.5 * p.length_m, 0.5 * p.beam_m, MOST_ROOM_M)
        least = min(least, gap)
        for j in range(models.shape[0]):
            if j != i:
                least = min(least, gap_to(x, y, c, t, p, fleet[j], models[j]))
    return least


@kernel
def choose_way_off(
    fleet: FleetArray, models: ModelArray, land: LandArray, pitch: float, i: int
) -> None:
    """Let vessel `i` get off on the course that has most room for the turn that it takes.

    What its loops have gathered against what holds it is forgotten.
    """
    s, best = fleet[i], -math.inf
    for k in range(-TURNS, TURNS + 1):
        for way in (1.0, -1.0):
            heading = s.yaw + k * TURN_RAD
            room = room_along(fleet, models, land, pitch, i, heading, way)
            room -= ROOM_PER_RAD * abs(k) * TURN_RAD
            if room > best:
                best, s.off_heading, s.off_way = room, heading, way
    s.off_s, s.heading_ref, s.rate_ref = OFF_S, s.yaw, 0.0
    s.moment_integral = s.surge_integral = 0.0


@kernel
def heading_off(s: VesselState) -> float:
    """Heading [rad] of a vessel that gets off: while it leans its own, or all thrust would turn."""
    return s.off_heading if s.in_contact == 0.0 else s.yaw


@kernel
def patience(s: VesselState) -> float:
    """For how long a vessel may lean on quays without getting on [s]."""
    if s.mode == TRANSIT:
        return HELD_S
    if not math.isnan(s.item_x):
        return PICKING_S
    away = math.sqrt((s.x - s.place_x) ** 2 + (s.y - s.place_y) ** 2) > AWAY_M
    return HELD_S if away else math.inf


@kernel
def is_in_the_way(fleet: FleetArray, models: ModelArray, i: int) -> bool:
    """True if another vessel that gets off touches vessel `i`, or nearly."""
    s, c, t = fleet[i], math.cos(fleet[i].yaw), math.sin(fleet[i].yaw)
    for j in range(models.shape[0]):
        near = j != i and fleet[j].off_s > 0.0
        if near and gap_to(s.x, s.y, c, t, models[i], fleet[j], models[j]) < TOUCHING_M:
            return True
    return False


@kernel
def note_held(
    fleet: FleetArray, models: ModelArray, land: LandArray, pitch: float, i: int, step_s: float
) -> None:
    """Count for how long quays or vessels have held vessel `i`, and let it get off in time."""
    s = fleet[i]
    far = math.sqrt((s.x - s.was_x) ** 2 + (s.y - s.was_y) ** 2)
    if s.off_s > 0.0 and far < OFF_M:
        s.off_s = max(s.off_s - step_s, 0.0)
        if s.off_s > 0.0:
            return
    elif far < HELD_M and (s.wait <= s.clock or s.stuck != 0.0):
        s.held_s += step_s if s.in_contact != 0.0 or s.held_s > 0.0 else 0.0
        most = patience(s)
        if s.held_s >= HELD_S and most > HELD_S and is_in_the_way(fleet, models, i):
            most = HELD_S
        if s.held_s >= most:
            s.held_s = 0.0
            choose_way_off(fleet, models, land, pitch, i)
        return
    s.was_x, s.was_y, s.held_s, s.off_s = s.x, s.y, 0.0, 0.0
