"""Delayed measurements: scans received after the step in which they were made.

Each is processed at its own step, the oldest first (out-of-sequence measurements; Y. Bar-Shalom,
IEEE Transactions on Aerospace and Electronic Systems 38, 2002). Tracks are moved back to that step
by the drift, made to agree with the scan, and moved forward again; those that were seen since
account for the items of the scan, and stay.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, drifted, settled
from mjforage.graph_planner.belief_planner.missed_detections import ViewHistory, missed, was_in_view
from mjforage.graph_planner.belief_planner.tracks import ENDED, Ended, Lost, Tracks, drop, lose
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import NEVER


class Glance(NamedTuple):
    """Combined content of the delayed scans of one step."""

    belief: NDArray[np.int16]  # (node,) items, right where the node was in view
    last_seen: NDArray[np.int16]  # (node,) step where the node was in view, else `NEVER`


class Sighted(NamedTuple):
    """Items that delayed scans have shown for the first time."""

    step: int
    node: Int32Array  # (item,) where they were then


def glance(nodes: int) -> Glance:
    """Memory for a map of so many nodes."""
    return Glance(np.zeros(nodes, np.int16), np.full(nodes, NEVER, np.int16))


@kernel
def show(
    step: int,
    nodes: Int32Array,
    items_seen: NDArray[np.int16],
    radius: NDArray[np.int64],
    views: NodeLists,
    glance: Glance,
) -> None:
    """Fill a glance with scans of one step.

    Parameters
    ----------
    nodes : (look,) where each was made
    items_seen : (look, place) items in the nodes in view, in the order of their list
    radius : (look,) which list of `views`
    """
    glance.last_seen[:] = NEVER
    for k in range(nodes.size):
        first = views.start[radius[k], nodes[k]]
        for i in range(first, views.start[radius[k], nodes[k] + 1]):
            node, items = views.nodes[i], items_seen[k, i - first]
            if items < 0:
                continue
            known = glance.last_seen[node] == step
            glance.belief[node] = max(items, glance.belief[node]) if known else items
            glance.last_seen[node] = step


@kernel
def work_back(
    tracks: Tracks, boundary: Boundary, e: int, step: int, steps: int, drift: NDArray[np.float64]
) -> None:
    """Bring all tracks back to a step that is `steps` ago, by the drift (2,) [node/step]."""
    for i in range(tracks.number[e]):
        row, col = tracks.row[e, i], tracks.col[e, i]
        tracks.now_row[e, i], tracks.now_col[e, i] = row, col
        tracks.firm[e, i] = tracks.seen[e, i] >= step
        tracks.row[e, i], tracks.col[e, i], tracks.node[e, i] = drifted(
            boundary, row, col, -drift[0], -drift[1], float(steps)
        )


@kernel
def collect(
    tracks: Tracks,
    boundary: Boundary,
    e: int,
    step: int,
    foragers_at: Int32Array,
    drift: NDArray[np.float64],
    ways: Ended,
    lost: Lost,
) -> None:
    """End worked back tracks that foragers had come to in a step, before the rest drifted."""
    for f in range(foragers_at.size):
        i = 0
        while i < tracks.number[e]:
            _, _, before = drifted(
                boundary, tracks.row[e, i], tracks.col[e, i], -drift[0], -drift[1], 1.0
            )
            if before == foragers_at[f] and not tracks.firm[e, i]:
                if tracks.seen[e, i] < step - 1:
                    lose(tracks, e, i, lost)
                drop(tracks, boundary, e, i, ways)
            else:
                i += 1


@kernel
def _is_out(
    history: ViewHistory,
    boundary: Boundary,
    e: int,
    row: float,
    col: float,
    drift: NDArray[np.float64],
    step: int,
    now: int,
) -> bool:
    """True if an item at a place [node] at a step would have been seen or taken before now."""
    row, col, node = settled(boundary, row, col)
    unseen = 1.0
    for s in range(step + 1, now):
        for f in range(history.foragers.shape[2]):
            if history.foragers[e, s, f] == node:
                return True
        row, col, node = drifted(boundary, row, col, drift[0], drift[1], 1.0)
        if was_in_view(history.views[e], s, node):
            unseen *= missed(history.missed_detections, e, s, node)
        if unseen < ENDED:
            return True
    return False


@kernel
def doubt(
    tracks: Tracks,
    history: ViewHistory,
    boundary: Boundary,
    e: int,
    new: int,
    step: int,
    now: int,
    drift: NDArray[np.float64],
    ways: Ended,
    lost: Lost,
) -> int:
    """End those of the last `new` tracks that would have been seen or taken since; how many stay.

    They are items that were known already, or are gone; they count as lost.
    """
    count = new
    for i in range(tracks.number[e] - 1, tracks.number[e] - 1 - new, -1):
        if _is_out(history, boundary, e, tracks.row[e, i], tracks.col[e, i], drift, step, now):
            lose(tracks, e, i, lost)
            drop(tracks, boundary, e, i, ways)
            count -= 1
    return count


@kernel
def carry_on(
    tracks: Tracks, boundary: Boundary, e: int, step: int, steps: int, drift: NDArray[np.float64]
) -> None:
    """Move tracks forward to now: those that the scan changed by the drift, others as before."""
    for i in range(tracks.number[e]):
        row, col = tracks.row[e, i], tracks.col[e, i]
        touched = tracks.seen[e, i] == step and not tracks.firm[e, i]
        if not touched:
            now_row, now_col = tracks.now_row[e, i], tracks.now_col[e, i]
            back_row, back_col, _ = drifted(
                boundary, now_row, now_col, -drift[0], -drift[1], float(steps)
            )
            touched = row != back_row or col != back_col
            if not touched:
                row, col = now_row, now_col
        left = float(steps) if touched else 0.0
        tracks.row[e, i], tracks.col[e, i], tracks.node[e, i] = drifted(
            boundary, row, col, drift[0], drift[1], left
        )
        tracks.firm[e, i] = False
