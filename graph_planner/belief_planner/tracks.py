"""Tracks: every item seen, its likely place now, and the drift that its path implies.

Each decision the tracks are carried on, and then reconciled with what is in view (`reconciling`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, at_boundary, drifted
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.walls import INSET

ENDED = 0.1  # a track is given up below this chance that its item is there
CERTAIN = 0.9  # and no track is more certain than so, once it is missed: it may be next door
CERTAIN_PLACE = 0.95  # chance of a track that was just seen to be in its node still


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
    firm: NDArray[np.bool_]  # (episode, track) seen since the step of a late look: it stays
    now_row: NDArray[np.float64]  # (episode, track) where it is now, worked back for a late look
    now_col: NDArray[np.float64]
    real: NDArray[np.float64]  # (episode, track) chance that the item is there
    born_node: Int32Array  # (episode, track) node of the first sighting


@kernel
def add_expected(tracks: Tracks, items: NDArray[np.float64]) -> None:
    """Add to items (episode, node) as many as make each track's chance that there is one."""
    for e in range(items.shape[0]):
        for t in range(tracks.number[e]):
            chance = min(CERTAIN_PLACE, tracks.real[e, t])
            items[e, tracks.node[e, t]] -= math.log1p(-chance)


class Ended(NamedTuple):
    """Ways of the tracks that a reconciliation ended or started anew, for the wind estimate."""

    number: NDArray[np.int64]  # (1,)
    axis: NDArray[np.int64]  # (way,) 0 rows, 1 columns
    shift: NDArray[np.float64]  # (way,) [node]
    steps: NDArray[np.float64]  # (way,)
    start: Int32Array  # (way,) node where it began


class Lost(NamedTuple):
    """Tracks that were given up although the item is not known to be collected."""

    number: NDArray[np.int64]  # (1,)
    born_node: Int32Array  # (loss,) of the first sighting
    born: Int32Array  # (loss,) step of the first sighting


def tracks(episodes: int, capacity: int) -> Tracks:
    """Room for so many tracks in each episode."""
    both = (episodes, capacity)
    return Tracks(
        number=np.zeros(episodes, np.int64),
        row=np.zeros(both),
        col=np.zeros(both),
        node=np.zeros(both, np.int32),
        born=np.zeros(both, np.int32),
        seen=np.zeros(both, np.int32),
        seen_node=np.zeros(both, np.int32),
        base=np.zeros((*both, 2), np.int32),
        base_node=np.zeros((*both, 2), np.int32),
        firm=np.zeros(both, np.bool_),
        now_row=np.zeros(both),
        now_col=np.zeros(both),
        real=np.ones(both),
        born_node=np.zeros(both, np.int32),
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


@kernel
def _report(tracks: Tracks, boundary: Boundary, e: int, i: int, axis: int, ways: Ended) -> None:
    """Hand the way of a track along one axis over, from its base to its last sighting."""
    steps, n = tracks.seen[e, i] - tracks.base[e, i, axis], ways.number[0]
    if steps <= 0 or n >= ways.axis.size:
        return
    places, start = boundary.rows if axis == 0 else boundary.cols, tracks.base_node[e, i, axis]
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
    tracks.firm[e, goal] = tracks.firm[e, source]
    tracks.now_row[e, goal] = tracks.now_row[e, source]
    tracks.now_col[e, goal] = tracks.now_col[e, source]
    tracks.real[e, goal] = tracks.real[e, source]
    tracks.born_node[e, goal] = tracks.born_node[e, source]


@kernel
def drop(tracks: Tracks, boundary: Boundary, e: int, i: int, ways: Ended) -> None:
    """End track i; the last one takes its place."""
    for axis in range(2):
        _report(tracks, boundary, e, i, axis, ways)
    tracks.number[e] -= 1
    _copy(tracks, e, tracks.number[e], i)


@kernel
def lose(tracks: Tracks, e: int, i: int, lost: Lost) -> None:
    """List track i among those that were given up."""
    n = lost.number[0]
    if n < lost.born.size:
        lost.born_node[n], lost.born[n] = tracks.born_node[e, i], tracks.born[e, i]
        lost.number[0] = n + 1


@inlined
def _same_walls(boundary: Boundary, start: int, node: int, axis: int) -> bool:
    """True if drift along an axis ends at the same walls in two nodes, and is held up alike."""
    shift = (
        (boundary.rows[node] - boundary.rows[start])
        if axis == 0
        else (boundary.cols[node] - boundary.cols[start])
    )
    before, now = boundary.room[start, axis], boundary.room[node, axis]
    alike = at_boundary(boundary, start, axis) == at_boundary(boundary, node, axis)
    return bool((now[0] - shift == before[0]) & (now[1] + shift == before[1]) & alike)


@kernel
def confirm(
    tracks: Tracks, boundary: Boundary, e: int, i: int, node: int, now: int, ways: Ended
) -> None:
    """Put track i into a node in which it is seen now."""
    row, col = float(boundary.rows[node]), float(boundary.cols[node])
    tracks.row[e, i] = min(max(tracks.row[e, i], row - INSET), row + INSET)
    tracks.col[e, i] = min(max(tracks.col[e, i], col - INSET), col + INSET)
    tracks.node[e, i] = node
    for axis in range(2):
        if not _same_walls(boundary, tracks.base_node[e, i, axis], node, axis):
            _report(tracks, boundary, e, i, axis, ways)
            tracks.base[e, i, axis], tracks.base_node[e, i, axis] = now, node
    tracks.seen[e, i], tracks.seen_node[e, i] = now, node


@kernel
def collect(
    tracks: Tracks,
    boundary: Boundary,
    e: int,
    now: int,
    foragers_at: Int32Array,
    ways: Ended,
    lost: Lost,
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
                    lose(tracks, e, i, lost)
                drop(tracks, boundary, e, i, ways)
            else:
                i += 1


@kernel
def carry(tracks: Tracks, boundary: Boundary, e: int, drift_row: float, drift_col: float) -> None:
    """Let all tracks drift for one step [node/step]."""
    for i in range(tracks.number[e]):
        row, col = tracks.row[e, i], tracks.col[e, i]
        row, col, node = drifted(boundary, row, col, drift_row, drift_col, 1.0)
        tracks.row[e, i], tracks.col[e, i], tracks.node[e, i] = row, col, node


@kernel
def begin(tracks: Tracks, boundary: Boundary, e: int, node: int, now: int, ways: Ended) -> bool:
    """Begin a track in a node in view; False if there is no room."""
    i = tracks.number[e]
    if i == tracks.row.shape[1]:
        return False
    tracks.row[e, i], tracks.col[e, i] = float(boundary.rows[node]), float(boundary.cols[node])
    tracks.born[e, i], tracks.seen[e, i] = now, now
    tracks.seen_node[e, i], tracks.firm[e, i] = node, False
    tracks.real[e, i], tracks.born_node[e, i] = 1.0, node
    tracks.base[e, i], tracks.base_node[e, i] = now, node
    tracks.number[e] = i + 1
    confirm(tracks, boundary, e, i, node, now, ways)
    return True
