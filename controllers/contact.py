"""Contact handling: safe speeds and turns where a vessel may touch, from each point's approach.

Two boxes come nearest at a corner of one of them. A point p of the vessel closes at n . (v + r x p)
in the direction n of what is nearest to it: no faster than it can brake in the gap, but for the
speed that a touch may have.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor
from mjforage.controllers.angles import clipped
from mjforage.controllers.chart import (
    WALL_M,
    LandArray,
    headland,
    is_cell_land,
    is_nearer,
    walls_at,
    way_to_cell,
    way_to_wall,
)
from mjforage.controllers.clearance import joint_margin
from mjforage.controllers.guidance import striking_speed
from mjforage.controllers.legs import REACTION_S
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

NEAR_M = 0.6  # a gap within which any turn can be braked
TOUCH_QUAY_MPS, TOUCH_VESSEL_MPS = 0.18, 0.1  # of a touch; another vessel may have as much
QUAY_SHARE = 0.8  # of the brake that is counted on, for turning takes thrust too
VESSEL_SHARE = 0.6  # of the same before other vessels, which move
INSET_M = 0.05  # of the points, so that one that touches is not yet inside
BLUR_M = 0.02  # by which a gap may be smaller than it is measured
LEANING_M = 0.05  # a gap below which a vessel leans on what is there
HEADED = 0.2  # share of the speed ahead that must go towards a point to be limited for it
PATIENT_S = 5.0  # for which a vessel that does not get off counts on the drift that it knows


@kernel
def pressing(s: VesselState, p: ModelRecord) -> float:
    """Force to port [N] with which the water that passes a vessel aside takes it along."""
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    flow = c * (s.drift_y - s.vy) - t * (s.drift_x - s.vx)
    return float((p.linear_sway + p.quadratic_sway * abs(flow)) * flow)


@kernel
def note_contact(s: VesselState, p: ModelRecord, force: float, lever: float) -> None:
    """Note that a vessel leans with one of its points, pressed by a force [N], at a lever [m].

    To turn off from there it must lift the rest of itself around that point. It learns no drift
    while it leans: the longer it is held, the more it lifts.
    """
    s.in_contact = 1.0
    force *= 1.0 + s.held_s / PATIENT_S
    if lever > 0.0:
        s.load_port = max(s.load_port, force * lever)
    else:
        s.load_starboard = max(s.load_starboard, -force * lever)


@kernel
def heed(
    s: VesselState,
    p: ModelRecord,
    x: float,
    y: float,
    dx: float,
    dy: float,
    quay: bool,
    margin: float,
) -> None:
    """Limit a vessel for the sake of one point of it.

    Parameters
    ----------
    x, y : the point, from midships, world axes [m]
    dx, dy : from there to what is nearest [m]
    quay : True if that is a quay; another vessel may use half of the gap
    margin : by which the gap may be less than it seems [m]
    """
    far = math.sqrt(dx * dx + dy * dy)
    if not 0.0 < far < NEAR_M + INSET_M + margin:
        return
    nx, ny, gap = dx / far, dy / far, far - INSET_M - BLUR_M
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, turning = nx * c + ny * t, ny * x - nx * y
    if gap < LEANING_M - BLUR_M:
        note_contact(s, p, (ny * c - nx * t) * pressing(s, p), turning)
    gap -= margin
    aside = max((ny * c - nx * t) * (c * s.vy - t * s.vx), 0.0)
    reaction = p.lag_s + 2.0 * REACTION_S  # a tick more, for the gap is that of before
    if quay:
        most = striking_speed(gap, QUAY_SHARE * p.brake_mps2, reaction, TOUCH_QUAY_MPS)
    else:
        touch = TOUCH_VESSEL_MPS if s.off_s == 0.0 else TOUCH_QUAY_MPS
        most = striking_speed(0.5 * gap, VESSEL_SHARE * p.brake_mps2, reaction, touch)
    going = max(aside + ahead * (c * s.vx + t * s.vy), 0.0)
    rate = max(most - going, 0.0) / max(abs(turning), 1e-3)
    if turning > 0.0:
        s.most_port = min(s.most_port, rate)
    else:
        s.most_starboard = min(s.most_starboard, rate)
    if gap > p.clearance_m or abs(ahead) < HEADED:
        return
    speed = max(most - aside - max(turning * s.rate, 0.0), 0.0) / abs(ahead)
    if ahead > 0.0:
        s.most_ahead = min(s.most_ahead, speed)
    else:
        s.most_astern = min(s.most_astern, speed)


@kernel
def corner_of(length: float, beam: float, c: float, t: float, k: int) -> tuple[float, float]:
    """Corner `k` of 4 of a box at a heading of cosine `c`, sine `t`, from its middle [m]."""
    along = 0.5 * length if k & 1 else -0.5 * length
    aside = 0.5 * beam if k & 2 else -0.5 * beam
    return c * along - t * aside, t * along + c * aside


@kernel
def nearest_of(
    length: float, beam: float, c: float, t: float, x: float, y: float
) -> tuple[float, float]:
    """Point of such a box nearest to (x, y), both from its middle [m]."""
    along = clipped(c * x + t * y, -0.5 * length, 0.5 * length)
    aside = clipped(c * y - t * x, -0.5 * beam, 0.5 * beam)
    return c * along - t * aside, t * along + c * aside


@kernel
def heed_around(
    s: VesselState, p: ModelRecord, land: LandArray, pitch: float, x: float, y: float
) -> None:
    """Limit a vessel for the sake of the quays around one point of it, (x, y) from midships [m]."""
    px, py, reach = s.x + x, s.y + y, NEAR_M + INSET_M + s.margin
    low_j, high_j = floor((py - reach) / pitch + 0.5), floor((py + reach) / pitch + 1.5)
    for i in range(floor((px - reach) / pitch + 0.5), floor((px + reach) / pitch + 1.5)):
        for j in range(low_j, high_j):
            if is_cell_land(land, i, j):
                dx, dy = way_to_cell(pitch, px, py, i, j)
                if is_nearer(land, i, j, dx, dy):
                    heed(s, p, x, y, dx, dy, True, s.margin)
                continue
            for k in walls_at(land, i + 1, j + 1):
                dx, dy, _ = way_to_wall(land, k, px, py)
                face = 1.0 - WALL_M / max(math.hypot(dx, dy), WALL_M)
                heed(s, p, x, y, face * dx, face * dy, True, s.margin)


@kernel
def heed_land(s: VesselState, p: ModelRecord, land: LandArray, pitch: float) -> None:
    """Limit a vessel for the sake of quays: its corners, and theirs that jut out."""
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    long, wide = p.length_m - 2.0 * INSET_M, p.beam_m - 2.0 * INSET_M
    for k in range(4):
        x, y = corner_of(long, wide, c, t, k)
        heed_around(s, p, land, pitch, x, y)
    reach = 0.5 * p.length_m + NEAR_M + s.margin
    low_i, low_j = floor((s.x - reach) / pitch), floor((s.y - reach) / pitch)
    for i in range(low_i, floor((s.x + reach) / pitch) + 1):
        for j in range(low_j, floor((s.y + reach) / pitch) + 1):
            if headland(land, i, j):
                to_x, to_y = (i + 0.5) * pitch - s.x, (j + 0.5) * pitch - s.y
                x, y = nearest_of(long, wide, c, t, to_x, to_y)
                heed(s, p, x, y, to_x - x, to_y - y, True, s.margin)


@kernel
def heed_vessel(s: VesselState, p: ModelRecord, other: VesselState, model: ModelRecord) -> None:
    """Limit a vessel for the sake of another: the corners of both."""
    c, t, co, to = math.cos(s.yaw), math.sin(s.yaw), math.cos(other.yaw), math.sin(other.yaw)
    long, wide = p.length_m - 2.0 * INSET_M, p.beam_m - 2.0 * INSET_M
    dx, dy, margin = other.x - s.x, other.y - s.y, joint_margin(s, other)
    for k in range(4):
        x, y = corner_of(long, wide, c, t, k)
        qx, qy = nearest_of(model.length_m, model.beam_m, co, to, x - dx, y - dy)
        heed(s, p, x, y, dx + qx - x, dy + qy - y, False, margin)
        qx, qy = corner_of(model.length_m, model.beam_m, co, to, k)
        x, y = nearest_of(long, wide, c, t, dx + qx, dy + qy)
        heed(s, p, x, y, dx + qx - x, dy + qy - y, False, margin)
