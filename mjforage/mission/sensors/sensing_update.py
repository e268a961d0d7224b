"""Scans of all agents in a step, which update the ledger and the common knowledge."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.device import Bind, Call, Launch
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.dynamics import Transition
from mjforage.mission.knowledge import Knowledge, Scans, receive
from mjforage.mission.ledger import Ledger, count, credit
from mjforage.mission.sensors.map_filter import MapFilter, add_scan, correct, round_off
from mjforage.mission.sensors.sensing import Sensing, sense, sensing
from mjforage.mission.task import Task
from mjforage.scenario.sensors import Sensors


class SensorConfig(NamedTuple):
    """Sensor configuration of a fleet, and the episodes' keys."""

    views: NodeLists
    radius_number: NDArray[np.int64]  # (agent,) which list of `views`
    credit_order: NDArray[np.int64]  # (agent,) see `Fleet.credit_order`
    keys: UInt64Array  # (episode,)
    all_received: NDArray[np.bool_]  # (episode, agent) True
    in_view: NDArray[np.bool_]  # (node,) memory of `credit`
    found: Int32Array  # (item,) the same


@kernel
def _sense_perfectly(
    config: SensorConfig,
    ledger: Ledger,
    knowledge: Knowledge,
    scans: Scans,
    item_node: Int32Array,
    taken_by: NDArray[np.int16],
) -> None:
    """Discretise, scan, credit."""
    views, radius_number = config.views, config.radius_number
    count(scans.active, scans.step, item_node, taken_by, ledger)
    receive(scans, config.all_received, views, radius_number, knowledge)
    about = config.credit_order, views, radius_number, config.in_view, config.found
    credit(scans, knowledge, *about, ledger)


@kernel
def _sense_imperfectly(
    config: SensorConfig,
    sensing: Sensing,
    filtered: MapFilter,
    ledger: Ledger,
    knowledge: Knowledge,
    scans: Scans,
    item_node: Int32Array,
    taken_by: NDArray[np.int16],
) -> None:
    """The same where scans miss items or show false positives: credit is for detections only."""
    views, radius_number = config.views, config.radius_number
    count(scans.active, scans.step, item_node, taken_by, ledger)
    sense(sensing, config.keys, scans, config.credit_order, views, radius_number, ledger)
    receive(scans, config.all_received, views, radius_number, knowledge)
    for e in range(filtered.density.shape[0]):
        if scans.active[e]:
            for agent in range(radius_number.size):
                add_scan(filtered, agent, scans.agent_node[e, agent], scans.shown[e, agent])
            correct(filtered, e)
            round_off(filtered, e, knowledge)


_CONFIG = "views radius_number credit_order"
SENSE_PERFECTLY = Launch(_sense_perfectly, shared=_CONFIG, memory="in_view found")
SENSE_IMPERFECTLY = Launch(
    _sense_imperfectly,
    shared=f"{_CONFIG} sensing.chance filtered.chance collects rows cols",
    memory="in_view found place manned counted best",
)


class SensingUpdate:
    """Scans for the fleet of one batch of episodes."""

    def __init__(
        self,
        task: Task,
        sensors: Sensors,
        keys: UInt64Array,
        ledger: Ledger,
        knowledge: Knowledge,
        filtered: MapFilter,
    ) -> None:
        """Prepare.

        Parameters
        ----------
        keys : (episode,) episode keys
        ledger, knowledge : of the ledger and of the fleet together, changed by every scan
        filtered : what the fleet makes of counts, the same
        """
        items, self._perfect = ledger.t_discovered.shape[1], sensors.perfect
        config = SensorConfig(
            task.views,
            task.radius_number,
            task.fleet.credit_order,
            keys,
            np.ones((keys.size, len(task.fleet)), np.bool_),
            np.zeros(len(task.graph), np.bool_),
            np.empty(items, np.int32),
        )
        if sensors.perfect:
            self._scan = BoundKernel(_sense_perfectly, config, ledger, knowledge)
        else:
            sees = sensing(sensors, task, keys, items)
            self._scan = BoundKernel(_sense_imperfectly, config, sees, filtered, ledger, knowledge)

    def on_device(self, bind: Bind, scans: Scans, state: Transition) -> Call:
        """`scan` by a kernel on a device, of the items of a state."""
        launch = SENSE_PERFECTLY if self._perfect else SENSE_IMPERFECTLY
        return bind(launch, *self._scan.fixed, scans, state.item_node, state.collected_by)

    def scan(self, scans: Scans, item_node: Int32Array, taken_by: NDArray[np.int16]) -> None:
        """Take in the end of a step.

        Parameters
        ----------
        scans : of the step; what they show is filled in where they are not perfect; episodes that
            are not active do not change
        item_node : (episode, item) node of each item, -1 once removed
        taken_by : (episode, item) agent that removed it, -1 none
        """
        self._scan(
            scans.plain(),
            np.ascontiguousarray(item_node, np.int32),
            np.ascontiguousarray(taken_by, np.int16),
        )
