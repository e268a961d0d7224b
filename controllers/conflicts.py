"""Who comes too near whom: ways that meet, and conflicts between predicted paths."""

from typing import NamedTuple

from controllers._compiled import kernel
from controllers.boxes import box_gap, circle_radius
from controllers.chart import LandArray, quay_gap
from controllers.helm import BEAM, CLEARANCE, LENGTH, FloatArray
from controllers.prediction import SAMPLE_S, SAMPLES
from controllers.state import (
    END_X,
    END_Y,
    HOLD,
    MODE,
    PLACE_X,
    PLACE_Y,
    RANK,
    STUCK,
    TARGET_X,
    TARGET_Y,
    VIA,
    X,
    Y,
)

GROWTH_MPS = 0.04  # of the margin with time, for what is not foreseen
MOST_GROWTH_M = 0.2
BESIDE_M = 0.1  # margin over the hulls' clearance
NEAR_M = 1.0  # hulls whose ways come nearer than this are looked at
NONE = -1


class Traffic(NamedTuple):
    """One episode as planning sees it."""

    fleet: FloatArray  # (vessel, state.SIZE)
    helms: FloatArray  # (vessel, helm.SIZE) of `packed`
    paths: FloatArray  # (vessel + 1, SAMPLES, 4) predictions; the last is being tried
    met: FloatArray  # (vessel, vessel) 1 where ways meet
    land: LandArray  # of a `Chart`
    pitch: float  # [m]


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
        gap = box_gap(dx, dy, a[k, 2], a[k, 3], long_a, wide_a, b[k, 2], b[k, 3], long_b, wide_b)
        if k == 0:
            most = min(clear, gap - 0.02)  # who is too near already must not come nearer
            continue
        growth = min(GROWTH_MPS * k * SAMPLE_S, MOST_GROWTH_M) if most == clear else 0.0
        if gap < most + growth:
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
def heeds(traffic: Traffic, v: int, u: int, heed_resting: bool) -> bool:
    """Whether vessel `v` plans around `u`: who rests, goes first, or knows no way itself."""
    fleet = traffic.fleet
    if u == v or traffic.met[v, u] == 0.0:
        return False
    if fleet[u, MODE] == HOLD:
        return heed_resting
    return bool(fleet[u, RANK] < fleet[v, RANK] or fleet[u, STUCK] != 0.0)


@kernel
def first_conflict(traffic: Traffic, v: int, heed_resting: bool, extra: float) -> tuple[int, int]:
    """Earliest conflict of the path being tried for vessel `v`: sample and vessel, or `NONE`."""
    first, other = NONE, NONE
    paths, helms = traffic.paths, traffic.helms
    n = helms.shape[0]
    for u in range(n):
        if not heeds(traffic, v, u, heed_resting):
            continue
        k = conflict(paths[n], paths[u], helms[v], helms[u], extra)
        if k != NONE and (first == NONE or k < first):
            first, other = k, u
    return first, other
