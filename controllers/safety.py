"""Safe speeds: limits of speed and turn rate at which a vessel can stop before an obstacle.

They limit every command, whatever guidance and traffic want.
"""

from mjforage.base.compiled import kernel
from mjforage.controllers.chart import LandArray
from mjforage.controllers.clearance import (
    QUAYS,
    SLACK_M,
    STEP_M,
    clear_path,
    clearance_to,
    free_distance,
    least_clearance,
    turn_to_come,
)
from mjforage.controllers.contact import NEAR_M, VESSEL_SHARE, heed_land, heed_vessel
from mjforage.controllers.guidance import stopping_distance, stopping_speed, striking_speed
from mjforage.controllers.lee_shore import UNLIMITED, heed_lee, heed_lee_vessel, windward_room
from mjforage.controllers.legs import REACTION_S
from mjforage.controllers.state import HOLD, FleetArray, VesselState
from mjforage.controllers.vessel_model import ModelArray

AHEAD, TURNED = 0.0, 1.0  # vessels as they head now, and as they will when they turn no more
LEAST_TURN_RAD = 0.05  # a turn that is looked at
UNSURE_MPS = 0.25  # towards a quay that may be nearer than it seems
ALONG_MPS = 0.4  # along such a quay
PAST_QUAY_MPS, PAST_VESSEL_MPS = 0.25, 0.15  # along a vessel nearer than the clearance, a quay half
LONGEST_PATH_M = 5.0  # of another, to stop


@kernel
def limit_by(
    state: FleetArray,
    models: ModelArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    turned: float,
    reach: float,
) -> float:
    """Lower the fastest safe speeds of vessel `i` for the sake of the quays or another; the gap."""
    s, p, margin = state[i], models[i], state[i].margin
    gap, way, share = clear_path(state, models, land, pitch, i, other, turned, reach)
    if gap >= reach:
        return gap
    reaction = p.lag_s + REACTION_S
    brake = p.brake_mps2 if other == QUAYS else VESSEL_SHARE * p.brake_mps2
    clear = least_clearance(s, p, other)
    for side in (1.0, -1.0):
        if margin > 0.0 and other == QUAYS:  # what may be a quay is touched slowly at most
            sure = free_distance(
                state, models, land, pitch, i, other, way, side, turned, gap, margin, reach
            )
            most = UNLIMITED
            if gap > margin:
                most = striking_speed(sure, brake, reaction, UNSURE_MPS)
            elif sure < reach:
                most = UNSURE_MPS
            else:  # alongside, where a corner may jut out that seems to be passed
                away = clearance_to(
                    state, models, land, pitch, i, other, way, side * STEP_M, turned, reach
                )
                most = UNLIMITED if away > gap + SLACK_M else ALONG_MPS
            if side > 0.0:
                s.most_ahead = min(s.most_ahead, most)
            else:
                s.most_astern = min(s.most_astern, most)
        free = free_distance(
            state, models, land, pitch, i, other, way, side, turned, gap, clear, reach
        )
        if free >= reach:
            if gap > (0.5 if other == QUAYS else 1.0) * clear:
                continue
            # So near, going along is safe only slowly; going away is free.
            away = clearance_to(
                state, models, land, pitch, i, other, way, side * STEP_M, turned, reach
            )
            slow = other != QUAYS and s.off_s == 0.0
            past = PAST_VESSEL_MPS if slow else PAST_QUAY_MPS
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
    models: ModelArray,
    land: LandArray,
    pitch: float,
    i: int,
    other: int,
    reach: float,
) -> float:
    """`limit_by` as the vessels head now and, if they turn, as they will; the gap now."""
    gap = limit_by(state, models, land, pitch, i, other, AHEAD, reach)
    turn = abs(turn_to_come(state[i], models[i]))
    if other != QUAYS:
        turn += abs(turn_to_come(state[other], models[other]))
    if turn > LEAST_TURN_RAD:
        limit_by(state, models, land, pitch, i, other, TURNED, reach)
    return gap


@kernel
def settle(s: VesselState) -> None:
    """Make opposite limits consistent: neither demands what the other forbids."""
    s.most_ahead = max(s.most_ahead, min(-s.most_astern, 0.0))
    s.most_astern = max(s.most_astern, min(-s.most_ahead, 0.0))


@kernel
def limit_speeds(
    state: FleetArray, models: ModelArray, land: LandArray, pitch: float, i: int
) -> None:
    """Set the fastest safe speeds of vessel `i`, ahead, astern and turning."""
    s, p = state[i], models[i]
    s.in_contact = s.load_port = s.load_starboard = s.lee_x = s.lee_y = 0.0
    s.most_ahead = s.most_astern = s.most_port = s.most_starboard = UNLIMITED
    cruise = max(p.cruise_ahead_mps, p.cruise_astern_mps)
    reach = stopping_distance(cruise, p.brake_mps2, p.lag_s + REACTION_S) + p.clearance_m
    reach += s.margin
    if limit_going(state, models, land, pitch, i, QUAYS, reach) < NEAR_M + s.margin:
        heed_land(s, p, land, pitch)
    if s.off_s == 0.0:
        heed_lee(s, p, land, pitch)
    s.up = windward_room(s, p, land, pitch) if s.mode == HOLD else 0.0
    far = reach + LONGEST_PATH_M + 0.5 * p.length_m + s.margin
    for j in range(state.shape[0]):
        dx, dy = abs(state[j].x - s.x), abs(state[j].y - s.y)
        if j == i or max(dx, dy) > far + 0.5 * models[j].length_m + state[j].margin:
            continue
        if limit_going(state, models, land, pitch, i, j, reach) < NEAR_M:
            heed_vessel(s, p, state[j], models[j])
        if s.off_s == 0.0:
            heed_lee_vessel(s, p, state[j], models[j])
    settle(s)
