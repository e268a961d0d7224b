"""Lee shores: quays that a drift carries a vessel to, which can thrust ahead and astern, not aside.

A vessel keeps off by its speed along itself: in the direction n of a quay it closes at
u (n . h) + n . (D - (D . h) h), of its speed u ahead over ground, its heading h and its drift D.
That shall be no faster than the gap in a while, long enough to turn through broadside, where no
thrust helps; limits may so be below 0.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.base.wholes import floor
from mjforage.controllers.angles import clipped, wrapped
from mjforage.controllers.chart import LandArray, is_cell_land, is_nearer, quay_gap, way_to_cell
from mjforage.controllers.clearance import picks_at_quay
from mjforage.controllers.contact import nearest_of
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import ModelRecord

LEAST_DRIFT_MPS = 0.1  # from which quays to leeward are heeded
LEAST_CLOSING_MPS = 0.1  # of the drift, towards such a quay
LEE_S = 4.0  # in which the gap may be used up
OFF_M = 0.3  # of the gap that is kept
HEADED = 0.3  # share of the speed ahead that must go towards a quay or from it, to help
STEEP = 0.36  # such a share at which a vessel that wants to stay at it does not pass broadside
PIVOT = 0.7  # share towards it at which a vessel that turned around its bow goes astern
SLANTED_RAD = 0.5  # from square on, of a vessel that makes room
TURN_S = 1.6  # to begin a turn, and to be as far as `HEADED`
OFF_MPS = 0.3  # at which room is made
SLIP_MPS = 0.05  # by which a vessel that is nearly broadside may close faster than it drifts
SOON_S = 2.0  # before it is there, such a vessel turns bow or stern off

STRONG_DRIFT_MPS = 0.2  # a drift from which a vessel keeps off the quay to leeward of its place
LEE_M = 2.0  # a quay nearer than this to leeward of a place counts
MOST_UP_M = 0.5  # how far it then lies up the drift
UNLIMITED = 1e3  # a limit [m/s], [rad/s] that no vessel reaches


@kernel
def extent(p: ModelRecord, ahead: float) -> float:
    """Half the width of a vessel in a direction that has a share `ahead` along it [m]."""
    across = math.sqrt(max(1.0 - ahead * ahead, 0.0))
    return float(0.5 * (p.length_m * abs(ahead) + p.beam_m * across))


@kernel
def keep_off(
    s: VesselState, p: ModelRecord, dx: float, dy: float, vx: float, vy: float, free: bool
) -> float:
    """Limit a vessel because of an obstacle at (dx, dy) from midships [m], moving at (vx, vy)
    [m/s].

    Parameters
    ----------
    free : True if it may come there: it is not limited

    Returns
    -------
    what is left of the gap after `LEE_S` of drifting [m], at most 0
    """
    far = math.sqrt(dx * dx + dy * dy)
    nx, ny = dx / max(far, 1e-6), dy / max(far, 1e-6)
    closing = nx * (s.drift_x - vx) + ny * (s.drift_y - vy)
    if closing < LEAST_CLOSING_MPS:
        return 0.0
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead = nx * c + ny * t
    gap = far - extent(p, ahead) - OFF_M - s.margin
    aside = closing - ahead * (c * s.drift_x + t * s.drift_y)
    most = (gap / LEE_S - aside) / max(abs(ahead), 1e-6)
    if abs(ahead) < HEADED:
        most = max(most, SLIP_MPS / max(abs(ahead), 1e-6))
    if free or (s.in_contact != 0.0 and 0.0 < ahead < PIVOT):
        most = UNLIMITED
    if ahead > 0.0:
        s.most_ahead = min(s.most_ahead, max(most, -p.cruise_astern_mps))
    else:
        s.most_astern = min(s.most_astern, max(most, -p.cruise_ahead_mps))
    return min(gap - LEE_S * closing, 0.0)


@kernel
def heed_lee(s: VesselState, p: ModelRecord, land: LandArray, pitch: float) -> None:
    """Limit a vessel for the sake of quays that its drift carries it to, and note the nearest.

    The quay at which it collects an item sets no limits while its bow is towards that.
    """
    drift = math.sqrt(s.drift_x**2 + s.drift_y**2)
    if land.size == 0 or drift < LEAST_DRIFT_MPS:
        return
    reach = 0.5 * math.sqrt(p.length_m**2 + p.beam_m**2) + OFF_M + LEE_S * drift
    reach += s.margin
    low_j, high_j = floor((s.y - reach) / pitch + 0.5), floor((s.y + reach) / pitch + 1.5)
    least, picks = 0.0, picks_at_quay(s, p)
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    for i in range(floor((s.x - reach) / pitch + 0.5), floor((s.x + reach) / pitch + 1.5)):
        for j in range(low_j, high_j):
            if not is_cell_land(land, i, j):
                continue
            dx, dy = way_to_cell(pitch, s.x, s.y, i, j)
            of_item = picks and (dx * s.quay_x > abs(dy) or dy * s.quay_y > abs(dx))
            bow_on = c * dx + t * dy > HEADED * math.sqrt(dx * dx + dy * dy)
            if is_nearer(land, i, j, dx, dy):
                left = keep_off(s, p, dx, dy, 0.0, 0.0, of_item and bow_on)
                if left < least:
                    least, s.lee_x, s.lee_y = left, dx, dy


@kernel
def heed_lee_vessel(s: VesselState, p: ModelRecord, other: VesselState, model: ModelRecord) -> None:
    """Limit a vessel for the sake of another that its drift carries it to."""
    if s.drift_x**2 + s.drift_y**2 < LEAST_DRIFT_MPS**2:
        return
    co, to = math.cos(other.yaw), math.sin(other.yaw)
    dx, dy = other.x - s.x, other.y - s.y
    x, y = nearest_of(model.length_m, model.beam_m, co, to, -dx, -dy)
    keep_off(s, p, dx + x, dy + y, other.vx, other.vy, False)


@kernel
def make_room(
    s: VesselState,
    p: ModelRecord,
    heading: float,
    nx: float,
    ny: float,
    room: float,
    begun: float,
) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] of a vessel that wants to turn through broadside.

    It stays where it is before a quay in the direction (nx, ny), or draws off from there.

    Parameters
    ----------
    room : what it may drift until it is there again [m]
    begun : share to which the turn is under way, 0 to 1
    """
    c, t = math.cos(s.yaw), math.sin(s.yaw)
    ahead, closing = nx * c + ny * t, nx * s.drift_x + ny * s.drift_y
    aside = closing - ahead * (c * s.drift_x + t * s.drift_y)
    turn_s = 2.0 * HEADED / p.yaw_rate_radps + TURN_S * (1.0 - begun)
    if room > turn_s * closing:
        return heading, -aside / ahead
    square = math.atan2(ny, nx) + (0.0 if ahead > 0.0 else math.pi)
    off = clipped(wrapped(heading - square), -SLANTED_RAD, SLANTED_RAD)
    return square + off, -(aside + OFF_MPS) / ahead


@kernel
def evasive_turn(
    s: VesselState, p: ModelRecord, heading: float, speed: float
) -> tuple[float, float]:
    """Heading [rad] and speed [m/s] wanted, or others that a quay to leeward asks for.

    A vessel that lies alongside turns its stern off: pushing ahead with the bow for a pivot, all of
    thrust, friction and Munk moment help. One that is nearly broadside, and soon there, turns bow
    or stern off, the way that it leans and turns already: one that comes broadside strikes with one
    end and then, half as fast again, with the other. Before it turns through broadside a vessel
    makes room.
    """
    far = math.sqrt(s.lee_x**2 + s.lee_y**2)
    if far == 0.0:
        return heading, speed
    nx, ny, c, t = s.lee_x / far, s.lee_y / far, math.cos(s.yaw), math.sin(s.yaw)
    ahead, across, square = nx * c + ny * t, ny * c - nx * t, math.atan2(ny, nx)
    if s.in_contact != 0.0 and -HEADED < ahead < PIVOT:
        return square, speed
    turning = -math.copysign(across, ahead * across) * s.rate / p.yaw_rate_radps
    begun, room = clipped(2.0 * turning, 0.0, 1.0), far - extent(p, HEADED)
    if abs(ahead) < HEADED:
        soon = SOON_S * (nx * s.vx + ny * s.vy) > room
        side = ahead / HEADED + across * s.rate / p.yaw_rate_radps + math.cos(heading - square)
        off = square + (0.0 if side > 0.0 else math.pi)
        return (off if soon and begun < 1.0 else heading), speed
    if math.cos(heading - square) * ahead > STEEP * abs(ahead):
        return heading, speed
    return make_room(s, p, heading, nx, ny, room, begun)


@kernel
def windward_room(s: VesselState, p: ModelRecord, land: LandArray, pitch: float) -> float:
    """Way up the drift of its place at which to lie [m], above 0 with a quay to leeward."""
    drift = math.sqrt(s.drift_x**2 + s.drift_y**2)
    if drift < STRONG_DRIFT_MPS:
        return 0.0
    c, t = s.drift_x / drift, s.drift_y / drift
    wide = 0.5 * p.length_m
    to_lee = quay_gap(land, pitch, s.place_x, s.place_y, c, t, wide, wide, LEE_M)
    x, y = s.place_x - MOST_UP_M * c, s.place_y - MOST_UP_M * t
    moved = quay_gap(land, pitch, x, y, c, t, wide, wide, LEE_M)
    return MOST_UP_M if moved > to_lee + 0.5 * MOST_UP_M else 0.0
