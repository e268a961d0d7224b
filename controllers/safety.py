"""Safe speeds: how fast a hull may go and turn so that it can still stop before an obstacle.

They limit every command, whatever guidance and traffic want.
"""

import math

from controllers._compiled import kernel
from controllers.boxes import box_gap, circle_radius
from controllers.chart import LandArray, quay_gap
from controllers.guidance import stopping_distance, stopping_speed
from controllers.helm import HelmArray, PackedHelm
from controllers.state import HOLD, FleetArray, VesselState
from controllers.touching import HULL_SHARE, NEAR_M, REACTION_S, heed_hull, heed_land

GIVE_WAY_S = 1.0  # by how much longer the path ahead of a vessel with right of way is kept free
SWING_S = 0.25  # for which another that turns is taken to turn on
AHEAD, TURNED = 0.0, 1.0  # hulls as they head now, and as they will when they turn no more
LEAST_TURN_RAD = 0.05  # a turn that is looked at
STEP_M = 0.25  # of looking ahead
SLACK_M = 0.02  # by which a gap may shrink that is already too small
PAST_QUAY_MPS, PAST_HULL_MPS = 0.25, 0.15  # along a hull nearer than the clearance, a quay half
LONGEST_PATH_M = 5.0  # of another, to stop
STRONG_DRIFT_MPS = 0.2  # a drift from which a hull keeps off the quay to leeward
LEE_M = 2.0  # a quay nearer than this to leeward of a place counts
MOST_UP_M = 0.5  # how far it then lies up the drift
UNLIMITED = 1e3  # a limit [m/s], [rad/s] that no hull reaches
QUAYS = -1  # in place of another vessel


@kernel
def turn_left(s: VesselState, p: PackedHelm) -> float:
    """Angle by which a hull turns before it can turn no more [rad]."""
    stop = p.lag_s + REACTION_S + 0.5 * abs(s.rate) / p.yaw_acceleration_radps2
    return float(s.rate * stop)


@kernel
def gap_to(
    state: FleetArray,
    helms: HelmArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    way: float,
    shift: float,
    turned: float,
    reach: float,
) -> float:
    """Gap of vessel `i`, moved by `shift` along its heading, to the quays or to another's path.

    Parameters
    ----------
    state, helms : (vessel,) of one episode
    other : a vessel, or `QUAYS`
    way : length of the other's path [m]
    turned : share of the turns that are under way by which both have turned
    reach : gaps beyond it count as it [m]
    """
    yaw = state[i].yaw + turned * turn_left(state[i], helms[i])
    c, t = math.cos(yaw), math.sin(yaw)
    x, y = state[i].x + shift * c, state[i].y + shift * t
    half_length, half_beam = 0.5 * helms[i].length_m, 0.5 * helms[i].beam_m
    if other == QUAYS:
        return quay_gap(land, pitch, x, y, c, t, half_length, half_beam, reach)
    dx, dy = state[other].x - x, state[other].y - y
    yaw = state[other].yaw + turned * turn_left(state[other], helms[other])
    cj, tj = math.cos(yaw), math.sin(yaw)
    u = cj * state[other].vx + tj * state[other].vy
    v = cj * state[other].vy - tj * state[other].vx
    swing = (
        SWING_S * abs(state[other].rate) * circle_radius(helms[other].length_m, helms[other].beam_m)
    )
    ahead, aside = math.copysign(0.5 * way, u), 0.25 * v
    dx += ahead * cj - aside * tj
    dy += ahead * tj + aside * cj
    long, wide = (
        0.5 * (helms[other].length_m + way) + swing,
        0.5 * helms[other].beam_m + abs(aside) + swing,
    )
    return min(box_gap(dx, dy, c, t, half_length, half_beam, cj, tj, long, wide), reach)


@kernel
def way_of(state: FleetArray, helms: HelmArray, i: int, other: int) -> tuple[float, float]:
    """Way that another vessel takes to stop, and that vessel `i` leaves it for having right of way.

    Both in metres.
    """
    s, p = state[other], helms[other]
    speed = abs(math.cos(s.yaw) * s.vx + math.sin(s.yaw) * s.vy)
    stop = stopping_distance(speed, p.brake_mps2, p.lag_s + REACTION_S)
    return stop, GIVE_WAY_S * speed if s.rank < state[i].rank else 0.0


@kernel
def free_way(
    state: FleetArray,
    helms: HelmArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    way: float,
    side: float,
    turned: float,
    first: float,
    reach: float,
) -> float:
    """Distance [m] that vessel `i` can go ahead (`side` 1) or astern (-1) and keep its clearance.

    Where the gap is less than that already (`first` is the gap now), it may not shrink further.
    """
    least = min(helms[i].clearance_m, first - SLACK_M)
    gone, gap = 0.0, first
    while gone < reach:
        step = max(gap - least, STEP_M)
        following = gap_to(
            state, helms, land, pitch, i, other, way, side * (gone + step), turned, reach
        )
        if following < least:
            return float(gone + step * max(gap - least, 0.0) / (gap - following))
        gone, gap = gone + step, following
    return gone


@kernel
def limit_by(
    state: FleetArray,
    helms: HelmArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    turned: float,
    reach: float,
) -> float:
    """Lower the fastest safe speeds of vessel `i` for the sake of the quays or another; the gap."""
    s, p = state[i], helms[i]
    way, more, share = 0.0, 0.0, 1.0
    if other != QUAYS:
        way, more = way_of(state, helms, i, other)
    gap = gap_to(state, helms, land, pitch, i, other, way + more, 0.0, turned, reach)
    if gap >= reach:
        return gap
    if gap > 0.0 or other == QUAYS:
        way += more
    else:  # it is in the other's path
        gap = gap_to(state, helms, land, pitch, i, other, way, 0.0, turned, reach)
        if gap <= 0.0:
            way, share = 0.0, 0.5
            gap = gap_to(state, helms, land, pitch, i, other, way, 0.0, turned, reach)
    reaction = p.lag_s + REACTION_S
    brake = p.brake_mps2 if other == QUAYS else HULL_SHARE * p.brake_mps2
    for side in (1.0, -1.0):
        free = free_way(state, helms, land, pitch, i, other, way, side, turned, gap, reach)
        if free >= reach:
            if gap > (0.5 if other == QUAYS else 1.0) * p.clearance_m:
                continue
            # So near, going along is safe only slowly; going away is free.
            away = gap_to(state, helms, land, pitch, i, other, way, side * STEP_M, turned, reach)
            past = PAST_QUAY_MPS if other == QUAYS else PAST_HULL_MPS
            most = UNLIMITED if away > gap + SLACK_M else past
        else:
            most = stopping_speed(share * free, brake, reaction)
        if side > 0.0:
            s.most_ahead = min(s.most_ahead, most)
        else:
            s.most_astern = min(s.most_astern, most)
    return gap


@kernel
def limit_going(
    state: FleetArray,
    helms: HelmArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    reach: float,
) -> float:
    """`limit_by` as the hulls head now and, if they turn, as they will; the gap now."""
    gap = limit_by(state, helms, land, pitch, i, other, AHEAD, reach)
    turn = abs(turn_left(state[i], helms[i]))
    if other != QUAYS:
        turn += abs(turn_left(state[other], helms[other]))
    if turn > LEAST_TURN_RAD:
        limit_by(state, helms, land, pitch, i, other, TURNED, reach)
    return gap


@kernel
def windward_room(s: VesselState, p: PackedHelm, land: LandArray, pitch: float) -> float:
    """How far up the drift of its place the hull should lie [m], for there is a quay to leeward."""
    drift = math.sqrt(s.drift_x**2 + s.drift_y**2)
    if drift < STRONG_DRIFT_MPS:
        return 0.0
    c, t = s.drift_x / drift, s.drift_y / drift
    wide = 0.5 * p.length_m
    to_lee = quay_gap(land, pitch, s.place_x, s.place_y, c, t, wide, wide, LEE_M)
    x, y = s.place_x - MOST_UP_M * c, s.place_y - MOST_UP_M * t
    moved = quay_gap(land, pitch, x, y, c, t, wide, wide, LEE_M)
    return MOST_UP_M if moved > to_lee + 0.5 * MOST_UP_M else 0.0


@kernel
def limit_speeds(
    state: FleetArray, helms: HelmArray, land: LandArray, pitch: float, i: int
) -> None:
    """Set the fastest safe speeds of vessel `i`, ahead, astern and turning."""
    s, p = state[i], helms[i]
    s.most_ahead = s.most_astern = s.most_port = s.most_starboard = UNLIMITED
    cruise = max(p.cruise_ahead_mps, p.cruise_astern_mps)
    reach = stopping_distance(cruise, p.brake_mps2, p.lag_s + REACTION_S) + p.clearance_m
    if limit_going(state, helms, land, pitch, i, QUAYS, reach) < NEAR_M:
        heed_land(s, p, land, pitch)
    s.up = windward_room(s, p, land, pitch) if s.mode == HOLD else 0.0
    far = reach + LONGEST_PATH_M + 0.5 * p.length_m
    for j in range(state.shape[0]):
        dx, dy = abs(state[j].x - s.x), abs(state[j].y - s.y)
        if j == i or max(dx, dy) > far + 0.5 * helms[j].length_m:
            continue
        if limit_going(state, helms, land, pitch, i, j, reach) < NEAR_M:
            heed_hull(s, p, state[j], helms[j])
