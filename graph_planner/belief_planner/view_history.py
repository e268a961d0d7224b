"""History of views and of the foragers' nodes, by which delayed measurements are judged."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.belief_planner.missed_detections import MissedDetections
from mjforage.graph_planner.graph.geodesics import Int32Array


class ViewHistory(NamedTuple):
    """Memory of a batch."""

    views: NDArray[np.uint64]  # (episode, step, word) a bit per node
    foragers: Int32Array  # (episode, step, forager) nodes, -1 where not known
    missed_detections: MissedDetections  # of those views


def view_history(
    episodes: int, nodes: int, horizon: int, foragers: int, missed_detections: MissedDetections
) -> ViewHistory:
    """No views yet."""
    return ViewHistory(
        np.zeros((episodes, horizon + 1, nodes // 64 + 1), np.uint64),
        np.full((episodes, horizon + 1, foragers), -1, np.int32),
        missed_detections,
    )


@kernel
def remember(
    history: ViewHistory,
    e: int,
    now: int,
    last_seen: NDArray[np.int16],
    foragers_at: Int32Array,
) -> None:
    """Keep the view and the foragers' nodes (forager,), negative where not known, of step `now`."""
    words = history.views[e, now]
    for node in range(last_seen.size):
        if last_seen[node] == now:
            words[node >> 6] |= np.uint64(1) << np.uint64(node & 63)
    for f in range(foragers_at.size):
        if foragers_at[f] >= 0:
            history.foragers[e, now, f] = foragers_at[f]


@inlined
def was_in_view(views: NDArray[np.uint64], step: int, node: int) -> bool:
    """True if a view of the episode, at a step, held a node."""
    return bool((views[step, node >> 6] >> np.uint64(node & 63)) & np.uint64(1) != 0)
