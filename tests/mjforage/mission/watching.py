"""Agents that stay where they are and scan: what is known, and the ledger, by hand-made worlds."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.randomness import episode_keys
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.knowledge import Knowledge, Scans
from mjforage.mission.ledger import Ledger
from mjforage.mission.moves import MoveRules
from mjforage.mission.sensors.sensing import map_filter, no_shown
from mjforage.mission.sensors.sensing_update import SensingUpdate
from mjforage.mission.task import Task
from mjforage.scenario.roles import Fleet, Role
from mjforage.scenario.scenario_file import load_scenario
from mjforage.scenario.sensors import Sensors


def task_of(shape: tuple[int, int], **teams: Role) -> Task:
    """Open water of so many rows and columns."""
    graph = navigation_graph(np.ones(shape, np.bool_), 1.0, True)
    return Task(graph, Fleet.of(teams), MoveRules(True, True), 100)


def scans_of(ledger: Ledger, at: NDArray[np.int32], shown: NDArray[np.int16]) -> Scans:
    """Scans of step 0 from some nodes (episode, agent)."""
    return Scans(
        active=np.ones(len(at), np.bool_),
        step=np.zeros(len(at), np.int32),
        agent_node=at,
        sighted=ledger.truth,
        shown=shown,
        energy_left=np.full(at.shape, np.inf),
        room_left=np.zeros(at.shape, np.int64),
        taken=np.zeros(at.shape, np.int64),
        pickup=np.zeros(at.shape, np.int8),
        agent_yaw=np.zeros(at.shape),
    )


class Watched:
    """A fleet that stays where it is, in many episodes alike but for their keys.

    Attributes
    ----------
    knowledge, ledger : after the last step
    shown : (step, episode, agent, place) what scans showed
    """

    def __init__(
        self,
        task: Task,
        sensors: Sensors,
        at: list[int] | list[list[int]],
        items: list[int],
        steps: int = 0,
        episodes: NDArray[np.int64] | int = 400,
        yaw: float = 0.0,
    ) -> None:
        """Let agents at nodes ([episode,] agent) scan at items in nodes (item,) from step 0 on."""
        keys = episode_keys(0, np.arange(episodes) if isinstance(episodes, int) else episodes)
        item_node = np.tile(np.array(items, np.int32), (keys.size, 1))
        ledger = Ledger.of(item_node, len(task.graph))
        shown = no_shown(task, keys.size, sensors.perfect)
        nodes = np.broadcast_to(np.array(at, np.int32), (keys.size, len(task.fleet)))
        scans = scans_of(ledger, np.ascontiguousarray(nodes), shown)
        scans.agent_yaw[:] = yaw
        self.knowledge, self.ledger = Knowledge.of_starts(scans, len(task.graph)), ledger
        filtered = map_filter(replace(load_scenario("comb-port"), sensors=sensors), task, keys.size)
        update = SensingUpdate(task, sensors, keys, ledger, self.knowledge, filtered)
        nobody, self.shown = np.full(item_node.shape, -1, np.int16), []
        for step in range(steps + 1):
            scans = scans._replace(step=np.full(keys.size, step, np.int32))
            update.scan(scans, item_node, nobody)
            self.shown.append(shown.copy())
