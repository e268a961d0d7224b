"""The last word: how fast a hull may go and turn so that it can still stop before anything."""

import math

from controllers._compiled import kernel
from controllers.boxes import box_gap, circle_radius
from controllers.chart import LandArray, quay_gap
from controllers.guidance import stopping_distance, stopping_speed
from controllers.helm import BEAM, BRAKE, CLEARANCE, CRUISE_AHEAD, LAG, LENGTH, FloatArray
from controllers.state import (
    MOST_AHEAD,
    MOST_ASTERN,
    MOST_RATE,
    RANK,
    VX,
    VY,
    YAW,
    X,
    Y,
)

REACTION_S = 0.1
GIVE_WAY_S = 1.0  # by how much longer the path ahead of a vessel with right of way is kept free
TOUCH_MPS = 0.25  # speed of a bow that swings where it may touch something
STEP_M = 0.25  # of looking ahead
SLACK_M = 0.02  # by which a gap may shrink that is already too small
SWING_M = 0.1
UNLIMITED = 1e3


@kernel
def gap_at(
    state: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    i: int,
    shift: float,
    reach: float,
) -> float:
    """Gap of vessel `i`, moved by `shift` along its heading, to quays and to others' braking paths.

    Parameters
    ----------
    state : (vessel, SIZE) rows of one episode
    helms : (vessel, SIZE) of `packed`
    reach : gaps beyond it count as it [m]
    """
    yaw = state[i, YAW]
    c, t = math.cos(yaw), math.sin(yaw)
    x, y = state[i, X] + shift * c, state[i, Y] + shift * t
    half_length, half_beam = 0.5 * helms[i, LENGTH], 0.5 * helms[i, BEAM]
    gap = quay_gap(land, pitch, x, y, c, t, half_length, half_beam, reach)
    for j in range(state.shape[0]):
        if j == i:
            continue
        dx, dy = state[j, X] - x, state[j, Y] - y
        far = reach + half_length + 0.5 * helms[j, LENGTH] + 5.0
        if abs(dx) > far or abs(dy) > far:
            continue
        cj, tj = math.cos(state[j, YAW]), math.sin(state[j, YAW])
        u = cj * state[j, VX] + tj * state[j, VY]
        v = cj * state[j, VY] - tj * state[j, VX]
        way = stopping_distance(abs(u), helms[j, BRAKE], helms[j, LAG] + REACTION_S)
        if state[j, RANK] < state[i, RANK]:
            way += GIVE_WAY_S * abs(u)
        ahead, aside = math.copysign(0.5 * way, u), 0.25 * v
        dx += ahead * cj - aside * tj
        dy += ahead * tj + aside * cj
        long, wide = 0.5 * (helms[j, LENGTH] + way), 0.5 * helms[j, BEAM] + abs(aside)
        gap = min(gap, box_gap(dx, dy, c, t, half_length, half_beam, cj, tj, long, wide))
    return gap


@kernel
def free_way(
    state: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    i: int,
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
        following = gap_at(state, helms, land, pitch, i, side * (gone + step), reach)
        if following < least:
            return gone + step * max(gap - least, 0.0) / (gap - following)
        gone, gap = gone + step, following
    return gone


@kernel
def limit_speeds(
    state: FloatArray, helms: FloatArray, land: LandArray, pitch: float, i: int
) -> None:
    """Set the fastest safe speeds of vessel `i`, ahead, astern and turning."""
    s, p = state[i], helms[i]
    s[MOST_AHEAD] = s[MOST_ASTERN] = s[MOST_RATE] = UNLIMITED
    reaction = p[LAG] + REACTION_S
    reach = stopping_distance(p[CRUISE_AHEAD], p[BRAKE], reaction) + p[CLEARANCE]
    gap = gap_at(state, helms, land, pitch, i, 0.0, reach)
    if gap >= reach:
        return
    ahead = free_way(state, helms, land, pitch, i, 1.0, gap, reach)
    astern = free_way(state, helms, land, pitch, i, -1.0, gap, reach)
    if ahead < reach:
        s[MOST_AHEAD] = stopping_speed(ahead, p[BRAKE], reaction)
    if astern < reach:
        s[MOST_ASTERN] = stopping_speed(astern, p[BRAKE], reaction)
    radius = circle_radius(p[LENGTH], p[BEAM])
    if gap < radius - 0.5 * p[BEAM] + SWING_M:
        s[MOST_RATE] = TOUCH_MPS / radius
