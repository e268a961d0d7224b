"""Right of way: who plans around whom, and how.

Every decision, the vessel that will arrive last goes first; those that stay come last. In that
order each vessel takes the first of its plans that is free of conflict: straight on, what it did
before, waiting, or a detour through a point beside its way. A vessel that stays is gone around
where that costs little; else it makes room, beside its place.
"""

import math

import numpy as np

from controllers._compiled import kernel
from controllers.boxes import box_gap, circle_radius
from controllers.chart import LandArray, quay_gap
from controllers.helm import BEAM, CLEARANCE, LENGTH, FloatArray
from controllers.prediction import NEVER_S, SAMPLE_S, SAMPLES, predict
from controllers.state import (
    CLOCK,
    END_X,
    END_Y,
    HOLD,
    MODE,
    PLACE_X,
    PLACE_Y,
    PROMOTED,
    RANK,
    STUCK,
    TARGET_X,
    TARGET_Y,
    TRANSIT,
    VIA,
    WAIT,
    X,
    Y,
)
from controllers.steering import distance_to, start_transit

GROWTH_MPS = 0.04  # of the margin with time, for what is not foreseen
MOST_GROWTH_M = 0.2
BESIDE_M = 0.1  # margin over the hulls' clearance
NEAR_M = 1.0  # hulls whose ways come nearer than this, or their clearance, are looked at
RETURN_M = 0.15  # margin more for giving up a detour
KEEP_M = 0.1  # margin less for keeping on as before
CONFLICT_S = 60.0  # cost of a plan with a conflict
PATIENCE_S = 3.0  # a detour around a vessel that stays may take so much longer
NONE = -1


def _detours() -> FloatArray:
    """(plan, 4): 1 if counted from the meeting, 0 from here, -1 for no via point; then metres
    along and to port of the way, and seconds to wait.
    """
    waits = [(-1.0, 0.0, 0.0, w) for w in (1.0, 2.0, 3.0, 4.0, 6.0)]
    aside = [(1.0, 0.0, a * b, 0.0) for a in (0.8, 1.3, 1.9, 2.6) for b in (-1, 1)]
    later = [(1.0, 1.5, a * b, 0.0) for a in (1.3, 1.9) for b in (-1, 1)]
    here = [(0.0, 0.3, a * b, w) for a in (1.2, 1.9) for b in (-1, 1) for w in (0.0, 3.0)]
    back = [(0.0, -a, 0.0, w) for a in (0.9, 1.8) for w in (2.0, 4.0)]
    return np.array([*waits, *aside, *later, *here, *back])


DETOURS = _detours()


@kernel
def rank_fleet(fleet: FloatArray, helms: FloatArray, spare: FloatArray) -> None:
    """Give every vessel its rank for this decision: latest arrival first, who stays last."""
    n = fleet.shape[0]
    for v in range(n):
        s = fleet[v]
        if s[MODE] == HOLD:
            s[RANK] = NEVER_S + v
        else:
            eta = predict(
                s, helms[v], math.nan, math.nan, 0.0, s[TARGET_X], s[TARGET_Y], spare
            )
            s[RANK] = -eta - 1e-3 * distance_to(s, s[TARGET_X], s[TARGET_Y]) - 1e-6 * v


@kernel
def ways_meet(fleet: FloatArray, helms: FloatArray, i: int, j: int) -> bool:
    """Whether the boxes around the ways of two vessels come near each other."""
    a, b = fleet[i], fleet[j]
    room = NEAR_M + circle_radius(helms[i, LENGTH], helms[i, BEAM])
    room += circle_radius(helms[j, LENGTH], helms[j, BEAM])
    for x, end, place, target in ((X, END_X, PLACE_X, TARGET_X), (Y, END_Y, PLACE_Y, TARGET_Y)):
        low_a = min(min(a[x], a[place]), a[target])
        high_a = max(max(a[x], a[place]), a[target])
        low_b = min(min(b[x], b[place]), b[target])
        high_b = max(max(b[x], b[place]), b[target])
        if a[VIA] != 0.0:
            low_a, high_a = min(low_a, a[end]), max(high_a, a[end])
        if b[VIA] != 0.0:
            low_b, high_b = min(low_b, b[end]), max(high_b, b[end])
        if low_a - room > high_b or low_b - room > high_a:
            return False
    return True


@kernel
def conflict(
    a: FloatArray, b: FloatArray, helm_a: FloatArray, helm_b: FloatArray, extra: float
) -> int:
    """First sample at which two predicted hulls are too near each other, or `NONE`.

    Parameters
    ----------
    a, b : (SAMPLES, 4) of `predict`
    extra : margin over the usual one [m]
    """
    long_a, wide_a = 0.5 * helm_a[LENGTH], 0.5 * helm_a[BEAM]
    long_b, wide_b = 0.5 * helm_b[LENGTH], 0.5 * helm_b[BEAM]
    clear = max(helm_a[CLEARANCE], helm_b[CLEARANCE]) + BESIDE_M + extra
    far = long_a + wide_a + long_b + wide_b + clear + MOST_GROWTH_M
    most = clear
    for k in range(SAMPLES):
        dx, dy = b[k, 0] - a[k, 0], b[k, 1] - a[k, 1]
        if abs(dx) > far or abs(dy) > far:
            continue
        gap = box_gap(
            dx, dy, a[k, 2], a[k, 3], long_a, wide_a, b[k, 2], b[k, 3], long_b, wide_b
        )
        if k == 0:
            most = min(clear, gap - 0.02)
        elif gap < most + (min(GROWTH_MPS * k * SAMPLE_S, MOST_GROWTH_M) if most == clear else 0.0):
            return k
    return NONE


@kernel
def runs_aground(a: FloatArray, p: FloatArray, land: LandArray, pitch: float) -> bool:
    """Whether a predicted hull comes too near a quay."""
    long, wide, least = 0.5 * p[LENGTH], 0.5 * p[BEAM], p[CLEARANCE]
    for k in range(0, SAMPLES, 2):
        gap = quay_gap(land, pitch, a[k, 0], a[k, 1], a[k, 2], a[k, 3], long, wide, least)
        if k == 0:
            least = min(least, gap - 0.02)
        elif gap < least:
            return True
    return False


@kernel
def first_conflict(
    fleet: FloatArray,
    helms: FloatArray,
    paths: FloatArray,
    met: FloatArray,
    v: int,
    path: FloatArray,
    heed_resting: bool,
    extra: float,
) -> tuple[int, int]:
    """Earliest conflict of a plan of vessel `v` with those it must heed: sample and vessel."""
    first, other = NONE, NONE
    for u in range(fleet.shape[0]):
        if u == v or met[v, u] == 0.0:
            continue
        resting = fleet[u, MODE] == HOLD
        if resting and not heed_resting:
            continue
        if not resting and fleet[u, RANK] > fleet[v, RANK] and fleet[u, STUCK] == 0.0:
            continue
        k = conflict(path, paths[u], helms[v], helms[u], extra)
        if k != NONE and (first == NONE or k < first):
            first, other = k, u
    return first, other


@kernel
def plan_cost(
    fleet: FloatArray,
    helms: FloatArray,
    paths: FloatArray,
    met: FloatArray,
    v: int,
    land: LandArray,
    pitch: float,
    via_x: float,
    via_y: float,
    wait_s: float,
    end_x: float,
    end_y: float,
    heed_resting: bool,
    extra: float,
) -> float:
    """Cost [s] of a plan of vessel `v`, which is left in the last row of `paths`."""
    path = paths[fleet.shape[0]]
    arrival = predict(fleet[v], helms[v], via_x, via_y, wait_s, end_x, end_y, path)
    if arrival == NEVER_S:
        dx, dy = end_x - path[SAMPLES - 1, 0], end_y - path[SAMPLES - 1, 1]
        arrival = SAMPLES * SAMPLE_S + math.sqrt(dx * dx + dy * dy)
    k, _ = first_conflict(fleet, helms, paths, met, v, path, heed_resting, extra)
    if k != NONE:
        arrival += CONFLICT_S - 2.0 * k * SAMPLE_S
    if runs_aground(path, helms[v], land, pitch):
        arrival += 0.5 * CONFLICT_S
    return arrival


@kernel
def search_detour(
    fleet: FloatArray,
    helms: FloatArray,
    paths: FloatArray,
    met: FloatArray,
    v: int,
    land: LandArray,
    pitch: float,
    first: int,
    heed_resting: bool,
) -> tuple[float, float, float, float]:
    """Cheapest plan: cost [s], via point (NaN for none) and time to wait."""
    n, s = fleet.shape[0], fleet[v]
    path = paths[n]
    at_x, at_y = path[first, 0], path[first, 1]
    end_x, end_y = s[PLACE_X], s[PLACE_Y]
    best, best_x, best_y, best_wait = 1e9, math.nan, math.nan, 0.0
    dx, dy = end_x - s[X], end_y - s[Y]
    far = max(math.sqrt(dx * dx + dy * dy), 1e-6)
    dx, dy = dx / far, dy / far
    meeting = min(max((at_x - s[X]) * dx + (at_y - s[Y]) * dy, 0.3), far + 0.5)
    for i in range(DETOURS.shape[0]):
        anchored, along, aside, wait = DETOURS[i]
        x = y = math.nan
        if anchored >= 0.0:
            along += anchored * meeting
            x, y = s[X] + along * dx - aside * dy, s[Y] + along * dy + aside * dx
        cost = plan_cost(
            fleet, helms, paths, met, v, land, pitch, x, y, wait, end_x, end_y, heed_resting, 0.0
        )
        if cost < best:
            best, best_x, best_y, best_wait = cost, x, y, wait
    return best, best_x, best_y, best_wait


@kernel
def keep_path(paths: FloatArray, v: int) -> None:
    """Make the plan in the last row of `paths` that of vessel `v`."""
    last = paths.shape[0] - 1
    for k in range(SAMPLES):
        for i in range(4):
            paths[v, k, i] = paths[last, k, i]


@kernel
def plan_mover(
    fleet: FloatArray,
    helms: FloatArray,
    paths: FloatArray,
    met: FloatArray,
    v: int,
    land: LandArray,
    pitch: float,
) -> bool:
    """Choose the plan of a vessel under way; whether it has taken over another's right of way."""
    n, s, p = fleet.shape[0], fleet[v], helms[v]
    path = paths[n]
    x, y = s[PLACE_X], s[PLACE_Y]
    planned = s[VIA] != 0.0 or s[WAIT] > s[CLOCK]
    direct = predict(s, p, math.nan, math.nan, 0.0, x, y, path)
    extra = RETURN_M if planned else -KEEP_M
    first, _ = first_conflict(fleet, helms, paths, met, v, path, True, extra)
    s[STUCK] = 0.0
    if first == NONE:
        keep_path(paths, v)
        s[WAIT] = 0.0
        if s[VIA] != 0.0:
            start_transit(s, p, x, y, False)
        return False
    if planned:
        via_x = s[END_X] if s[VIA] != 0.0 else math.nan
        via_y = s[END_Y] if s[VIA] != 0.0 else math.nan
        cost = plan_cost(
            fleet, helms, paths, met, v, land, pitch,
            via_x, via_y, s[WAIT] - s[CLOCK], x, y, True, -KEEP_M,
        )  # fmt: skip
        if cost < 0.5 * CONFLICT_S:
            keep_path(paths, v)
            return False
        predict(s, p, math.nan, math.nan, 0.0, x, y, path)
    cost, via_x, via_y, wait = search_detour(
        fleet, helms, paths, met, v, land, pitch, first, True
    )
    if cost > min(direct + PATIENCE_S, 0.5 * CONFLICT_S):
        predict(s, p, math.nan, math.nan, 0.0, x, y, path)
        first, other = first_conflict(fleet, helms, paths, met, v, path, False, -KEEP_M)
        if cost > 0.5 * CONFLICT_S and other != NONE and s[PROMOTED] == 0.0:
            s[RANK], fleet[other, RANK] = fleet[other, RANK], s[RANK]
            s[PROMOTED] = 1.0
            return True
        if first == NONE:
            via_x, via_y, wait, cost = math.nan, math.nan, 0.0, direct
        elif cost > 0.5 * CONFLICT_S:
            cost, via_x, via_y, wait = search_detour(
                fleet, helms, paths, met, v, land, pitch, first, False
            )
    s[STUCK] = 1.0 if cost > 0.5 * CONFLICT_S else 0.0
    s[WAIT] = s[CLOCK] + wait
    predict(s, p, via_x, via_y, wait, x, y, path)
    keep_path(paths, v)
    if not math.isnan(via_x):
        start_transit(s, p, via_x, via_y, True)
    elif s[VIA] != 0.0:
        start_transit(s, p, x, y, False)
    return False


@kernel
def plan_resting(
    fleet: FloatArray,
    helms: FloatArray,
    paths: FloatArray,
    met: FloatArray,
    v: int,
    land: LandArray,
    pitch: float,
) -> None:
    """Choose the place of a vessel that stays: its target, or beside it to let others pass."""
    s, p = fleet[v], helms[v]
    x, y = s[TARGET_X], s[TARGET_Y]
    best_x, best_y = x, y
    best = plan_cost(
        fleet, helms, paths, met, v, land, pitch, math.nan, math.nan, 0.0, x, y, False, 0.0
    )
    if best > 0.5 * CONFLICT_S:
        best = 1e9
        for ring in range(4):
            for side in range(8 if ring else 1):
                angle = 0.25 * math.pi * side
                reach = (0.0, 0.9, 1.3, 1.8)[ring]
                if ring:
                    to_x, to_y = x + reach * math.cos(angle), y + reach * math.sin(angle)
                else:
                    to_x, to_y = s[PLACE_X], s[PLACE_Y]
                cost = reach + plan_cost(
                    fleet, helms, paths, met, v, land, pitch,
                    math.nan, math.nan, 0.0, to_x, to_y, False, 0.0,
                )  # fmt: skip
                if cost < best - 0.01:
                    best, best_x, best_y = cost, to_x, to_y
    changed = best_x != s[PLACE_X] or best_y != s[PLACE_Y]
    s[PLACE_X], s[PLACE_Y] = best_x, best_y
    if changed and distance_to(s, best_x, best_y) > 0.5:
        start_transit(s, p, best_x, best_y, False)


@kernel
def plan_in_order(
    fleet: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    paths: FloatArray,
    met: FloatArray,
) -> bool:
    """Plan vessel after vessel by rank; stops and returns True where ranks have changed."""
    n, last = fleet.shape[0], -1e18
    for _ in range(n):
        v, rank = NONE, 1e18
        for u in range(n):
            if last < fleet[u, RANK] < rank:
                v, rank = u, fleet[u, RANK]
        if v == NONE:
            break
        last = rank
        alone = True
        for u in range(n):
            alone = alone and (u == v or met[v, u] == 0.0)
        if alone:
            continue
        if rank >= NEVER_S:
            plan_resting(fleet, helms, paths, met, v, land, pitch)
        elif plan_mover(fleet, helms, paths, met, v, land, pitch):
            return True
    return False


@kernel
def plan_fleet(
    fleet: FloatArray,
    helms: FloatArray,
    land: LandArray,
    pitch: float,
    paths: FloatArray,
    met: FloatArray,
) -> None:
    """Choose the plans of all vessels of one episode.

    Parameters
    ----------
    fleet : (vessel, state.SIZE)
    helms : (vessel, helm.SIZE) of `packed`
    paths : (vessel + 1, SAMPLES, 4) working space
    met : (vessel, vessel) working space
    """
    n = fleet.shape[0]
    some = False
    for i in range(n):
        for j in range(i):
            near = ways_meet(fleet, helms, i, j)
            met[i, j] = met[j, i] = 1.0 if near else 0.0
            some = some or near
    for v in range(n):
        s = fleet[v]
        alone = True
        for u in range(n):
            alone = alone and (u == v or met[v, u] == 0.0)
        if alone:
            s[WAIT] = s[STUCK] = 0.0
            away = s[PLACE_X] != s[TARGET_X] or s[PLACE_Y] != s[TARGET_Y]
            s[PLACE_X], s[PLACE_Y] = s[TARGET_X], s[TARGET_Y]
            if s[VIA] != 0.0 or (away and s[MODE] == TRANSIT):
                start_transit(s, helms[v], s[TARGET_X], s[TARGET_Y], False)
        elif s[MODE] == HOLD:
            predict(
                s, helms[v], math.nan, math.nan, 0.0, s[PLACE_X], s[PLACE_Y], paths[v]
            )
    if not some:
        return
    for _ in range(n + 1):
        if not plan_in_order(fleet, helms, land, pitch, paths, met):
            break
