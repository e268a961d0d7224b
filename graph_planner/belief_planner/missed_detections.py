"""Missed-detection model: the probability that an item in view was not shown.

All agents that see a node in a step detect an item there or miss it together, so the nearest of
them counts. Of every view, the distance of the nearest agent is therefore stored. Delayed
measurements are judged by the history of views and of the foragers' nodes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.sensors.detection import chances_by_square, squares_in_view
from mjforage.mission.task import Task

_FARTHEST = 65534  # squared distance that is kept


class MissedDetections(NamedTuple):
    """Memory of a batch; without steps where nothing in view is ever missed."""

    near: NDArray[np.uint16]  # (row, step, node) one more than the squared distance, 0 out of view
    chance: NDArray[np.float64]  # (square,) to detect an item, by squared distance
    factor: NDArray[np.float32]  # (node,) memory: by which a view multiplies what is unseen there


class Looking(NamedTuple):
    """Observers of a step, and their places."""

    at: Int32Array  # (look,) nodes
    radius: NDArray[np.int64]  # (look,) which list of `views`
    views: NodeLists
    rows: Int32Array  # (node,)
    cols: Int32Array


def missed_detections(
    rows: int, nodes: int, horizon: int, chance: NDArray[np.float64]
) -> MissedDetections:
    """No views yet, for chances by squared distance as `chances_by_square` gives them."""
    steps = 0 if chance.min(initial=1.0) >= 1.0 else horizon + 1
    near = np.zeros((rows, steps, nodes if steps else 0), np.uint16)
    return MissedDetections(near, chance, np.ones(nodes, np.float32))


def assumed_chances(task: Task, settings: BeliefSettings) -> NDArray[np.float64]:
    """(square,) the chances that a planner assumes."""
    about = settings.detection, settings.half_range_node, settings.slope_node
    return chances_by_square(squares_in_view(task), *about)


@inlined
def is_certain(missed_detections: MissedDetections) -> bool:
    """True if nothing in view is ever missed."""
    return bool(missed_detections.near.shape[1] == 0)


@kernel
def missed(missed_detections: MissedDetections, e: int, step: int, node: int) -> float:
    """Chance that an item in a node that was in view in a step was not shown."""
    if missed_detections.near.shape[1] == 0:
        return 0.0
    near = missed_detections.near[e, step, node]
    return 1.0 - missed_detections.chance[near - 1] if near > 0 else 1.0


@kernel
def look_at(
    missed_detections: MissedDetections,
    e: int,
    step: int,
    last_seen: NDArray[np.int16],
    looking: Looking,
) -> None:
    """Take in a view, and fill `factor`: what is new in it counts.

    `last_seen`: (node,) `step` where the node was in view.
    """
    factor, near = missed_detections.factor, missed_detections.near
    if near.shape[1] == 0:
        for node in range(factor.size):
            factor[node] = last_seen[node] != step
        return
    factor[:] = 1.0
    rows, cols, start = looking.rows, looking.cols, looking.views.start
    for k in range(looking.at.size):
        viewer, radius = looking.at[k], looking.radius[k]
        for i in range(start[radius, viewer], start[radius, viewer + 1]):
            node = looking.views.nodes[i]
            down, right = rows[node] - rows[viewer], cols[node] - cols[viewer]
            mark = min(down * down + right * right, _FARTHEST) + 1
            before = near[e, step, node]
            if last_seen[node] != step or (before > 0 and before <= mark):
                continue
            unseen = missed(missed_detections, e, step, node)
            near[e, step, node] = mark
            if unseen > 0.0:
                factor[node] *= missed(missed_detections, e, step, node) / unseen


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
