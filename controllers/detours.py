"""Plans of one vessel: straight on, waiting, or a detour through a point; their costs."""

import math
from typing import NamedTuple

import numpy as np

from mjforage.base.compiled import kernel
from mjforage.controllers.conflicts import NONE, Traffic, first_conflict, runs_aground
from mjforage.controllers.prediction import NEVER_S, SAMPLE_S, SAMPLES, predict
from mjforage.controllers.state import VesselState
from mjforage.controllers.vessel_model import FloatArray

CONFLICT_S = 60.0  # cost of a plan with a conflict, less the later it is
AGROUND_S = 30.0  # cost of a plan that comes too near a quay
BAD_S = 30.0  # a plan that costs more has one of these


class Plan(NamedTuple):
    """A vessel's way until it plans again."""

    via_x: float  # point to pass first [m]; NaN for none
    via_y: float
    wait_s: float  # before it goes on, at the via point or, without one, where it is
    end_x: float  # where it goes [m]
    end_y: float


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
def straight_on(s: VesselState) -> Plan:
    """The plan without a detour."""
    return Plan(math.nan, math.nan, 0.0, s.place_x, s.place_y)


@kernel
def try_plan(traffic: Traffic, v: int, plan: Plan) -> float:
    """Predict a plan of vessel `v` into the last path; time of arrival [s], or `NEVER_S`."""
    path = traffic.paths[traffic.models.shape[0]]
    return predict(
        traffic.fleet[v],
        traffic.models[v],
        plan.via_x,
        plan.via_y,
        plan.wait_s,
        plan.end_x,
        plan.end_y,
        path,
    )


@kernel
def plan_cost(traffic: Traffic, v: int, plan: Plan, heed_resting: bool, extra: float) -> float:
    """Cost [s] of a plan of vessel `v`, which is left in the last path."""
    path = traffic.paths[traffic.models.shape[0]]
    cost = try_plan(traffic, v, plan)
    if cost == NEVER_S:
        dx, dy = plan.end_x - path[SAMPLES - 1, 0], plan.end_y - path[SAMPLES - 1, 1]
        cost = SAMPLES * SAMPLE_S + math.sqrt(dx * dx + dy * dy)
    k, _ = first_conflict(traffic, v, heed_resting, extra)
    if k != NONE:
        cost += CONFLICT_S - 2.0 * k * SAMPLE_S
    if runs_aground(path, traffic.models[v], traffic.land, traffic.pitch):
        cost += AGROUND_S
    return cost


@kernel
def search_detour(traffic: Traffic, v: int, first: int, heed_resting: bool) -> tuple[float, Plan]:
    """Cheapest plan around a conflict at sample `first` of the last path, and its cost [s]."""
    s = traffic.fleet[v]
    path = traffic.paths[traffic.models.shape[0]]
    at_x, at_y = path[first, 0], path[first, 1]
    best, cheapest = straight_on(s), 1e9
    dx, dy = best.end_x - s.x, best.end_y - s.y
    far = max(math.sqrt(dx * dx + dy * dy), 1e-6)
    dx, dy = dx / far, dy / far
    meeting = min(max((at_x - s.x) * dx + (at_y - s.y) * dy, 0.3), far + 0.5)
    for i in range(DETOURS.shape[0]):
        anchored, along, aside, wait = DETOURS[i]
        x = y = math.nan
        if anchored >= 0.0:
            along += anchored * meeting
            x, y = s.x + along * dx - aside * dy, s.y + along * dy + aside * dx
        plan = Plan(x, y, wait, best.end_x, best.end_y)
        cost = plan_cost(traffic, v, plan, heed_resting, 0.0)
        if cost < cheapest:
            best, cheapest = plan, cost
    return cheapest, best
