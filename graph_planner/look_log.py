"""Every look of a batch, kept for the whole episode.

A look is what an agent sees at the end of a step from its node: how many items in each node of its
view, empty ones included, and what it says of itself. Knowledge is the fold of the looks that were
heard: of each node the largest (step, items), of each agent its newest look. So it does not depend
on the order in which looks are heard, nor on how often.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.knowledge import Knowledge, Looks, take_shown
from graph_planner.task import Task
from graph_planner.visibility import NodeLists


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
    looks: Looks, e: int, views: NodeLists, radius_number: NDArray[np.int64], log: LookLog
) -> None:
    """Keep the looks of this step of an episode."""
    s, perfect = looks.step[e], looks.shown.shape[2] == 0
    for a in range(radius_number.size):
        viewer, radius = looks.agent_node[e, a], radius_number[a]
        first, full = views.start[radius, viewer], 0
        for i in range(first, views.start[radius, viewer + 1]):
            if perfect:
                items = looks.sighted[e, views.nodes[i]]
            else:
                items = looks.shown[e, a, i - first]
            log.shown[e, s, a, i - first] = items
            full += items > 0
        log.node[e, s, a], log.occupied[e, s, a] = viewer, full
        log.energy_left[e, s, a] = looks.energy_left[e, a]
        log.room_left[e, s, a], log.taken[e, s, a] = looks.room_left[e, a], looks.taken[e, a]
        log.pickup[e, s, a], log.agent_yaw[e, s, a] = looks.pickup[e, a], looks.agent_yaw[e, a]


@kernel
def take_in(
    log: LookLog,
    e: int,
    s: int,
    a: int,
    views: NodeLists,
    radius_number: NDArray[np.int64],
    knowledge: Knowledge,
    row: int,
) -> None:
    """Let a holder hear of a look: of agent `a` at step `s` of episode `e`.

    Parameters
    ----------
    knowledge, row : changed in this row
    """
    viewer, radius = log.node[e, s, a], radius_number[a]
    first, end = views.start[radius, viewer], views.start[radius, viewer + 1]
    take_shown(knowledge, row, s, views.nodes, first, log.shown[e, s, a, : end - first])
    if s >= knowledge.agent_seen[row, a]:
        knowledge.agent_node[row, a], knowledge.agent_seen[row, a] = viewer, s
        knowledge.energy_left[row, a] = log.energy_left[e, s, a]
        knowledge.room_left[row, a] = log.room_left[e, s, a]
        knowledge.taken[row, a], knowledge.pickup[row, a] = log.taken[e, s, a], log.pickup[e, s, a]
        knowledge.agent_yaw[row, a] = log.agent_yaw[e, s, a]
