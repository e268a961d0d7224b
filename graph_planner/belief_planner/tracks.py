"""Tracks: every item that was seen, where it must be by now, and what its way says of the drift.

Each decision the tracks are carried on and then reconciled with the counts now in view: confirmed
where the counts agree, else moved to the nearest place that lacks one, within a gate that grows
with the time unseen; what is left over is pushed out of sight or given up, and what is still
lacking is a new track.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.shore import Shore, drifted, held
from graph_planner.compiled import inlined, kernel
from graph_planner.geodesics import Int32Array
from graph_planner.walls import INSET

FIRST_GATE = 1.3  # distance of a plain mistake: a node and a bit [node]
IN_VIEW_GATE = 2.3  # between two places in view [node]
HIDING = 1.5  # farthest that a track is pushed out of sight [node]
CATCH_GATE = 2.0  # from a forager's node to a track that it may have taken [node]
MOST_LACKING = 256  # new sightings taken in at once


class Tracks(NamedTuple):
    """Tracks of a batch; those of an episode are its first `number`."""

    number: NDArray[np.int64]  # (episode,)
    row: NDArray[np.float64]  # (episode, track) [node]
    col: NDArray[np.float64]
    node: Int32Array  # (episode, track)
    born: Int32Array  # (episode, track) step of the first sighting
    seen: Int32Array  # (episode, track) step of the last sighting
    seen_node: Int32Array  # (episode, track) node of the last sighting
    base: Int32Array  # (episode, track, 2) per axis: step from which its way counts
    base_node: Int32Array  # (episode, track, 2) and its node then


class Ended(NamedTuple):
    """Ways of the tracks that a reconciliation ended or started anew, for the wind estimate."""

    number: NDArray[np.int64]  # (1,)
    axis: NDArray[np.int64]  # (way,) 0 rows, 1 columns
    shift: NDArray[np.float64]  # (way,) [node]
    steps: NDArray[np.float64]  # (way,)
    start: Int32Array  # (way,) node where it began


class Lost(NamedTuple):
    """Tracks that were given up although nobody is known to have collected the item."""

    number: NDArray[np.int64]  # (1,)
    node: Int32Array  # (loss,) of the last sighting
    step: Int32Array  # (loss,) of the last sighting


class View(NamedTuple):
    """What is in view of the fleet."""

    now: int  # step
    belief: NDArray[np.int16]  # (node,) items, right where the node is in view
    last_seen: NDArray[np.int16]  # (node,) step, `now` where the node is in view


class Catch(NamedTuple):
    """What hulls took aboard in the step just made; of nobody where collecting is certain.

    What is not seen in their own nodes has not just gone out of sight.
    """

    at: Int32Array  # (forager,) node in which each is now
    left: NDArray[np.int64]  # (forager,) items not yet found among the tracks; counted down


class Scratch(NamedTuple):
    """Memory between the parts of a reconciliation, all zero between calls."""

    tracked: NDArray[np.int16]  # (node,) tracks counted in a node


def tracks(episodes: int, capacity: int) -> Tracks:
    """Room for so many tracks in each episode."""
    both = (episodes, capacity)
    return Tracks(
        np.zeros(episodes, np.int64),
        np.zeros(both),
        np.zeros(both),
        *(np.zeros(both, np.int32) for _ in range(4)),
        *(np.zeros((*both, 2), np.int32) for _ in range(2)),
    )


def ended(capacity: int) -> Ended:
    """Room for so many ways."""
    return Ended(
        np.zeros(1, np.int64),
        np.zeros(capacity, np.int64),
        np.zeros(capacity),
        np.zeros(capacity),
        np.zeros(capacity, np.int32),
    )


def losses(capacity: int) -> Lost:
    """Room for so many losses."""
    return Lost(np.zeros(1, np.int64), np.zeros(capacity, np.int32), np.zeros(capacity, np.int32))


def scratch(nodes: int) -> Scratch:
    """Memory for a map of so many nodes."""
    return Scratch(np.zeros(nodes, np.int16))


@kernel
def _report(tracks: Tracks, shore: Shore, e: int, i: int, axis: int, ways: Ended) -> None:
    """Hand the way of a track along one axis over, from its base to its last sighting."""
    steps, n = tracks.seen[e, i] - tracks.base[e, i, axis], ways.number[0]
    if steps <= 0 or n >= ways.axis.size:
        return
    places, start = shore.rows if axis == 0 else shore.cols, tracks.base_node[e, i, axis]
    ways.axis[n], ways.steps[n], ways.start[n] = axis, float(steps), start
    ways.shift[n] = float(places[tracks.seen_node[e, i]] - places[start])
    ways.number[0] = n + 1


@kernel
def _copy(tracks: Tracks, e: int, source: int, goal: int) -> None:
    """Put a copy of track `source` in the place of track `goal`."""
    tracks.row[e, goal], tracks.col[e, goal] = tracks.row[e, source], tracks.col[e, source]
    tracks.node[e, goal], tracks.born[e, goal] = tracks.node[e, source], tracks.born[e, source]
    tracks.seen[e, goal] = tracks.seen[e, source]
    tracks.seen_node[e, goal] = tracks.seen_node[e, source]
    for axis in range(2):
        tracks.base[e, goal, axis] = tracks.base[e, source, axis]
        tracks.base_node[e, goal, axis] = tracks.base_node[e, source, axis]


@kernel
def drop(tracks: Tracks, shore: Shore, e: int, i: int, ways: Ended) -> None:
    """End track i; the last one takes its place."""
    for axis in range(2):
        _report(tracks, shore, e, i, axis, ways)
    tracks.number[e] -= 1
    _copy(tracks, e, tracks.number[e], i)


@kernel
def _lose(tracks: Tracks, e: int, i: int, lost: Lost) -> None:
    """List track i among those that were given up."""
    n = lost.number[0]
    if n < lost.node.size:
        lost.node[n], lost.step[n] = tracks.seen_node[e, i], tracks.seen[e, i]
        lost.number[0] = n + 1


@inlined
def _same_walls(shore: Shore, start: int, node: int, axis: int) -> bool:
    """Whether drift along an axis ends at the same walls in two nodes, and is held up alike."""
    shift = (
        (shore.rows[node] - shore.rows[start])
        if axis == 0
        else (shore.cols[node] - shore.cols[start])
    )
    before, now = shore.room[start, axis], shore.room[node, axis]
    alike = held(shore, start, axis) == held(shore, node, axis)
    return bool((now[0] - shift == before[0]) & (now[1] + shift == before[1]) & alike)


@kernel
def _confirm(
    tracks: Tracks, shore: Shore, e: int, i: int, node: int, now: int, ways: Ended
) -> None:
    """Put track i into a node in which it is seen now."""
    row, col = float(shore.rows[node]), float(shore.cols[node])
    tracks.row[e, i] = min(max(tracks.row[e, i], row - INSET), row + INSET)
    tracks.col[e, i] = min(max(tracks.col[e, i], col - INSET), col + INSET)
    tracks.node[e, i] = node
    for axis in range(2):
        if not _same_walls(shore, tracks.base_node[e, i, axis], node, axis):
            _report(tracks, shore, e, i, axis, ways)
            tracks.base[e, i, axis], tracks.base_node[e, i, axis] = now, node
    tracks.seen[e, i], tracks.seen_node[e, i] = now, node


@kernel
def collect(
    tracks: Tracks, shore: Shore, e: int, now: int, foragers_at: Int32Array, ways: Ended, lost: Lost
) -> None:
    """End the tracks in the nodes that foragers are in now: items are removed before they drift.

    Of those not seen just before it is not certain that they were there: they count as lost.

    Parameters
    ----------
    now : the step just made
    foragers_at : (forager,) nodes
    ways, lost : displacements and losses, added to
    """
    for f in range(foragers_at.size):
        i = 0
        while i < tracks.number[e]:
            if tracks.node[e, i] == foragers_at[f]:
                if tracks.seen[e, i] < now - 1:
                    _lose(tracks, e, i, lost)
                drop(tracks, shore, e, i, ways)
            else:
                i += 1


@kernel
def carry(tracks: Tracks, shore: Shore, e: int, drift_row: float, drift_col: float) -> None:
    """Let all tracks drift for one step [node/step]."""
    for i in range(tracks.number[e]):
        row, col, node = drifted(
            shore, tracks.row[e, i], tracks.col[e, i], drift_row, drift_col, 1.0
        )
        tracks.row[e, i], tracks.col[e, i], tracks.node[e, i] = row, col, node


@kernel
def _squared(shore: Shore, node: int, row: float, col: float) -> float:
    """Squared distance of a place to the centre of a node [node^2]."""
    return float((shore.rows[node] - row) ** 2 + (shore.cols[node] - col) ** 2)


@kernel
def _loosen(
    tracks: Tracks, shore: Shore, e: int, view: View, tracked: NDArray[np.int16]
) -> NDArray[np.bool_]:
    """Which tracks (track,) are too many in a node in view: those farthest from its middle."""
    n, node = tracks.number[e], tracks.node[e]
    loose = np.zeros(n, np.bool_)
    for i in range(n):
        tracked[node[i]] += view.last_seen[node[i]] == view.now
    for i in range(n):
        here = node[i]
        while tracked[here] > view.belief[here] and view.last_seen[here] == view.now:
            worst, far = -1, -1.0
            for k in range(n):
                if node[k] == here and not loose[k]:
                    away = _squared(shore, here, tracks.row[e, k], tracks.col[e, k])
                    if away > far:
                        worst, far = k, away
            loose[worst] = True
            tracked[here] -= 1
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
    shore: Shore,
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
        gate = FIRST_GATE + wander * (now - tracks.seen[e, i])
        gate = max(gate, IN_VIEW_GATE) if loose[i] else gate
        for j in range(lacking.size):
            away = _squared(shore, lacking[j], tracks.row[e, i], tracks.col[e, i])
            if away < best and away <= gate * gate:
                best, best_track, best_lack = away, i, j
    return best_track, best_lack


@kernel
def _hide(tracks: Tracks, shore: Shore, neighbours: Int32Array, e: int, i: int, view: View) -> bool:
    """Push a track into the nearest node beside it that is out of sight; False if there is none."""
    row, col, hidden, nearest = tracks.row[e, i], tracks.col[e, i], -1, HIDING**2
    for direction in range(8):
        other = neighbours[tracks.node[e, i], direction]
        if other >= 0 and view.last_seen[other] != view.now:
            away = _squared(shore, other, row, col)
            if away < nearest:
                hidden, nearest = other, away
    if hidden >= 0:
        r, c = float(shore.rows[hidden]), float(shore.cols[hidden])
        tracks.row[e, i] = min(max(row, r - INSET), r + INSET)
        tracks.col[e, i] = min(max(col, c - INSET), c + INSET)
        tracks.node[e, i] = hidden
    return hidden >= 0


@kernel
def _caught(tracks: Tracks, shore: Shore, e: int, i: int, catch: Catch) -> bool:
    """Whether a track that is not where it should be can be an item that a forager took."""
    for f in range(catch.at.size):
        away = _squared(shore, catch.at[f], tracks.row[e, i], tracks.col[e, i])
        if catch.left[f] > 0 and away <= CATCH_GATE**2:
            catch.left[f] -= 1
            return True
    return False


@kernel
def _has(nodes: Int32Array, node: int) -> bool:
    """Whether a node is among others."""
    found = False
    for other in nodes:
        found |= other == node
    return found


@kernel
def _begin(tracks: Tracks, shore: Shore, e: int, node: int, now: int, ways: Ended) -> bool:
    """Begin a track in a node in view; False if there is no room."""
    i = tracks.number[e]
    if i == tracks.row.shape[1]:
        return False
    tracks.row[e, i], tracks.col[e, i] = float(shore.rows[node]), float(shore.cols[node])
    tracks.born[e, i], tracks.seen[e, i] = now, now
    tracks.seen_node[e, i] = node
    tracks.base[e, i], tracks.base_node[e, i] = now, node
    tracks.number[e] = i + 1
    _confirm(tracks, shore, e, i, node, now, ways)
    return True


@kernel
def reconcile(
    tracks: Tracks,
    shore: Shore,
    neighbours: Int32Array,
    e: int,
    view: View,
    wander: float,
    catch: Catch,
    memory: Scratch,
    ways: Ended,
    lost: Lost,
) -> int:
    """Make the tracks agree with the counts in view.

    Parameters
    ----------
    neighbours : (node, 8) int32
    e : episode
    wander : how uncertain an unseen track gets [node/step]
    catch : what foragers have taken
    ways, lost : displacements that ended and items given up, added to

    Returns
    -------
    New tracks; they are the last ones
    """
    n, now = tracks.number[e], view.now
    loose = _loosen(tracks, shore, e, view, memory.tracked)
    lacking, lacks = _lacks(tracks, e, view, memory.tracked)
    settled_now = np.zeros(n, np.bool_)
    for i in range(n):
        if not loose[i] and view.last_seen[tracks.node[e, i]] == now:
            _confirm(tracks, shore, e, i, tracks.node[e, i], now, ways)
            settled_now[i] = True
    # Loose tracks, then unseen ones, go to the nearest lack within their gates.
    for unseen_too in range(2):
        while lacks > 0:
            free = ~settled_now if unseen_too else loose & ~settled_now
            i, j = _nearest_lack(tracks, shore, e, now, wander, free, loose, lacking[:lacks])
            if i < 0:
                break
            _confirm(tracks, shore, e, i, lacking[j], now, ways)
            settled_now[i] = True
            lacks -= 1
            lacking[j] = lacking[lacks]
    # What is still loose is just out of sight, or was a mistake.
    for i in range(n - 1, -1, -1):
        if not loose[i] or settled_now[i]:
            continue
        if _caught(tracks, shore, e, i, catch):
            drop(tracks, shore, e, i, ways)
        elif _has(catch.at, tracks.node[e, i]) or not _hide(tracks, shore, neighbours, e, i, view):
            _lose(tracks, e, i, lost)
            drop(tracks, shore, e, i, ways)
    new = 0
    while new < lacks and _begin(tracks, shore, e, lacking[new], now, ways):
        new += 1
    return new
