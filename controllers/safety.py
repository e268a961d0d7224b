"""The last word: how fast a hull may go and turn so that it can still stop before anything."""

import math

from controllers._compiled import kernel
from controllers.boxes import box_gap, circle_radius
from controllers.chart import LandArray, quay_gap
from controllers.guidance import stopping_distance, stopping_speed
from controllers.helm import (
    BEAM,
    BRAKE,
    CLEARANCE,
    CRUISE_AHEAD,
    CRUISE_ASTERN,
    LAG,
    LENGTH,
    FloatArray,
)
from controllers.state import (
    DRIFT_X,
    DRIFT_Y,
    HOLD,
    MODE,
    MOST_AHEAD,
    MOST_ASTERN,
    MOST_RATE,
    PLACE_X,
    PLACE_Y,
    RANK,
    RATE,
    UP,
    VX,
    VY,
    YAW,
    X,
    Y,
)

REACTION_S = 0.1
GIVE_WAY_S = 1.0  # by how much longer the path ahead of a vessel with right of way is kept free
TOUCH_QUAY_MPS, TOUCH_HULL_MPS = 0.25, 0.15  # of a bow that swings where it may touch
SWING_S = 0.25  # for which another that turns is taken to turn on
HULL_SHARE = 0.6  # of the brake that is counted on before other hulls, which move
STEP_M = 0.25  # of looking ahead
SLACK_M = 0.02  # by which a gap may shrink that is already too small
SWING_M = 0.1
PAST_QUAY_MPS, PAST_HULL_MPS = 0.25, 0.15  # along a hull nearer than the clearance, a quay half
LONGEST_PATH_M = 5.0  # of another, to stop
STRONG_DRIFT_MPS = 0.2
LEE_M = 2.0  # a quay nearer than this to leeward of a place counts
MOST_UP_M = 0.5
UNLIMITED = 1e3
QUAYS = -1


@kernel
def gap_to(
    state: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    shift: float,
    reach: float,
) -> float:
    """Gap of vessel `i`, moved by `shift` along its heading, to the quays or to another's path.

    The path is what the other takes to stop, and more if it has right of way.

    Parameters
    ----------
    state : (vessel, SIZE) rows of one episode
    helms : (vessel, SIZE) of `packed`
    other : a vessel, or `QUAYS`
    reach : gaps beyond it count as it [m]
    """
    yaw = state[i, YAW]
    c, t = math.cos(yaw), math.sin(yaw)
    x, y = state[i, X] + shift * c, state[i, Y] + shift * t
    half_length, half_beam = 0.5 * helms[i, LENGTH], 0.5 * helms[i, BEAM]
    if other == QUAYS:
        return quay_gap(land, pitch, x, y, c, t, half_length, half_beam, reach)
    dx, dy = state[other, X] - x, state[other, Y] - y
    cj, tj = math.cos(state[other, YAW]), math.sin(state[other, YAW])
    u = cj * state[other, VX] + tj * state[other, VY]
    v = cj * state[other, VY] - tj * state[other, VX]
    swing = (
        SWING_S * abs(state[other, RATE]) * circle_radius(helms[other, LENGTH], helms[other, BEAM])
    )
    way = stopping_distance(abs(u), helms[other, BRAKE], helms[other, LAG] + REACTION_S)
    if state[other, RANK] < state[i, RANK]:
        way += GIVE_WAY_S * abs(u)
    ahead, aside = math.copysign(0.5 * way, u), 0.25 * v
    dx += ahead * cj - aside * tj
    dy += ahead * tj + aside * cj
    long, wide = (
        0.5 * (helms[other, LENGTH] + way) + swing,
        0.5 * helms[other, BEAM] + abs(aside) + swing,
    )
    return min(box_gap(dx, dy, c, t, half_length, half_beam, cj, tj, long, wide), reach)


@kernel
def free_way(
    state: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    side: float,
    first: float,
    reach: float,
) -> float:
    """Distance [m] that vessel `i` can go ahead (`side` 1) or astern (-1) and keep its clearance.

    Where the gap is less than that already (`first` is the gap now), it may not shrink further.
    """
    least = min(helms[i, CLEARANCE], first - SLACK_M)
    gone, gap = 0.0, first
    while gone < reach:
        step = max(gap - least, STEP_M)
        following = gap_to(state, helms, land, pitch, i, other, side * (gone + step), reach)
        if following < least:
            return float(gone + step * max(gap - least, 0.0) / (gap - following))
        gone, gap = gone + step, following
    return gone


@kernel
def limit_by(
    state: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    reach: float,
) -> float:
    """Lower the fastest safe speeds of vessel `i` for the sake of the quays or another; the gap."""
    s, p = state[i], helms[i]
    gap = gap_to(state, helms, land, pitch, i, other, 0.0, reach)
    if gap >= reach:
        return gap
    reaction = p[LAG] + REACTION_S
    brake = p[BRAKE] if other == QUAYS else HULL_SHARE * p[BRAKE]
    for side in (1.0, -1.0):
        free = free_way(state, helms, land, pitch, i, other, side, gap, reach)
        if free >= reach:
            if gap > (0.5 if other == QUAYS else 1.0) * p[CLEARANCE]:
                continue
            # So near, going along is safe only slowly; going away is free.
            away = gap_to(state, helms, land, pitch, i, other, side * STEP_M, reach)
            past = PAST_QUAY_MPS if other == QUAYS else PAST_HULL_MPS
            most = UNLIMITED if away > gap + SLACK_M else past
        else:
            most = stopping_speed(free, brake, reaction)
        if side > 0.0:
            s[MOST_AHEAD] = min(s[MOST_AHEAD], most)
        else:
            s[MOST_ASTERN] = min(s[MOST_ASTERN], most)
    return gap


@kernel
def windward_room(s: FloatArray, p: FloatArray, land: LandArray, pitch: float) -> float:
    """How far up the drift of its place the hull should lie [m], for there is a quay to leeward."""
    drift = math.sqrt(s[DRIFT_X] ** 2 + s[DRIFT_Y] ** 2)
    if drift < STRONG_DRIFT_MPS:
        return 0.0
    c, t = s[DRIFT_X] / drift, s[DRIFT_Y] / drift
    wide = 0.5 * p[LENGTH]
    to_lee = quay_gap(land, pitch, s[PLACE_X], s[PLACE_Y], c, t, wide, wide, LEE_M)
    x, y = s[PLACE_X] - MOST_UP_M * c, s[PLACE_Y] - MOST_UP_M * t
    moved = quay_gap(land, pitch, x, y, c, t, wide, wide, LEE_M)
    return MOST_UP_M if moved > to_lee + 0.5 * MOST_UP_M else 0.0


@kernel
def limit_speeds(
    state: FloatArray, helms: FloatArray, land: LandArray, pitch: float, i: int
) -> None:
    """Set the fastest safe speeds of vessel `i`, ahead, astern and turning."""
    s, p = state[i], helms[i]
    s[MOST_AHEAD] = s[MOST_ASTERN] = s[MOST_RATE] = UNLIMITED
    cruise = max(p[CRUISE_AHEAD], p[CRUISE_ASTERN])
    reach = stopping_distance(cruise, p[BRAKE], p[LAG] + REACTION_S) + p[CLEARANCE]
    swing = circle_radius(p[LENGTH], p[BEAM]) - 0.5 * p[BEAM] + SWING_M
    radius = circle_radius(p[LENGTH], p[BEAM])
    if limit_by(state, helms, land, pitch, i, QUAYS, reach) < swing:
        s[MOST_RATE] = TOUCH_QUAY_MPS / radius
    s[UP] = windward_room(s, p, land, pitch) if s[MODE] == HOLD else 0.0
    far = reach + LONGEST_PATH_M + 0.5 * p[LENGTH]
    for j in range(state.shape[0]):
        dx, dy = abs(state[j, X] - s[X]), abs(state[j, Y] - s[Y])
        if j == i or max(dx, dy) > far + 0.5 * helms[j, LENGTH]:
            continue
        if limit_by(state, helms, land, pitch, i, j, reach) < swing:
            s[MOST_RATE] = TOUCH_HULL_MPS / radius
