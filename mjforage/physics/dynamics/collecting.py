"""Collecting: the item that each forager seeks, items that enter its mouth, and giving up.

An attempt at an item has failed when the bow was near it and is away from it again without having
taken it. After `ATTEMPTS` of them the item is left for `LATER_S`; others are sought instead.

Vessels turn slowly: half round takes a forager a whole period of 10 s. What is left of a period
goes into turning to the next item, and its bow takes what it reaches beyond its node.
"""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.base.device import Launch
from mjforage.base.errors import UserError
from mjforage.controllers.chart import is_land
from mjforage.mission.dynamics import Transition
from mjforage.mission.task import IDLE, MISSED, TAKEN, UNREACHABLE
from mjforage.physics.dynamics.tracks import RADIUS_M, LandGrid
from mjforage.scenario.capture import BESIDE_M
from mjforage.scenario.scenario import Physics

MOUTH_DEPTH_M = 0.3  # how far behind the bow the mouth reaches, and the item's radius ahead of it
MOUTH_REACH_M = 0.12  # an item of radius 0.1 m that touches the bow is in
ATTEMPTS = 2  # that may fail before an item is left for later
NEAR_M, AWAY_M = 0.6, 1.2  # from the middle of the bow: an attempt begins, and has failed
LATER_S = 60.0  # until an item that was given up is sought again
STANDS = 0.42  # of a node's side: farthest that midships goes from its middle to take one beside it
_ROUNDING_S = 1e-9  # of times that are sums of pauses
READY_M = 9.0  # farthest item that a vessel gets ready for: a little more than two nodes of 4 m
FloatArray = NDArray[np.float64]


class Attempts(NamedTuple):
    """Items that foragers seek, and their failed attempts."""

    item: NDArray[np.int64]  # (episode, vessel) sought now, -1 none
    near: NDArray[np.bool_]  # (episode, vessel) whether the bow has been near it since
    failed: NDArray[np.int8]  # (episode, vessel, item) attempts that failed
    later_s: FloatArray  # (episode, vessel, item) time from which it is sought again [s]

    @classmethod
    def of(cls, vessels: int, items: NDArray[np.int32]) -> Self:
        """Attempts before any item was sought, of `items` (episode, item)."""
        pairs = (items.shape[0], vessels)
        every = (*pairs, items.shape[1])
        return cls(
            np.full(pairs, -1), np.zeros(pairs, np.bool_), np.zeros(every, np.int8), np.zeros(every)
        )


class Sent(NamedTuple):
    """Orders of a decision."""

    node_xy: FloatArray  # (episode, vessel, 2) centre of the node [m]
    stay: NDArray[np.bool_]  # (episode, vessel) whether it is the node where they are


class Goal(NamedTuple):
    """Items for the pilots."""

    xy: FloatArray  # (episode, vessel, 2) item to pick up, NaN for none [m]
    next: FloatArray  # (episode, vessel, 2) with none: the one to be ready for, NaN for none [m]
    look: NDArray[np.bool_]  # (episode, vessel) with neither: whether to look round for one

    @classmethod
    def of(cls, episodes: int, vessels: int) -> Self:
        """Goals with nothing to do."""
        pairs = (episodes, vessels)
        xy, following = np.full((*pairs, 2), np.nan), np.full((*pairs, 2), np.nan)
        return cls(xy, following, np.zeros(pairs, np.bool_))


class Mouths(NamedTuple):
    """Mouths that take one item after the other."""

    pause_s: float  # from one item to the next [s]; 0: all that are in a mouth are taken at once
    jam_items: int  # in a mouth beyond the one that it takes, with which it jams; 0: never
    jam_s: float  # for which it then takes none
    tick_s: float  # between two calls of `collect_at_mouth`
    ready_s: FloatArray  # (episode, vessel) time from which it takes the next one [s]

    def of(self, episodes: int) -> Self:
        """The same ones, with nothing taken in so many episodes."""
        return self._replace(ready_s=np.zeros((episodes, self.ready_s.shape[1])))


def mouths_of(physics: Physics, vessels: int, tick_s: float) -> Mouths:
    """Mouths of a scenario's vessels, in no episode yet.

    Raises `UserError` if items without bodies shall enter one.
    """
    if physics.capture == "intake" and physics.items != "bodies":
        raise UserError(
            f"physics.capture = 'intake' with physics.items = {physics.items!r}: items without "
            "bodies enter no mouth; set physics.capture=node or physics.items=bodies"
        )
    rate = physics.intake_rate_per_s
    pause_s = 0.0 if rate is None else 1.0 / rate
    none = np.zeros((0, vessels))
    return Mouths(pause_s, physics.intake_jam_items, physics.intake_jam_s, tick_s, none)


class Reach(NamedTuple):
    """Collectors, their sizes and the land around them."""

    collects: NDArray[np.bool_]  # (vessel,)
    size: FloatArray  # (vessel, 2) half length, half beam [m]
    grid: LandGrid
    narrow: bool  # whether they have cameras that do not see all round


@inlined
def _within(reach: Reach, node_xy: FloatArray, x: float, y: float) -> bool:
    """True if a place lies within the square of a node."""
    return bool(max(abs(x - node_xy[0]), abs(y - node_xy[1])) <= 0.5 * reach.grid.pitch_m)


@inlined
def _within_reach(
    reach: Reach, half: float, pose: FloatArray, node_xy: FloatArray, x: float, y: float
) -> bool:
    """True if a vessel can take an item beside its node with midships well within the node.

    Across one side only: a corner of the node may be one of land. Not at a quay: there a vessel
    does not come in as the item bears.
    """
    land, pitch = reach.grid.land, reach.grid.pitch_m
    if min(abs(x - node_xy[0]), abs(y - node_xy[1])) > 0.5 * pitch:
        return False
    for side in (-BESIDE_M, BESIDE_M):
        if is_land(land, pitch, x + side, y) or is_land(land, pitch, x, y + side):
            return False
    dx, dy = x - pose[0], y - pose[1]
    short = (half + RADIUS_M) / max(math.hypot(dx, dy), half + RADIUS_M)
    off_x, off_y = x - short * dx - node_xy[0], y - short * dy - node_xy[1]
    return bool(max(abs(off_x), abs(off_y)) < STANDS * pitch)


@inlined
def _note_attempt(
    attempts: Attempts,
    e: int,
    v: int,
    away_m: float,
    now_s: float,
    own: bool,
    pickup: NDArray[np.int8],
) -> None:
    """Note how far the bow is from the item sought; two failed attempts end the search for it.

    `own`: True if it lies in the vessel's own node: only then the result is reported.
    """
    k = attempts.item[e, v]
    if attempts.near[e, v] and away_m > AWAY_M:
        attempts.near[e, v] = False
        attempts.failed[e, v, k] += 1
        if attempts.failed[e, v, k] >= ATTEMPTS:
            attempts.failed[e, v, k], attempts.later_s[e, v, k] = 0, now_s + LATER_S
            if own and pickup[e, v] != TAKEN:
                pickup[e, v] = UNREACHABLE


@inlined
def _choose(
    reach: Reach,
    half: float,
    pose: FloatArray,
    node_xy: FloatArray,
    xy: FloatArray,
    item_node: NDArray[np.int32],
    later_s: FloatArray,
    now_s: float,
) -> tuple[int, int, int, bool]:
    """The nearest item in the vessel's node, of those within reach beside it, and of all others.

    Parameters
    ----------
    half : length of the vessel [m]
    pose : (3,); node_xy : (2,); xy : (item, 2); item_node, later_s : (item,)

    Returns
    -------
    Their numbers, -1 for none, and whether it knows of any, even of one to be left for later
    """
    own, beside, other = -1, -1, -1
    own_m = beside_m = other_m = np.inf
    knows = False
    for k in range(item_node.size):
        x, y = xy[k, 0], xy[k, 1]
        if item_node[k] < 0 or math.isnan(x):
            continue
        knows = True
        if now_s < later_s[k]:
            continue
        away = math.hypot(x - pose[0], y - pose[1])
        if _within(reach, node_xy, x, y):
            if away < own_m:
                own, own_m = k, away
        elif _within_reach(reach, half, pose, node_xy, x, y):
            if away < beside_m:
                beside, beside_m = k, away
        elif away < min(other_m, READY_M):
            other, other_m = k, away
    return own, beside, other, knows


@kernel
def seek(
    reach: Reach,
    attempts: Attempts,
    active: NDArray[np.bool_],
    room_left: NDArray[np.int64],
    pose: FloatArray,
    xy: FloatArray,
    sent: Sent,
    now_s: FloatArray,
    state: Transition,
    goal: Goal,
) -> None:
    """Choose for each forager: collect, get ready, or look round.

    It collects the nearest item within the square of its target node, else the nearest beside it
    that its bow reaches. With none it gets ready for the nearest other one. A forager whose order
    is to stay, and that knows of no item, looks round, if its camera does not do that by itself.

    Parameters
    ----------
    room_left : (episode, vessel) items
    pose : (episode, vessel, 3)
    xy : (episode, vessel, item, 2) where each vessel takes items to be, NaN if it knows none [m]
    now_s : (episode,) [s]
    state : `pickup` is written: result of collecting in the target node
    goal : written
    """
    goal.xy[:], goal.next[:], goal.look[:] = np.nan, np.nan, False
    item_node, pickup = state.item_node, state.pickup
    for e in range(active.size):
        if not active[e]:
            continue
        for v in range(reach.collects.size):
            if not reach.collects[v] or room_left[e, v] <= 0:
                continue
            half, places, node_xy = reach.size[v, 0], xy[e, v], sent.node_xy[e, v]
            bow_x = pose[e, v, 0] + half * math.cos(pose[e, v, 2])
            bow_y = pose[e, v, 1] + half * math.sin(pose[e, v, 2])
            sought = attempts.item[e, v]
            if sought >= 0 and item_node[e, sought] >= 0:
                x, y = places[sought]
                away, mine = math.hypot(x - bow_x, y - bow_y), _within(reach, node_xy, x, y)
                _note_attempt(attempts, e, v, away, now_s[e], mine, pickup)
            later_s = attempts.later_s[e, v]
            own, beside, other, knows = _choose(
                reach, half, pose[e, v], node_xy, places, item_node[e], later_s, now_s[e]
            )
            best = own if own >= 0 else beside
            if best != sought:
                attempts.item[e, v], attempts.near[e, v] = best, False
            if best >= 0:
                x, y = places[best]
                attempts.near[e, v] |= math.hypot(x - bow_x, y - bow_y) < NEAR_M
                goal.xy[e, v, 0], goal.xy[e, v, 1] = x, y
            elif other >= 0:
                goal.next[e, v, 0], goal.next[e, v, 1] = places[other]
            elif reach.narrow and not knows:
                goal.look[e, v] = sent.stay[e, v] and pickup[e, v] == IDLE
            if own >= 0 and pickup[e, v] == IDLE:
                pickup[e, v] = MISSED


@kernel
def collect_at_mouth(
    reach: Reach,
    active: NDArray[np.bool_],
    pose: FloatArray,
    xy: FloatArray,
    room_left: NDArray[np.int64],
    state: Transition,
    mouths: Mouths,
    now_s: FloatArray,
) -> int:
    """Capture rule `intake`: an item in a forager's mouth is taken, while there is room.

    The mouth is as wide as the vessel, at the bow. With a pause it takes items one after the other,
    and the hull pushes those that wait. If too many wait when it takes one, it jams.

    Returns: how many items were taken.

    Parameters
    ----------
    pose : (episode, vessel, 3); xy : (episode, item, 2) [m]
    mouths : `ready_s` is written
    now_s : (episode,) [s]
    """
    collects, size, ready_s = reach.collects, reach.size, mouths.ready_s
    item_node, collected_by, taken = state.item_node, state.collected_by, 0
    for e in range(active.size):
        if not active[e]:
            continue
        for agent in range(collects.size):
            if not collects[agent]:
                continue
            c, s = math.cos(pose[e, agent, 2]), math.sin(pose[e, agent, 2])
            bow, half = size[agent, 0], size[agent, 1]
            waiting, before, now = 0, taken, now_s[e] + _ROUNDING_S
            for k in range(item_node.shape[1]):
                if item_node[e, k] < 0 or room_left[e, agent] <= 0:
                    continue
                dx, dy = xy[e, k, 0] - pose[e, agent, 0], xy[e, k, 1] - pose[e, agent, 1]
                ahead, aside = c * dx + s * dy, c * dy - s * dx
                if -MOUTH_DEPTH_M <= ahead - bow <= MOUTH_REACH_M and abs(aside) <= half:
                    if ready_s[e, agent] > now:
                        waiting += 1
                        continue
                    if now - ready_s[e, agent] > mouths.tick_s:  # it was idle
                        ready_s[e, agent] = now_s[e]
                    ready_s[e, agent] += mouths.pause_s
                    item_node[e, k] = -1
                    collected_by[e, k] = agent
                    room_left[e, agent] -= 1
                    state.pickup[e, agent] = TAKEN
                    taken += 1
            if taken > before and 0 < mouths.jam_items <= waiting:
                ready_s[e, agent] = max(ready_s[e, agent], now_s[e] + mouths.jam_s)
    return taken


SEEK = Launch(seek, shared="reach")
COLLECT_AT_MOUTH = Launch(collect_at_mouth, shared="reach")
