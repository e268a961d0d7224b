"""Ways that meet, and conflicts between predicted paths."""

from typing import NamedTuple

from mjforage.base.compiled import kernel
from mjforage.controllers.boxes import box_gap, circle_radius
from mjforage.controllers.chart import LandArray, quay_gap
from mjforage.controllers.prediction import SAMPLE_S, SAMPLES
from mjforage.controllers.state import HOLD, FleetArray, VesselState
from mjforage.controllers.vessel_model import FloatArray, ModelArray, ModelRecord

GROWTH_MPS = 0.04  # of the margin with time, for what is not foreseen
MOST_GROWTH_M = 0.2  # at most
BESIDE_M = 0.1  # margin over the vessels' clearance
NEAR_M = 1.0  # vessels whose ways come nearer than this are looked at
NONE = -1  # no vessel, no sample


class Traffic(NamedTuple):
    """One episode as planning sees it."""

    fleet: FleetArray  # (vessel,)
    models: ModelArray  # (vessel,)
    paths: FloatArray  # (vessel + 1, SAMPLES, 4) predictions; the last is being tried
    met: FloatArray  # (vessel, vessel) 1 where ways meet
    land: LandArray  # of a `Chart`
    pitch: float  # [m]


@kernel
def way_box(s: VesselState) -> tuple[float, float, float, float]:
    """West, east, south and north end of where a vessel is, goes and passes [m]."""
    west, east = min(min(s.x, s.place_x), s.target_x), max(max(s.x, s.place_x), s.target_x)
    south, north = min(min(s.y, s.place_y), s.target_y), max(max(s.y, s.place_y), s.target_y)
    if s.via != 0.0:
        west, east = min(west, s.end_x), max(east, s.end_x)
        south, north = min(south, s.end_y), max(north, s.end_y)
    return west, east, south, north


@kernel
def ways_meet(fleet: FleetArray, models: ModelArray, i: int, j: int) -> bool:
    """True if the boxes around the ways of two vessels come near each other."""
    room = NEAR_M + circle_radius(models[i].length_m, models[i].beam_m)
    room += circle_radius(models[j].length_m, models[j].beam_m)
    west_a, east_a, south_a, north_a = way_box(fleet[i])
    west_b, east_b, south_b, north_b = way_box(fleet[j])
    beside = west_a - room > east_b or west_b - room > east_a
    return not (beside or south_a - room > north_b or south_b - room > north_a)


@kernel
def conflict(
    a: FloatArray, b: FloatArray, model_a: ModelRecord, model_b: ModelRecord, extra: float
) -> int:
    """First sample at which two predicted vessels are too near each other, or `NONE`.

    Parameters
    ----------
    a, b : (SAMPLES, 4) of `predict`
    extra : margin over the usual one [m]
    """
    long_a, wide_a = 0.5 * model_a.length_m, 0.5 * model_a.beam_m
    long_b, wide_b = 0.5 * model_b.length_m, 0.5 * model_b.beam_m
    clear = max(model_a.clearance_m, model_b.clearance_m) + BESIDE_M + extra
    far = long_a + wide_a + long_b + wide_b + clear + MOST_GROWTH_M
    most = clear
    for k in range(SAMPLES):
        dx, dy = b[k, 0] - a[k, 0], b[k, 1] - a[k, 1]
        if abs(dx) > far or abs(dy) > far:
            continue
        gap = box_gap(dx, dy, a[k, 2], a[k, 3], long_a, wide_a, b[k, 2], b[k, 3], long_b, wide_b)
        if k == 0:
            most = min(clear, gap - 0.02)  # one that is too near already must not come nearer
            continue
        growth = min(GROWTH_MPS * k * SAMPLE_S, MOST_GROWTH_M) if most == clear else 0.0
        if gap < most + growth:
            return k
    return NONE


@kernel
def runs_aground(a: FloatArray, p: ModelRecord, land: LandArray, pitch: float) -> bool:
    """True if a predicted vessel comes too near a quay."""
    long, wide, least = 0.5 * p.length_m, 0.5 * p.beam_m, p.clearance_m
    for k in range(0, SAMPLES, 2):
        gap = quay_gap(land, pitch, a[k, 0], a[k, 1], a[k, 2], a[k, 3], long, wide, least)
        if k == 0:
            least = min(least, gap - 0.02)
        elif gap < least:
            return True
    return False


@kernel
def heeds(traffic: Traffic, v: int, u: int, heed_resting: bool) -> bool:
    """True if vessel `v` plans around `u`: `u` rests, goes first, or knows no way itself."""
    fleet = traffic.fleet
    if u == v or traffic.met[v, u] == 0.0:
        return False
    if fleet[u].mode == HOLD:
        return heed_resting
    return bool(fleet[u].rank < fleet[v].rank or fleet[u].stuck != 0.0)


@kernel
def first_conflict(traffic: Traffic, v: int, heed_resting: bool, extra: float) -> tuple[int, int]:
    """Earliest conflict of the path being tried for vessel `v`: sample and vessel, or `NONE`."""
    first, other = NONE, NONE
    paths, models = traffic.paths, traffic.models
    n = models.shape[0]
    for u in range(n):
        if not heeds(traffic, v, u, heed_resting):
            continue
        k = conflict(paths[n], paths[u], models[v], models[u], extra)
        if k != NONE and (first == NONE or k < first):
            first, other = k, u
    return first, other
