"""All agents look: the ledger and what the fleet knows together come up to date with a step."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel, prepared
from graph_planner.geodesics import Int32Array
from graph_planner.knowledge import Knowledge, Looks, hear
from graph_planner.randomness import UInt64Array
from graph_planner.task import Task
from graph_planner.visibility import NodeLists
from mjforage.core.ledger import Entries, count, credit, sight


class Eyes(NamedTuple):
    """How a fleet sees, and in which episodes."""

    views: NodeLists
    radius_number: NDArray[np.int64]  # (agent,) which list of `views`
    credit_order: NDArray[np.int64]  # (agent,) see `Fleet.credit_order`
    detection: float  # probability that an item in view is seen
    keys: UInt64Array  # (episode,)
    all_heard: NDArray[np.bool_]  # (episode, agent) True
    in_view: NDArray[np.bool_]  # (node,) memory of `credit`
    found: Int32Array  # (item,) the same


@kernel
def _look(
    eyes: Eyes,
    entries: Entries,
    knowledge: Knowledge,
    looks: Looks,
    item_node: Int32Array,
    taken_by: NDArray[np.int16],
) -> None:
    """Discretise, look, credit."""
    active, step = looks.active, looks.step
    views, radius_number, credit_order = eyes.views, eyes.radius_number, eyes.credit_order
    detection, keys, all_heard = eyes.detection, eyes.keys, eyes.all_heard
    count(active, step, item_node, taken_by, entries)
    if detection < 1.0:
        sight(active, step, keys, detection, entries)
    hear(looks, all_heard, views, radius_number, knowledge)
    credit(looks, knowledge, credit_order, views, radius_number, eyes.in_view, eyes.found, entries)


class Lookout:
    """Looks for the fleet of one batch of episodes."""

    def __init__(
        self,
        task: Task,
        detection: float,
        keys: UInt64Array,
        entries: Entries,
        knowledge: Knowledge,
    ) -> None:
        """Prepare.

        Parameters
        ----------
        detection : probability that an item in view is seen, drawn per item and step
        keys : (episode,) episode keys
        entries, knowledge : of the ledger and of the fleet together, changed by every look
        """
        eyes = Eyes(
            task.views,
            task.radius_number,
            task.fleet.credit_order,
            detection,
            keys,
            np.ones((keys.size, len(task.fleet)), np.bool_),
            np.zeros(len(task.graph), np.bool_),
            np.empty(entries.t_discovered.shape[1], np.int32),
        )
        self._look = prepared(_look, eyes, entries, knowledge)

    def look(self, looks: Looks, item_node: Int32Array, taken_by: NDArray[np.int16]) -> None:
        """Take in the end of a step.

        Parameters
        ----------
        looks : of the step; episodes that are not active do not change
        item_node : (episode, item) node of each item, -1 once removed
        taken_by : (episode, item) agent that removed it, -1 nobody
        """
        self._look(
            looks.plain(),
            np.ascontiguousarray(item_node, np.int32),
            np.ascontiguousarray(taken_by, np.int16),
        )
