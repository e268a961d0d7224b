"""The foragers' part of a decision: items to stops, stops to routes, routes to moves."""

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.crew import Crew
from graph_planner.belief_planner.routes import NOWHERE, Legs, search_routes
from graph_planner.belief_planner.shore import Shore, settled, shore_of
from graph_planner.belief_planner.steering import towards
from graph_planner.belief_planner.stops import (
    MOST,
    Floating,
    Stops,
    decisions_between,
    floating,
    gather_stops,
    stops,
)
from graph_planner.belief_planner.ways import Ways
from graph_planner.belief_settings import BeliefSettings
from graph_planner.compiled import kernel
from graph_planner.fleet import UNLIMITED
from graph_planner.geodesics import Int32Array
from graph_planner.task import Task

USUAL_STEP = 1.2  # length of a decision over the nodes it moves: between 1 and sqrt 2 [node]


def _items(room: NDArray[np.int64]) -> NDArray[np.float64]:
    """Room as a number of items, inf if it has no end."""
    return np.where(room == UNLIMITED, np.inf, room.astype(np.float64))


@kernel
def _nearest(first: NDArray[np.float64], forager: int) -> int:
    best = NOWHERE
    for j in range(first.shape[1]):
        if best == NOWHERE or first[forager, j] < first[forager, best]:
            best = j
    return best


@kernel
def send_foragers(
    items: Floating,
    shore: Shore,
    ways: tuple[Ways, ...],
    agents: NDArray[np.int64],
    kind: NDArray[np.int64],
    room: NDArray[np.float64],
    lasts: NDArray[np.float64],
    agent_node: Int32Array,
    drift_row: float,
    drift_col: float,
    stay: bool,
    joint: bool,
    beam: int,
    choices: int,
    depth: int,
    found: Stops,
    worth: NDArray[np.float64],
    preferences: NDArray[np.float64],
) -> int:
    """Plan routes and overwrite the foragers' rows of preferences (agent, 9).

    Parameters
    ----------
    agents, kind, room, lasts : (forager,) see `Legs`; those that are full or spent are left out

    Returns
    -------
    Number of stops; with none nothing is written
    """
    at = agent_node[agents]
    gather_stops(items, shore, ways, kind, at, drift_row, drift_col, found)
    n = found.number[0]
    if n == 0 or at.size == 0:
        return 0
    first, between = decisions_between(found, ways, kind, at, stay)
    if joint:
        legs = Legs(found.weight[:n], first, between, kind, room, lasts)
        target = search_routes(legs, beam, choices, depth)
    else:
        target = np.full(at.size, NOWHERE, np.int64)
    for i in range(items.number[0]):
        _, _, node = settled(shore, items.row[i], items.col[i])
        worth[node] += items.weight[i]
    for f in range(at.size):
        goal = target[f] if target[f] != NOWHERE else _nearest(first, f)
        towards(ways[kind[f]], at[f], found.node[goal], worth, preferences[agents[f]])
    worth[:] = 0.0
    return int(n)


class ForagerCrew:
    """Those who collect: given items and a drift, where each goes now."""

    def __init__(self, task: Task, settings: BeliefSettings) -> None:
        self.crew = Crew.of(task, task.fleet.collectors)
        self.shore = shore_of(task.graph)
        self.items = floating(max(4096, 5 * int(settings.items)))
        self._stops = stops(MOST, len(task.graph))
        self._worth, self._nothing = np.zeros(len(task.graph)), np.zeros(len(task.graph))
        self._node_per_decision = USUAL_STEP * task.fleet.moves[self.crew.agents]
        self._stay, self._settings = task.rules.stay, settings
        self._beam, self._choices = (6, 5) if settings.fast else (32, 10)
        self._depth = (8 if settings.fast else 14) * max(1, self.crew.agents.size)

    def send(
        self,
        agent_node: Int32Array,
        drift_rc: NDArray[np.float64],
        room_left: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> int:
        """Overwrite the foragers' rows of preferences (agent, 9) by the way to what is in `items`.

        Those that are full or out of energy are left out.

        Parameters
        ----------
        agent_node : (agent,)
        drift_rc : (2,) [node/step]
        room_left : (agent,) items; energy_left : (agent,) [node]

        Returns
        -------
        Number of stops; with none nothing is written
        """
        crew = self.crew
        able = self.able(room_left, energy_left)
        agents = crew.agents[able]
        return send_foragers(
            self.items,
            self.shore,
            crew.ways,
            agents,
            crew.kind[able],
            _items(room_left[agents]),
            np.maximum(1.0, energy_left[agents] / self._node_per_decision[able]),
            agent_node,
            drift_rc[0],
            drift_rc[1],
            self._stay,
            self._settings.joint,
            self._beam,
            self._choices,
            self._depth,
            self._stops,
            self._worth,
            preferences,
        )

    def able(
        self, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Which foragers (forager,) can still collect, by what every agent (agent,) has left."""
        agents = self.crew.agents
        return (room_left[agents] > 0) & (energy_left[agents] >= 1.0)

    def hold(
        self,
        agent_node: Int32Array,
        room_left: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> None:
        """Let those foragers stay where they are that can collect no more; see `send`."""
        for f in np.flatnonzero(~self.able(room_left, energy_left)):
            agent, ways = self.crew.agents[f], self.crew.ways[self.crew.kind[f]]
            node = agent_node[agent]
            towards(ways, node, node, self._nothing, preferences[agent])
