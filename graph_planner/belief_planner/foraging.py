"""The foragers' part of a decision: items to stops, stops to routes, routes to moves."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.group import Group
from graph_planner.belief_planner.move_preferences import towards
from graph_planner.belief_planner.routes import NOWHERE, Legs, search_routes
from graph_planner.belief_planner.shore import Shore, settled, shore_of
from graph_planner.belief_planner.stops import (
    MOST,
    Floating,
    Stops,
    add_pickup,
    decisions_between,
    floating,
    gather_stops,
    stops,
)
from graph_planner.belief_planner.taking import Taking
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
    """The stop that a forager can be in first, from the decisions to each (forager, stop)."""
    best = NOWHERE
    for j in range(first.shape[1]):
        if best == NOWHERE or first[forager, j] < first[forager, best]:
            best = j
    return best


class Able(NamedTuple):
    """Collectors that can still collect."""

    agents: NDArray[np.int64]  # (forager,) indices in the fleet
    kind: NDArray[np.int64]  # (forager,) which of the ways it moves by
    room: NDArray[np.float64]  # (forager,) items, inf if any number
    lasts: NDArray[np.float64]  # (forager,) decisions that its energy is good for


class Effort(NamedTuple):
    """How routes are searched."""

    stay: bool  # whether staying put is a move
    joint: bool  # whether routes are searched together
    beam: int  # states kept
    choices: int  # stops tried from a state
    depth: int  # stops in a route, over all foragers
    taking: Taking  # how long collecting takes


class Scratch(NamedTuple):
    """Memory of a search."""

    found: Stops
    worth: NDArray[np.float64]  # (node,) all zero between calls


@kernel
def gather_legs(
    items: Floating,
    shore: Shore,
    ways: tuple[Ways, ...],
    able: Able,
    agent_node: Int32Array,
    agent_yaw: NDArray[np.float64],
    drift_rc: NDArray[np.float64],
    stay: bool,
    taking: Taking,
    found: Stops,
) -> Legs:
    """Put items into stops `found`, and list how far they are for those who are able.

    Parameters
    ----------
    agent_node, agent_yaw : (agent,) where they are, and their heading [rad]
    drift_rc : (2,) [node/step]
    stay, taking : see `Effort`
    """
    kind, agents, at = able.kind, able.agents, agent_node[able.agents]
    gather_stops(items, shore, ways, kind, at, drift_rc[0], drift_rc[1], taking, found)
    n = found.number[0]
    first, between = decisions_between(found, ways, kind, at, stay)
    if n:
        add_pickup(taking, shore, found, agents, at, agent_yaw[agents], first, between)
    return Legs(found.weight[:n], first, between, kind, able.room, able.lasts)


@kernel
def follow_routes(
    items: Floating,
    shore: Shore,
    ways: tuple[Ways, ...],
    able: Able,
    agent_node: Int32Array,
    first: NDArray[np.float64],
    target: NDArray[np.int64],
    scratch: Scratch,
    preferences: NDArray[np.float64],
) -> None:
    """Overwrite the rows of preferences (agent, 9) of those who are able by the way to their stops.

    Parameters
    ----------
    first : (forager, stop) decisions, as in `Legs`
    target : (forager,) stop, `NOWHERE` for those that go to the nearest
    """
    kind, found, worth = able.kind, scratch.found, scratch.worth
    for i in range(items.number[0]):
        _, _, node = settled(shore, items.row[i], items.col[i])
        worth[node] += items.weight[i]
    for f in range(target.size):
        goal = target[f] if target[f] != NOWHERE else _nearest(first, f)
        at, row = agent_node[able.agents[f]], preferences[able.agents[f]]
        towards(ways[kind[f]], at, found.node[goal], worth, row)
    worth[:] = 0.0


@kernel
def plan_routes(
    items: Floating,
    shore: Shore,
    ways: tuple[Ways, ...],
    able: Able,
    agent_node: Int32Array,
    agent_yaw: NDArray[np.float64],
    drift_rc: NDArray[np.float64],
    effort: Effort,
    scratch: Scratch,
    preferences: NDArray[np.float64],
) -> int:
    """Plan routes and overwrite the rows of preferences (agent, 9) of those who are able.

    Parameters
    ----------
    agent_node, agent_yaw, drift_rc : see `gather_legs`

    Returns
    -------
    Number of stops; with none nothing is written
    """
    about = items, shore, ways, able, agent_node
    stay, taking, found = effort.stay, effort.taking, scratch.found
    legs = gather_legs(*about, agent_yaw, drift_rc, stay, taking, found)
    n = legs.weight.size
    if n == 0 or able.agents.size == 0:
        return 0
    target = np.full(able.agents.size, NOWHERE, np.int64)
    if effort.joint:
        target = search_routes(legs, effort.beam, effort.choices, effort.depth)
    follow_routes(*about, legs.first, target, scratch, preferences)
    return int(n)


class Collecting:
    """Those who collect, the items that they know of, and what keeps each from collecting.

    Attributes
    ----------
    group : who they are, and the ways of each
    shore : where items drift
    items : what there is to collect, filled by others
    taking : how long collecting takes
    """

    def __init__(self, task: Task, settings: BeliefSettings) -> None:
        self.group = Group.of(task, task.fleet.collectors)
        self.shore = shore_of(task.graph, task.walls)
        self.items = floating(max(4096, 5 * int(settings.items)))
        self.taking = Taking.of(task)
        self._nothing = np.zeros(len(task.graph))
        self._node_per_decision = USUAL_STEP * task.fleet.moves[self.group.agents]

    def able(
        self, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Which foragers (forager,) can still collect, by what every agent (agent,) has left."""
        agents = self.group.agents
        return (room_left[agents] > 0) & (energy_left[agents] >= 1.0)

    def able_now(self, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]) -> Able:
        """Those foragers, with room and the decisions that their energy lasts for; as `able`."""
        group, chosen = self.group, self.able(room_left, energy_left)
        agents = group.agents[chosen]
        lasts = np.maximum(1.0, energy_left[agents] / self._node_per_decision[chosen])
        lasts += self.taking.first.max(initial=0.0)  # which takes no way
        return Able(agents, group.kind[chosen], _items(room_left[agents]), lasts)

    def is_able(
        self, agent: int, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]
    ) -> bool:
        """Whether one forager can still collect."""
        return bool((self.able(room_left, energy_left) & (self.group.agents == agent)).any())

    def hold(
        self,
        agent_node: Int32Array,
        room_left: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> None:
        """Let those foragers stay where they are that can collect no more; see `able`."""
        for f in np.flatnonzero(~self.able(room_left, energy_left)):
            agent, ways = self.group.agents[f], self.group.ways[self.group.kind[f]]
            node = agent_node[agent]
            towards(ways, node, node, self._nothing, preferences[agent])


class Foraging(Collecting):
    """Those who collect: given items and a drift, where each goes now."""

    def __init__(self, task: Task, settings: BeliefSettings) -> None:
        super().__init__(task, settings)
        nodes, members = len(task.graph), max(1, self.group.agents.size)
        self._scratch, taking = Scratch(stops(MOST, nodes), np.zeros(nodes)), self.taking
        self._effort = (
            Effort(task.rules.stay, settings.joint, 6, 5, 8 * members, taking)
            if settings.fast
            else Effort(task.rules.stay, settings.joint, 32, 10, 14 * members, taking)
        )

    def send(
        self,
        agent_node: Int32Array,
        agent_yaw: NDArray[np.float64],
        drift_rc: NDArray[np.float64],
        room_left: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> int:
        """Overwrite the foragers' rows of preferences (agent, 9) by the way to what is in `items`.

        Those that are full or out of energy are left out.

        Parameters
        ----------
        agent_node, agent_yaw : (agent,) where they are, and their heading [rad]
        drift_rc : (2,) [node/step]
        room_left : (agent,) items; energy_left : (agent,) [node]

        Returns
        -------
        Number of stops; with none nothing is written
        """
        able = self.able_now(room_left, energy_left)
        return self._plan(able, agent_node, agent_yaw, drift_rc, preferences)

    def _plan(
        self,
        able: Able,
        agent_node: Int32Array,
        agent_yaw: NDArray[np.float64],
        drift_rc: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> int:
        """As `send`, for those who are able."""
        about = self.items, self.shore, self.group.ways, able, agent_node
        effort, scratch = self._effort, self._scratch
        return plan_routes(*about, agent_yaw, drift_rc, effort, scratch, preferences)
