"""Every look of a batch, kept for the whole episode.

A look is what an agent sees at the end of a step from its node: how many items in each node of its
view, empty ones included, and what it says of itself. Knowledge is the fold of the looks that were
heard: of each node the largest (step, items), of each agent its newest look. So it does not depend
on the order in which looks are heard, nor on how often.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.knowledge import Knowledge, Looks, take_shown
from mjforage.mission.task import Task


class LookLog(NamedTuple):
    """Looks of a batch by episode, step and agent."""

    node: Int32Array  # (episode, step, agent) from where
    shown: NDArray[np.int16]  # (episode, step, agent, place) items, in the order of its node list;
    # negative where it did not look
    occupied: Int32Array  # (episode, step, agent) nodes with items among those
    energy_left: NDArray[np.float64]  # (episode, step, agent) [node]
    room_left: NDArray[np.int64]  # (episode, step, agent) items
    taken: NDArray[np.int64]  # (episode, step, agent) items
    pickup: NDArray[np.int8]  # (episode, step, agent) see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (episode, step, agent) [rad]

    @classmethod
    def of(cls, task: Task, episodes: int) -> "LookLog":
        """No looks yet, for all steps of so many episodes."""
        each = (episodes, task.horizon + 1, len(task.fleet))
        return cls(
            np.zeros(each, np.int32),
            np.zeros((*each, widest_view(task)), np.int16),
            np.zeros(each, np.int32),
            np.zeros(each),
            np.zeros(each, np.int64),
            np.zeros(each, np.int64),
            np.zeros(each, np.int8),
            np.zeros(each),
        )


def widest_view(task: Task) -> int:
    """Nodes in the largest view of a task's agents."""
    used = np.unique(task.radius_number)
    return int(np.diff(task.views.start[used], axis=1).max(initial=0))


@kernel
def log_looks(
    looks: Looks, views: NodeLists, radius_number: NDArray[np.int64], log: LookLog
) -> None:
    """Keep the looks of this step of all active episodes."""
    active, step, at, sighted = looks.active, looks.step, looks.agent_node, looks.sighted
    start, nodes, perfect = views.start, views.nodes, looks.shown.shape[2] == 0
    node, shown, occupied = log.node, log.shown, log.occupied
    for e in range(active.size):
        if not active[e]:
            continue
        s = step[e]
        for a in range(radius_number.size):
            viewer, radius = at[e, a], radius_number[a]
            first, full = start[radius, viewer], 0
            for i in range(first, start[radius, viewer + 1]):
                items = sighted[e, nodes[i]] if perfect else looks.shown[e, a, i - first]
                shown[e, s, a, i - first] = items
                full += items > 0
            node[e, s, a], occupied[e, s, a] = viewer, full
        log.energy_left[e, s], log.room_left[e, s] = looks.energy_left[e], looks.room_left[e]
        log.taken[e, s], log.pickup[e, s] = looks.taken[e], looks.pickup[e]
        log.agent_yaw[e, s] = looks.agent_yaw[e]


@kernel
def take_in(
    log: LookLog,
    heard: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    knowledge: Knowledge,
) -> None:
    """Let holders hear of looks.

    Parameters
    ----------
    heard : (look, 4) row of the holder in `knowledge`, and episode, step and agent of the look
    knowledge : changed in these rows
    """
    belief, last_seen, known = knowledge.belief, knowledge.last_seen, knowledge.known
    known_at, n_known = knowledge.known_at, knowledge.n_known
    agent_node, agent_seen = knowledge.agent_node, knowledge.agent_seen
    start, nodes, node, shown = views.start, views.nodes, log.node, log.shown
    for k in range(heard.shape[0]):
        row, e, s, a = heard[k, 0], heard[k, 1], heard[k, 2], heard[k, 3]
        viewer, radius = node[e, s, a], radius_number[a]
        first, end = start[radius, viewer], start[radius, viewer + 1]
        seen = shown[e, s, a, : end - first]
        take_shown(belief, last_seen, known, known_at, n_known, row, s, nodes, first, seen)
        if s < agent_seen[row, a]:
            continue
        agent_node[row, a], agent_seen[row, a] = viewer, s
        knowledge.energy_left[row, a] = log.energy_left[e, s, a]
        knowledge.room_left[row, a] = log.room_left[e, s, a]
        knowledge.taken[row, a], knowledge.pickup[row, a] = log.taken[e, s, a], log.pickup[e, s, a]
        knowledge.agent_yaw[row, a] = log.agent_yaw[e, s, a]
