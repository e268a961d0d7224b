"""Getting off: a vessel that quays hold although it wants to go leaves them straight, first.

Each rule for a lee shore looks at one quay. In a corner of two, or at the head of a pier, what one
of them asks for another forbids, and the vessel swings to and fro where it is. After a while it
chooses the course on which its hull has most room, ahead or astern, and keeps to that.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.chart import LandArray, quay_gap
from mjforage.controllers.state import TRANSIT, VesselState
from mjforage.controllers.vessel_model import ModelRecord

HELD_M, HELD_S = 0.6, 10.0  # not farther from where it was for so long, and leaning: held
PICKING_S = 20.0  # the same with an item to pick up, which has ways of its own to begin anew
AWAY_M = 0.8  # from the place that it keeps
OFF_M, OFF_S = 2.5, 10.0  # it goes so far, but no longer than that
OFF_MPS = 0.5
TURNS = 4  # courses tried to either side,
TURN_RAD = 0.2  # so far apart
ROOM_PER_RAD = 0.8  # room that a turn has to gain [m/rad]
MOST_ROOM_M = 1.0  # more room does not count
LOOKS, LOOK_M = 4, 0.5  # places along a course at which the room is looked at, and their distance


@kernel
def room_along(
    s: VesselState, p: ModelRecord, land: LandArray, pitch: float, heading: float, way: float
) -> float:
    """Least gap [m] to quays of a vessel that goes ahead (`way` 1) or astern (-1) at a heading."""
    c, t = math.cos(heading), math.sin(heading)
    least = MOST_ROOM_M
    for k in range(1, LOOKS + 1):
        x, y = s.x + way * k * LOOK_M * c, s.y + way * k * LOOK_M * t
        half_length, half_beam = 0.5 * p.length_m, 0.5 * p.beam_m
        gap = quay_gap(land, pitch, x, y, c, t, half_length, half_beam, MOST_ROOM_M)
        least = min(least, gap)
    return least


@kernel
def choose_way_off(s: VesselState, p: ModelRecord, land: LandArray, pitch: float) -> None:
    """Begin to get off on the course that has most room for the turn that it takes."""
    best = -math.inf
    for k in range(-TURNS, TURNS + 1):
        for way in (1.0, -1.0):
            heading = s.yaw + k * TURN_RAD
            room = room_along(s, p, land, pitch, heading, way) - ROOM_PER_RAD * abs(k) * TURN_RAD
            if room > best:
                best, s.off_heading, s.off_way = room, heading, way
    s.off_s = OFF_S


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
def note_held(s: VesselState, p: ModelRecord, land: LandArray, pitch: float, step_s: float) -> None:
    """Count for how long quays or vessels have held a vessel, and let it get off in time."""
    far = math.sqrt((s.x - s.was_x) ** 2 + (s.y - s.was_y) ** 2)
    if s.off_s > 0.0 and far < OFF_M:
        s.off_s = max(s.off_s - step_s, 0.0)
        if s.off_s > 0.0:
            return
    elif far < HELD_M and s.wait <= s.clock:
        s.held_s += step_s if s.in_contact != 0.0 or s.held_s > 0.0 else 0.0
        if s.held_s >= patience(s):
            s.held_s = 0.0
            choose_way_off(s, p, land, pitch)
        return
    s.was_x, s.was_y, s.held_s, s.off_s = s.x, s.y, 0.0, 0.0
