"""Log of every scan of a batch, for the whole episode.

A scan is what an agent sees at the end of a step from its node: how many items in each node of its
view, empty ones included, and what it says of itself. Knowledge is the fold of the scans that were
received: of each node the largest (step, items), of each agent its newest scan. So it does not
depend on the order in which scans are received, nor on how often.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.knowledge import Knowledge, Scans, receive_counts
from mjforage.mission.task import Task


class ScanLog(NamedTuple):
    """Scans of a batch by episode, step and agent."""

    node: Int32Array  # (episode, step, agent) from where
    shown: NDArray[np.int16]  # (episode, step, agent, place) items, in the order of its node list;
    # negative where it did not scan
    occupied: Int32Array  # (episode, step, agent) nodes with items among those
    energy_left: NDArray[np.float64]  # (episode, step, agent) [node]
    room_left: NDArray[np.int64]  # (episode, step, agent) items
    taken: NDArray[np.int64]  # (episode, step, agent) items
    pickup: NDArray[np.int8]  # (episode, step, agent) see `PICKUPS`
    agent_yaw: NDArray[np.float64]  # (episode, step, agent) [rad]

    @classmethod
    def of(cls, task: Task, episodes: int) -> "ScanLog":
        """No scans yet, for all steps of so many episodes."""
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
def log_scans(
    scans: Scans, views: NodeLists, radius_number: NDArray[np.int64], log: ScanLog
) -> None:
    """Keep the scans of this step of all active episodes."""
    active, step, at, sighted = scans.active, scans.step, scans.agent_node, scans.sighted
    start, nodes, perfect = views.start, views.nodes, scans.shown.shape[2] == 0
    node, shown, occupied = log.node, log.shown, log.occupied
    energy_left, room_left, agent_yaw = scans.energy_left, scans.room_left, scans.agent_yaw
    taken, pickup = scans.taken, scans.pickup
    for e in range(active.size):
        if not active[e]:
            continue
        s = step[e]
        for a in range(radius_number.size):
            viewer, radius = at[e, a], radius_number[a]
            first, full = start[radius, viewer], 0
            for i in range(first, start[radius, viewer + 1]):
                items = sighted[e, nodes[i]] if perfect else scans.shown[e, a, i - first]
                shown[e, s, a, i - first] = items
                full += items > 0
            node[e, s, a], occupied[e, s, a] = viewer, full
            log.energy_left[e, s, a], log.room_left[e, s, a] = energy_left[e, a], room_left[e, a]
            log.taken[e, s, a], log.pickup[e, s, a] = taken[e, a], pickup[e, a]
            log.agent_yaw[e, s, a] = agent_yaw[e, a]


@kernel
def take_in(
    log: ScanLog,
    received: Int32Array,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    knowledge: Knowledge,
) -> None:
    """Let owners receive scans.

    Parameters
    ----------
    received : (scan, 4) row of the owner in `knowledge`, and episode, step and agent of the scan
    knowledge : changed in these rows
    """
    belief, last_seen, known = knowledge.belief, knowledge.last_seen, knowledge.known
    known_at, n_known = knowledge.known_at, knowledge.n_known
    agent_node, agent_seen = knowledge.agent_node, knowledge.agent_seen
    start, nodes, node, shown = views.start, views.nodes, log.node, log.shown
    for k in range(received.shape[0]):
        row, e, s, a = received[k, 0], received[k, 1], received[k, 2], received[k, 3]
        viewer, radius = node[e, s, a], radius_number[a]
        first, end = start[radius, viewer], start[radius, viewer + 1]
        seen = shown[e, s, a, : end - first]
        receive_counts(belief, last_seen, known, known_at, n_known, row, s, nodes, first, seen)
        if s < agent_seen[row, a]:
            continue
        agent_node[row, a], agent_seen[row, a] = viewer, s
        knowledge.energy_left[row, a] = log.energy_left[e, s, a]
        knowledge.room_left[row, a] = log.room_left[e, s, a]
        knowledge.taken[row, a], knowledge.pickup[row, a] = log.taken[e, s, a], log.pickup[e, s, a]
        knowledge.agent_yaw[row, a] = log.agent_yaw[e, s, a]
