"""The foragers' part of a decision: items to stops, stops to routes, routes to moves."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, boundary_of, settled
from mjforage.graph_planner.belief_planner.move_preferences import towards
from mjforage.graph_planner.belief_planner.routes import NOWHERE, Legs, search_routes
from mjforage.graph_planner.belief_planner.settings import BeliefSettings
from mjforage.graph_planner.belief_planner.stops import (
    MOST,
    Floating,
    Stops,
    add_pickup,
    decisions_between,
    floating,
    gather_stops,
    stops,
)
from mjforage.graph_planner.belief_planner.taking import Taking
from mjforage.graph_planner.belief_planner.ways import Group, Ways
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Task
from mjforage.scenario.roles import UNLIMITED

USUAL_STEP = 1.2  # length of a decision over the nodes it moves: between 1 and sqrt 2 [node]


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


class Members(NamedTuple):
    """Collectors, and the limits of their range."""

    agents: NDArray[np.int64]  # (forager,) indices in the fleet
    kind: NDArray[np.int64]  # (forager,) which of the ways it moves by
    step: NDArray[np.float64]  # (forager,) usual length of a decision [node]
    longest: float  # decisions that collecting takes at most, in which no way is made


@kernel
def is_able(members: Members, f: int, room_left: NDArray[np.int64], energy: float) -> bool:
    """True if a forager can still collect, by what every agent (agent,) has room for [item] and its
    energy [node].
    """
    return bool((room_left[members.agents[f]] > 0) & (energy >= 1.0))


@kernel
def able_now(
    members: Members, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]
) -> Able:
    """Foragers that can still collect, by the room and energy left (agent,) [item, node]."""
    agents, n = members.agents, 0
    which, room, lasts = np.empty(agents.size, np.int64), np.empty(agents.size), members.step.copy()
    for f in range(agents.size):
        left, energy = room_left[agents[f]], energy_left[agents[f]]
        if is_able(members, f, room_left, energy):
            which[n], room[n] = f, np.inf if left == UNLIMITED else float(left)
            lasts[n] = max(1.0, energy / members.step[f]) + members.longest
            n += 1
    return Able(agents[which[:n]], members.kind[which[:n]], room[:n], lasts[:n])


@kernel
def _hold(
    members: Members,
    ways: tuple[Ways, ...],
    nothing: NDArray[np.float64],
    agent_node: Int32Array,
    room_left: NDArray[np.int64],
    energy_left: NDArray[np.float64],
    preferences: NDArray[np.float64],
) -> None:
    """As `Collecting.hold`; what is passed on the way (node,) is worth nothing."""
    for f in range(members.agents.size):
        agent = members.agents[f]
        if not is_able(members, f, room_left, energy_left[agent]):
            node = agent_node[agent]
            towards(ways[members.kind[f]], node, node, nothing, preferences[agent])


class Effort(NamedTuple):
    """Settings of the route search."""

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
    boundary: Boundary,
    ways: tuple[Ways, ...],
    able: Able,
    agent_node: Int32Array,
    agent_yaw: NDArray[np.float64],
    drift_rc: NDArray[np.float64],
    stay: bool,
    taking: Taking,
    found: Stops,
) -> Legs:
    """Put items into stops `found`, and list their distances for the foragers that are able.

    Parameters
    ----------
    agent_node, agent_yaw : (agent,) where they are, and their heading [rad]
    drift_rc : (item, 2) of each, or (1, 2) of all [node/step]
    stay, taking : see `Effort`
    """
    kind, agents, at = able.kind, able.agents, agent_node[able.agents]
    gather_stops(items, boundary, ways, kind, at, drift_rc, taking, found)
    n = found.number[0]
    first, between = decisions_between(found, ways, kind, at, stay)
    if n:
        add_pickup(taking, boundary, found, agents, at, agent_yaw[agents], first, between)
    return Legs(found.weight[:n], first, between, kind, able.room, able.lasts)


@kernel
def follow_routes(
    items: Floating,
    boundary: Boundary,
    ways: tuple[Ways, ...],
    able: Able,
    agent_node: Int32Array,
    first: NDArray[np.float64],
    target: NDArray[np.int64],
    scratch: Scratch,
    preferences: NDArray[np.float64],
) -> None:
    """Set the preferences (agent, 9) of the foragers that are able by the way to their stops.

    Parameters
    ----------
    first : (forager, stop) decisions, as in `Legs`
    target : (forager,) stop, `NOWHERE` for those that go to the nearest
    """
    kind, found, worth = able.kind, scratch.found, scratch.worth
    for i in range(items.number[0]):
        _, _, node = settled(boundary, items.row[i], items.col[i])
        worth[node] += items.weight[i]
    for f in range(target.size):
        goal = target[f] if target[f] != NOWHERE else _nearest(first, f)
        at, row = agent_node[able.agents[f]], preferences[able.agents[f]]
        towards(ways[kind[f]], at, found.node[goal], worth, row)
    worth[:] = 0.0


@kernel
def _send(
    members: Members,
    boundary: Boundary,
    ways: tuple[Ways, ...],
    effort: Effort,
    scratch: Scratch,
    items: Floating,
    agent_node: Int32Array,
    agent_yaw: NDArray[np.float64],
    drift_rc: NDArray[np.float64],
    room_left: NDArray[np.int64],
    energy_left: NDArray[np.float64],
    preferences: NDArray[np.float64],
) -> int:
    """As `Foraging.send`."""
    able = able_now(members, room_left, energy_left)
    about = items, boundary, ways, able, agent_node
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
    """Collectors, the items that they know of, and the limits of each.

    Attributes
    ----------
    group : agents, and the ways of each
    boundary : boundary condition of drifting items
    items : items to collect, filled by others
    taking : time that collecting takes
    """

    def __init__(self, task: Task, settings: BeliefSettings) -> None:
        self.group = Group.of(task, task.fleet.collectors)
        self.boundary = boundary_of(task.graph, task.walls)
        self.items = floating(max(4096, 5 * int(settings.items)))
        self.taking = Taking.of(task)
        agents, kind = self.group.agents, self.group.kind
        step = (USUAL_STEP * task.fleet.moves[agents]).astype(np.float64)
        self._members = Members(agents, kind, step, float(self.taking.first.max(initial=0.0)))
        nothing = np.zeros(len(task.graph))
        self._hold = BoundKernel(_hold, self._members, self.group.ways, nothing)
        self._able_now = BoundKernel(able_now, self._members)

    def able_now(self, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]) -> Able:
        """Foragers that can still collect, by the room and energy left (agent,)."""
        return self._able_now(room_left, energy_left)

    def is_able(
        self, agent: int, room_left: NDArray[np.int64], energy_left: NDArray[np.float64]
    ) -> bool:
        """True if one forager can still collect."""
        return bool((self.able_now(room_left, energy_left).agents == agent).any())

    def hold(
        self,
        agent_node: Int32Array,
        room_left: NDArray[np.int64],
        energy_left: NDArray[np.float64],
        preferences: NDArray[np.float64],
    ) -> None:
        """Let those foragers stay where they are that can collect no more."""
        self._hold(agent_node, room_left, energy_left, preferences)


class Foraging(Collecting):
    """Next nodes of collectors, given items and a drift."""

    def __init__(self, task: Task, settings: BeliefSettings) -> None:
        super().__init__(task, settings)
        nodes, members = len(task.graph), max(1, self.group.agents.size)
        self._scratch, taking = Scratch(stops(MOST, nodes), np.zeros(nodes)), self.taking
        effort = (
            Effort(task.rules.stay, settings.joint, 6, 5, 8 * members, taking)
            if settings.fast
            else Effort(task.rules.stay, settings.joint, 32, 10, 14 * members, taking)
        )
        about = self._members, self.boundary, self.group.ways, effort, self._scratch
        self._send = BoundKernel(_send, *about)

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

        Those that are full or out of energy are left out. Returns: number of stops; with none
        nothing is written.

        Parameters
        ----------
        agent_node, agent_yaw : (agent,) where they are, and their heading [rad]
        drift_rc : (item, 2) of each, or (1, 2) of all [node/step]
        room_left : (agent,) items; energy_left : (agent,) [node]
        """
        left = room_left, energy_left
        return self._send(self.items, agent_node, agent_yaw, drift_rc, *left, preferences)
