"""Making tracks agree with the counts now in view.

They are confirmed where the counts agree, else moved to the nearest place that lacks one, within a
gate that grows with the time unseen; the rest was collected by a vessel, is overlooked, is pushed
out of sight or given up, and a count without a track is a new track. For a delayed scan, tracks
that were seen since account for counts too, but are neither moved nor given up.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary
from mjforage.graph_planner.belief_planner.missed_detections import MissedDetections, missed
from mjforage.graph_planner.belief_planner.tracks import (
    CERTAIN,
    ENDED,
    Ended,
    Lost,
    Tracks,
    begin,
    confirm,
    drop,
    lose,
)
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.walls import INSET
from mjforage.mission.sensors.detection import real_if_missed, real_if_new, real_if_seen

FIRST_GATE = 1.3  # distance of a plain mistake: a node and a bit [node]
IN_VIEW_GATE = 2.3  # between two places in view [node]
HIDING = 1.5  # farthest that a track is pushed out of sight [node]
CATCH_GATE = 2.0  # from a forager's node to a track that it may have taken [node]
MOST_LACKING = 256  # new sightings taken in at once


class View(NamedTuple):
    """The view of the fleet."""

    now: int  # step
    belief: NDArray[np.int16]  # (node,) items, right where the node is in view
    last_seen: NDArray[np.int16]  # (node,) step, `now` where the node is in view


class Doubts(NamedTuple):
    """Missed detections and false positives of a view; see `missed_detections`."""

    missed_detections: MissedDetections
    false_rate: float  # items per node and step that are seen and are none
    expected: NDArray[np.float64]  # (node,) unseen items before the view
    least: float  # of them that may be anywhere


class Catch(NamedTuple):
    """Items that vessels collected in the step just made; none where collecting is certain.

    What is not seen in their own nodes has not just gone out of sight.
    """

    at: Int32Array  # (forager,) node in which each is now
    left: NDArray[np.int64]  # (forager,) items not yet found among the tracks; counted down


@kernel
def _squared(boundary: Boundary, node: int, row: float, col: float) -> float:
    """Squared distance of a place to the centre of a node [node^2]."""
    return float((boundary.rows[node] - row) ** 2 + (boundary.cols[node] - col) ** 2)


@kernel
def _loosen(
    tracks: Tracks, boundary: Boundary, e: int, view: View, tracked: NDArray[np.int16]
) -> NDArray[np.bool_]:
    """Surplus tracks (track,) of nodes in view: those farthest from the middle."""
    n, node = tracks.number[e], tracks.node[e]
    loose = np.zeros(n, np.bool_)
    for i in range(n):
        tracked[node[i]] += view.last_seen[node[i]] == view.now
    for i in range(n):
        here = node[i]
        while tracked[here] > view.belief[here] and view.last_seen[here] == view.now:
            worst, far = -1, -1.0
            for k in range(n):
                if node[k] == here and not loose[k] and not tracks.firm[e, k]:
                    away = _squared(boundary, here, tracks.row[e, k], tracks.col[e, k])
                    if away > far:
                        worst, far = k, away
            tracked[here] -= 1
            if worst < 0:
                tracked[here] = view.belief[here]
                break
            loose[worst] = True
    return loose


@kernel
def _lacks(
    tracks: Tracks, e: int, view: View, tracked: NDArray[np.int16]
) -> tuple[Int32Array, int]:
    """Nodes in view with too few tracks, once per item that lacks one, and how many they are.

    Clears `tracked`.
    """
    lacking, number = np.empty(MOST_LACKING, np.int32), 0
    for node in range(view.last_seen.size):
        if view.last_seen[node] == view.now and view.belief[node] > tracked[node]:
            for _ in range(view.belief[node] - tracked[node]):
                if number < lacking.size:
                    lacking[number] = node
                    number += 1
    for i in range(tracks.number[e]):
        tracked[tracks.node[e, i]] = 0
    return lacking, number


@kernel
def _nearest_lack(
    tracks: Tracks,
    boundary: Boundary,
    e: int,
    now: int,
    wander: float,
    free: NDArray[np.bool_],
    loose: NDArray[np.bool_],
    lacking: Int32Array,
) -> tuple[int, int]:
    """The free track and the lack (its number) that are nearest within the track's gate, or -1."""
    best, best_track, best_lack = np.inf, -1, -1
    for i in range(free.size):
        if not free[i]:
            continue
        gate = FIRST_GATE + wander * abs(now - tracks.seen[e, i])
        gate = max(gate, IN_VIEW_GATE) if loose[i] else gate
        for j in range(lacking.size):
            away = _squared(boundary, lacking[j], tracks.row[e, i], tracks.col[e, i])
            if away < best and away <= gate * gate:
                best, best_track, best_lack = away, i, j
    return best_track, best_lack


@kernel
def _hide(
    tracks: Tracks, boundary: Boundary, neighbours: Int32Array, e: int, i: int, view: View
) -> bool:
    """Push a track into the nearest node beside it that is out of sight; False if there is none."""
    row, col, hidden, nearest = tracks.row[e, i], tracks.col[e, i], -1, HIDING**2
    for direction in range(8):
        other = neighbours[tracks.node[e, i], direction]
        if other >= 0 and view.last_seen[other] != view.now:
            away = _squared(boundary, other, row, col)
            if away < nearest:
                hidden, nearest = other, away
    if hidden >= 0:
        r, c = float(boundary.rows[hidden]), float(boundary.cols[hidden])
        tracks.row[e, i] = min(max(row, r - INSET), r + INSET)
        tracks.col[e, i] = min(max(col, c - INSET), c + INSET)
        tracks.node[e, i] = hidden
    return hidden >= 0


@kernel
def _caught(tracks: Tracks, boundary: Boundary, e: int, i: int, catch: Catch) -> bool:
    """True if a track that is not where it should be can be an item that a forager took."""
    for f in range(catch.at.size):
        away = _squared(boundary, catch.at[f], tracks.row[e, i], tracks.col[e, i])
        if catch.left[f] > 0 and away <= CATCH_GATE**2:
            catch.left[f] -= 1
            return True
    return False


@kernel
def _seen(tracks: Tracks, e: int, i: int, node: int, now: int, doubts: Doubts) -> None:
    """Be more certain of a track that is confirmed."""
    if doubts.false_rate > 0.0:
        chance = 1.0 - missed(doubts.missed_detections, e, now, node)
        tracks.real[e, i] = real_if_seen(tracks.real[e, i], chance, doubts.false_rate)
    else:
        tracks.real[e, i] = 1.0


@kernel
def _is_overlooked(tracks: Tracks, e: int, i: int, now: int, doubts: Doubts) -> bool:
    """Be less certain of a track that is not shown; whether it may still be there."""
    chance = 1.0 - missed(doubts.missed_detections, e, now, tracks.node[e, i])
    real = real_if_missed(min(CERTAIN, tracks.real[e, i]), chance)
    if real >= ENDED:
        tracks.real[e, i] = real
    return real >= ENDED


@kernel
def _is_real(
    tracks: Tracks, neighbours: Int32Array, e: int, i: int, now: int, doubts: Doubts
) -> bool:
    """Weigh a new track against what was expected around it; whether it is worth keeping."""
    if doubts.false_rate == 0.0:
        return True
    node, expected = tracks.node[e, i], doubts.expected
    density = max(doubts.least, expected[node])
    for direction in range(8):
        if neighbours[node, direction] >= 0:
            density = max(density, expected[neighbours[node, direction]])
    chance = 1.0 - missed(doubts.missed_detections, e, now, node)
    tracks.real[e, i] = real_if_new(density, chance, doubts.false_rate)
    return bool(tracks.real[e, i] >= ENDED)


@kernel
def _has(nodes: Int32Array, node: int) -> bool:
    """True if a node is among others."""
    found = False
    for other in nodes:
        found |= other == node
    return found


@kernel
def reconcile(
    tracks: Tracks,
    boundary: Boundary,
    neighbours: Int32Array,
    e: int,
    view: View,
    wander: float,
    catch: Catch,
    doubts: Doubts,
    tracked: NDArray[np.int16],
    ways: Ended,
    lost: Lost,
) -> int:
    """Make the tracks agree with the counts in view.

    Returns: new tracks; they are the last ones.

    Parameters
    ----------
    neighbours : (node, 8) int32
    e : episode
    wander : how uncertain an unseen track gets [node/step]
    catch : what foragers have taken
    doubts : what the view may have missed or invented
    tracked : (node,) scratch, 0 between calls
    ways, lost : displacements that ended and items given up, added to
    """
    n, now = tracks.number[e], view.now
    loose = _loosen(tracks, boundary, e, view, tracked)
    lacking, lacks = _lacks(tracks, e, view, tracked)
    settled_now = np.zeros(n, np.bool_)
    for i in range(n):
        if not loose[i] and view.last_seen[tracks.node[e, i]] == now:
            if not tracks.firm[e, i]:
                confirm(tracks, boundary, e, i, tracks.node[e, i], now, ways)
                _seen(tracks, e, i, tracks.node[e, i], now, doubts)
            settled_now[i] = True
    # Loose tracks, then unseen ones, go to the nearest lack within their gates.
    for unseen_too in range(2):
        while lacks > 0:
            free = ~settled_now if unseen_too else loose & ~settled_now
            i, j = _nearest_lack(tracks, boundary, e, now, wander, free, loose, lacking[:lacks])
            if i < 0:
                break
            if not tracks.firm[e, i]:
                confirm(tracks, boundary, e, i, lacking[j], now, ways)
                _seen(tracks, e, i, lacking[j], now, doubts)
            settled_now[i] = True
            lacks -= 1
            lacking[j] = lacking[lacks]
    # What is still loose was taken, is overlooked, is just out of sight, or was a mistake.
    for i in range(n - 1, -1, -1):
        if not loose[i] or settled_now[i]:
            continue
        if _caught(tracks, boundary, e, i, catch):
            drop(tracks, boundary, e, i, ways)
        elif _is_overlooked(tracks, e, i, now, doubts):
            continue
        elif _has(catch.at, tracks.node[e, i]) or not _hide(
            tracks, boundary, neighbours, e, i, view
        ):
            lose(tracks, e, i, lost)
            drop(tracks, boundary, e, i, ways)
    new = 0
    for j in range(lacks):
        if not begin(tracks, boundary, e, lacking[j], now, ways):
            break
        new += 1
        if not _is_real(tracks, neighbours, e, tracks.number[e] - 1, now, doubts):
            drop(tracks, boundary, e, tracks.number[e] - 1, ways)
            new -= 1
    return new
