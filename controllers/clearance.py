"""Clearance before quays and before the paths on which others stop, and the way left free."""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.boxes import box_gap, circle_radius
from mjforage.controllers.chart import LandArray, quay_gap
from mjforage.controllers.guidance import stopping_distance
from mjforage.controllers.legs import REACTION_S
from mjforage.controllers.quayside import is_quayed
from mjforage.controllers.state import FleetArray, VesselState
from mjforage.controllers.vessel_model import ModelArray, ModelRecord

QUAYS = -1  # in place of another vessel
GIVE_WAY_S = 1.0  # by how much longer the path ahead of a vessel with right of way is kept free
SWING_S = 0.25  # for which another that turns is taken to turn on
STEP_M = 0.25  # of looking ahead
PICKING_M = 0.03  # kept free of quays by a vessel that picks up beside one
SLACK_M = 0.02  # by which a gap may shrink that is already too small


@kernel
def turn_to_come(s: VesselState, p: ModelRecord) -> float:
    """Angle by which a vessel turns before it can turn no more [rad]."""
    stop = p.lag_s + REACTION_S + 0.5 * abs(s.rate) / p.yaw_acceleration_radps2
    return float(s.rate * stop)


@kernel
def joint_margin(s: VesselState, other: VesselState) -> float:
    """Margin between two vessels [m]: the root of the sum of squares, for independent errors."""
    return math.sqrt(s.margin * s.margin + other.margin * other.margin)


@kernel
def clearance_to(
    state: FleetArray,
    models: ModelArray,
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
    state, models : (vessel,) of one episode
    other : a vessel, or `QUAYS`
    way : length of the other's path [m]
    turned : share of the turns that are under way by which both have turned
    reach : gaps beyond it count as it [m]
    """
    yaw = state[i].yaw + turned * turn_to_come(state[i], models[i])
    c, t = math.cos(yaw), math.sin(yaw)
    x, y = state[i].x + shift * c, state[i].y + shift * t
    half_length, half_beam = 0.5 * models[i].length_m, 0.5 * models[i].beam_m
    if other == QUAYS:
        return quay_gap(land, pitch, x, y, c, t, half_length, half_beam, reach)
    dx, dy = state[other].x - x, state[other].y - y
    yaw = state[other].yaw + turned * turn_to_come(state[other], models[other])
    cj, tj = math.cos(yaw), math.sin(yaw)
    u = cj * state[other].vx + tj * state[other].vy
    v = cj * state[other].vy - tj * state[other].vx
    swing = (
        SWING_S
        * abs(state[other].rate)
        * circle_radius(models[other].length_m, models[other].beam_m)
    )
    ahead, aside = math.copysign(0.5 * way, u), 0.25 * v
    dx += ahead * cj - aside * tj
    dy += ahead * tj + aside * cj
    long = 0.5 * (models[other].length_m + way) + swing
    wide = 0.5 * models[other].beam_m + abs(aside) + swing
    gap = box_gap(dx, dy, c, t, half_length, half_beam, cj, tj, long, wide)
    return min(gap - joint_margin(state[i], state[other]), reach)


@kernel
def way_of(state: FleetArray, models: ModelArray, i: int, other: int) -> tuple[float, float]:
    """Way that another vessel takes to stop, and that vessel `i` leaves it for having right of way.

    Both in metres.
    """
    s, p = state[other], models[other]
    speed = abs(math.cos(s.yaw) * s.vx + math.sin(s.yaw) * s.vy)
    stop = stopping_distance(speed, p.brake_mps2, p.lag_s + REACTION_S)
    return stop, GIVE_WAY_S * speed if s.rank < state[i].rank else 0.0


@kernel
def clear_path(
    state: FleetArray,
    models: ModelArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    turned: float,
    reach: float,
) -> tuple[float, float, float]:
    """The longest path of another that vessel `i` is not in already: none, if it is in all.

    Returns
    -------
    gap to it and its length [m], share of the gap that is vessel `i`'s
    """
    if other == QUAYS:
        return clearance_to(state, models, land, pitch, i, other, 0.0, 0.0, turned, reach), 0.0, 1.0
    stop, more = way_of(state, models, i, other)
    for way in (stop + more, stop):
        gap = clearance_to(state, models, land, pitch, i, other, way, 0.0, turned, reach)
        if gap > 0.0:
            return gap, way, 1.0
    return clearance_to(state, models, land, pitch, i, other, 0.0, 0.0, turned, reach), 0.0, 0.5


@kernel
def picks_at_quay(s: VesselState, p: ModelRecord) -> bool:
    """True if an item to collect lies beside a quay, near by."""
    near = max(abs(s.item_x - s.x), abs(s.item_y - s.y)) < p.length_m + p.clearance_m
    return bool(is_quayed(s) and near)


@kernel
def least_clearance(s: VesselState, p: ModelRecord, other: int) -> float:
    """Clearance to keep from another or from quays [m]: less where an item lies at one, near by."""
    if other != QUAYS or not picks_at_quay(s, p):
        return p.clearance_m
    return min(PICKING_M, p.clearance_m)


@kernel
def free_distance(
    state: FleetArray,
    models: ModelArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    way: float,
    side: float,
    turned: float,
    first: float,
    least: float,
    reach: float,
) -> float:
    """Distance [m] that vessel `i` can go ahead (`side` 1) or astern (-1) and keep a clearance.

    Where the gap is less than that already (`first` is the gap now), it may not shrink further.
    """
    least = min(least, first - SLACK_M)
    gone, gap = 0.0, first
    while gone < reach:
        step = max(gap - least, STEP_M)
        following = clearance_to(
            state, models, land, pitch, i, other, way, side * (gone + step), turned, reach
        )
        if following < least:
            return float(gone + step * max(gap - least, 0.0) / (gap - following))
        gone, gap = gone + step, following
    return gone
