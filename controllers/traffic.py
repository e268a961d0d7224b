"""Right of way: the order in which vessels plan around each other, and their plans.

Every decision, the vessel that will arrive last goes first; those that stay come last. In that
order each vessel takes the first of its plans that is free of conflict: straight on, what it did
before, waiting, or a detour through a point beside its way. A vessel that stays is gone around
where that costs little; else it makes room, beside its place. A vessel that finds no plan at all is
given the right of way by the vessel it meets, once in a decision.
"""

import math

from mjforage.base.compiled import kernel
from mjforage.controllers.conflicts import (
    NONE,
    Traffic,
    conflict,
    first_conflict,
    runs_aground,
    ways_meet,
)
from mjforage.controllers.detours import (
    BAD_S,
    Plan,
    plan_cost,
    search_detour,
    straight_on,
    try_plan,
)
from mjforage.controllers.prediction import NEVER_S, SAMPLES, predict
from mjforage.controllers.state import HOLD, TRANSIT, FleetArray, VesselState
from mjforage.controllers.steering import distance_to, start_transit
from mjforage.controllers.vessel_model import FloatArray, ModelArray, ModelRecord

RETURN_M = 0.15  # margin more for giving up a detour
KEEP_M = 0.1  # margin less for keeping on as before
PATIENCE_S = 3.0  # a detour around a vessel that stays may take so much longer
PASSING_M = (0.7, 0.9, 1.2, -0.7, -0.9, -1.2)  # how far to starboard of the middle two pass
PASSING = 2.0  # stuck, but passing with the other's help
RINGS_M = (0.9, 1.3, 1.8)  # how far beside its target a vessel makes room


@kernel
def rank_fleet(fleet: FleetArray, models: ModelArray, spare: FloatArray) -> None:
    """Give every vessel its rank for this decision: latest arrival first, those that stay last."""
    for v in range(fleet.shape[0]):
        s = fleet[v]
        x, y = s.target_x, s.target_y
        s.rank = NEVER_S + v
        if s.mode != HOLD:
            eta = predict(s, models[v], math.nan, math.nan, 0.0, x, y, spare)
            s.rank = -eta - 1e-3 * distance_to(s, x, y) - 1e-6 * v


@kernel
def keep_path(traffic: Traffic, v: int) -> None:
    """Make the path that was tried that of vessel `v`."""
    paths = traffic.paths
    last = paths.shape[0] - 1
    for k in range(SAMPLES):
        for i in range(4):
            paths[v, k, i] = paths[last, k, i]


@kernel
def plan_of(s: VesselState) -> Plan:
    """The present plan of a vessel under way."""
    via = s.via != 0.0
    x, y = (s.end_x, s.end_y) if via else (math.nan, math.nan)
    return Plan(x, y, s.wait - s.clock, s.place_x, s.place_y)


@kernel
def take_plan(traffic: Traffic, v: int, plan: Plan) -> None:
    """Let vessel `v` follow a new plan."""
    s, p = traffic.fleet[v], traffic.models[v]
    s.wait = s.clock + plan.wait_s if plan.wait_s > 0.0 else 0.0
    try_plan(traffic, v, plan)
    keep_path(traffic, v)
    if not math.isnan(plan.via_x):
        start_transit(s, p, plan.via_x, plan.via_y, True)
    elif s.via != 0.0:
        start_transit(s, p, plan.end_x, plan.end_y, False)


@kernel
def passing_plan(s: VesselState, x: float, y: float, aside: float) -> Plan:
    """The way through the point `aside` metres to starboard of (x, y)."""
    dx, dy = s.place_x - s.x, s.place_y - s.y
    far = max(math.sqrt(dx * dx + dy * dy), 1e-6)
    return Plan(x + aside * dy / far, y - aside * dx / far, 0.0, s.place_x, s.place_y)


@kernel
def pass_each_other(traffic: Traffic, v: int, u: int) -> bool:
    """Let two vessels that meet head-on both give way, to starboard if they can.

    Neither could go round the other alone. The second, which should have given way, counts as
    stuck, so that the first continues to avoid it.
    """
    fleet, models, paths = traffic.fleet, traffic.models, traffic.paths
    a, b = fleet[v], fleet[u]
    x, y = 0.5 * (a.x + b.x), 0.5 * (a.y + b.y)
    for aside in PASSING_M:
        plan_a, plan_b = passing_plan(a, x, y, aside), passing_plan(b, x, y, aside)
        if (plan_a.via_x - plan_b.via_x) ** 2 + (plan_a.via_y - plan_b.via_y) ** 2 < aside * aside:
            return False  # they do not meet head-on
        try_plan(traffic, u, plan_b)
        if runs_aground(paths[-1], models[u], traffic.land, traffic.pitch):
            continue
        keep_path(traffic, u)
        try_plan(traffic, v, plan_a)
        free = not runs_aground(paths[-1], models[v], traffic.land, traffic.pitch)
        if free and conflict(paths[-1], paths[u], models[v], models[u], -KEEP_M) == NONE:
            take_plan(traffic, u, plan_b)
            take_plan(traffic, v, plan_a)
            a.stuck = PASSING
            return True
    try_plan(traffic, u, plan_of(b))
    keep_path(traffic, u)
    return False


@kernel
def goes_on(traffic: Traffic, v: int) -> bool:
    """Let vessel `v` go straight on or keep its last plan, if free; True if it can."""
    s = traffic.fleet[v]
    planned = s.via != 0.0 or s.wait > s.clock
    try_plan(traffic, v, straight_on(s))
    first, _ = first_conflict(traffic, v, True, RETURN_M if planned else -KEEP_M)
    if first == NONE:
        take_plan(traffic, v, straight_on(s))
        s.stuck = 0.0
        return True
    if planned and plan_cost(traffic, v, plan_of(s), True, -KEEP_M) < BAD_S:
        keep_path(traffic, v)
        if s.stuck != PASSING:
            s.stuck = 0.0
        return True
    return False


@kernel
def plan_mover(traffic: Traffic, v: int) -> bool:
    """Choose the plan of a vessel under way; whether it has taken over another's right of way."""
    fleet = traffic.fleet
    s = fleet[v]
    if goes_on(traffic, v):
        return False
    s.stuck = 0.0
    straight = straight_on(s)
    direct = try_plan(traffic, v, straight)
    first, _ = first_conflict(traffic, v, True, -KEEP_M)
    cost, plan = search_detour(traffic, v, max(first, 0), True)
    if cost > min(direct + PATIENCE_S, BAD_S):
        try_plan(traffic, v, straight)
        first, other = first_conflict(traffic, v, False, -KEEP_M)
        if first == NONE:
            cost, plan = direct, straight  # the vessel that rests there makes room
        elif cost > BAD_S:
            if s.promoted == 0.0:
                s.rank, fleet[other].rank = fleet[other].rank, s.rank
                s.promoted = 1.0
                return True
            if fleet[other].rank < NEVER_S and pass_each_other(traffic, v, other):
                return False
            cost, plan = search_detour(traffic, v, first, False)
    s.stuck = 1.0 if cost > BAD_S else 0.0
    take_plan(traffic, v, plan)
    return False


@kernel
def plan_resting(traffic: Traffic, v: int) -> None:
    """Choose the place of a vessel that stays: its target, or beside it to let others pass."""
    s = traffic.fleet[v]
    x, y = s.target_x, s.target_y
    best_x, best_y = x, y
    here = Plan(math.nan, math.nan, 0.0, x, y)
    if plan_cost(traffic, v, here, False, 0.0) > BAD_S:
        best_x, best_y = s.place_x, s.place_y
        best = plan_cost(traffic, v, Plan(math.nan, math.nan, 0.0, best_x, best_y), False, 0.0)
        for reach in RINGS_M:
            for side in range(8):
                angle = 0.25 * math.pi * side
                to_x, to_y = x + reach * math.cos(angle), y + reach * math.sin(angle)
                there = Plan(math.nan, math.nan, 0.0, to_x, to_y)
                cost = reach + plan_cost(traffic, v, there, False, 0.0)
                if cost < best - 0.01:
                    best, best_x, best_y = cost, to_x, to_y
    changed = best_x != s.place_x or best_y != s.place_y
    s.place_x, s.place_y = best_x, best_y
    if changed and distance_to(s, best_x, best_y) > 0.5:
        start_transit(s, traffic.models[v], best_x, best_y, False)


@kernel
def is_alone(traffic: Traffic, v: int) -> bool:
    """True if no way meets that of vessel `v`."""
    return not traffic.met[v].any()


@kernel
def plan_in_order(traffic: Traffic) -> bool:
    """Plan vessel after vessel by rank; stops and returns True where ranks have changed."""
    fleet = traffic.fleet
    n, last = fleet.shape[0], -1e18
    for _ in range(n):
        v, rank = NONE, 1e18
        for u in range(n):
            if last < fleet[u].rank < rank:
                v, rank = u, fleet[u].rank
        last = rank
        if v == NONE or is_alone(traffic, v):
            continue
        if rank >= NEVER_S:
            plan_resting(traffic, v)
        elif plan_mover(traffic, v):
            return True
    return False


@kernel
def go_alone(s: VesselState, p: ModelRecord) -> None:
    """Clear the plan of a vessel that meets no other."""
    s.wait = s.stuck = 0.0
    away = s.place_x != s.target_x or s.place_y != s.target_y
    s.place_x, s.place_y = s.target_x, s.target_y
    if s.via != 0.0 or (away and s.mode == TRANSIT):
        start_transit(s, p, s.target_x, s.target_y, False)


@kernel
def plan_fleet(traffic: Traffic) -> None:
    """Choose the plans of all vessels of one episode."""
    fleet, models, met = traffic.fleet, traffic.models, traffic.met
    n, some = fleet.shape[0], False
    for i in range(n):
        met[i, i] = 0.0
        for j in range(i):
            near = ways_meet(fleet, models, i, j)
            met[i, j] = met[j, i] = 1.0 if near else 0.0
            some = some or near
    for v in range(n):
        if is_alone(traffic, v):
            go_alone(fleet[v], models[v])
        elif fleet[v].mode == HOLD or fleet[v].stuck != 0.0 or fleet[v].rank >= NEVER_S:
            try_plan(
                traffic, v, plan_of(fleet[v])
            )  # others are checked against these before they plan
            keep_path(traffic, v)
    for _ in range(n + 1):
        if not some or not plan_in_order(traffic):
            break
