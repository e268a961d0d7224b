"""Team orienteering in a rolling horizon: routes of all foragers by OR-tools' routing solver.

I. M. Chao, B. L. Golden and E. A. Wasil, "The team orienteering problem", European Journal of
Operational Research 88, 1996; routes are solved anew every few decisions (`route_solver`). Items
are where tracks and drift put them when the first forager can be there; drift and unseen items are
believed as the belief planner believes them, scouts look where most is expected (`tracking_team`).
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.option_ranges import check_at_least, check_positive
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.foraging import Able
from mjforage.graph_planner.belief_planner.routes import Legs
from mjforage.graph_planner.belief_planner.stops import (
    add_pickup,
    decisions_between,
    gather_stops,
    stops,
)
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.route_solver import routing_library, solve_routes
from mjforage.graph_planner.policy_parts.tracking_team import TrackingTeam
from mjforage.mission.task import Observation, Task


@register("orienteering")
class OrienteeringPolicy:
    """Routes of all foragers by OR-tools' routing solver (an extra), anew every few decisions.

    Parameters
    ----------
    every : decisions from solve to solve, unless a forager has been everywhere on its route
    stops : nodes with items that are routed at most, those that are met soonest per item
    horizon : decisions after which items earn nothing
    solutions : solutions, each better than the last, that a solve tries at most
    patience : added to the time of a scout's way in its bids; larger: it goes farther [decision]
    """

    libraries = ("ortools",)  # beside those that every run computes with

    def __init__(
        self,
        every: int = 3,
        stops: int = 30,
        horizon: float = 80.0,
        solutions: int = 1000,
        patience: float = 4.0,
    ) -> None:
        counts = {"every": every, "stops": stops, "solutions": solutions}
        check_at_least("orienteering", 1, horizon=horizon, **counts)
        check_positive("orienteering", patience=patience)
        self._every, self._most, self._patience = every, stops, float(patience)
        self._search = float(horizon), solutions
        routing_library()

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._team, self._task = TrackingTeam(task, keys, self._patience), task
        self._found = stops(self._most, len(task.graph))
        foragers = task.fleet.collectors.size
        self._due = np.zeros(keys.size, np.int64)  # (row,) step of the next solve
        self._routes: list[list[list[int]]] = [[[] for _ in range(foragers)] for _ in keys]

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): down the way to the next stop of each route."""
        return self._team.act(observation, self._give_goals)

    def forecast(self) -> NDArray[np.float64]:
        """(row, node) items expected, known and unseen ones, as of the last answer."""
        return self._team.beliefs.forecast()

    def _give_goals(self, seen: Observation, e: int, goals: Int32Array) -> None:
        collecting, routes = self._team.collecting, self._routes[e]
        able, at = collecting.able_now(seen.room_left[e], seen.energy_left[e]), seen.agent_node[e]
        members = np.flatnonzero(np.isin(collecting.group.agents, able.agents)).tolist()
        for f in members:
            if routes[f] and routes[f][0] == at[collecting.group.agents[f]]:
                routes[f].pop(0)
        if seen.step[e] >= self._due[e] or any(not routes[f] for f in members):
            for f, route in zip(members, self._solve(seen, e, able), strict=True):
                routes[f] = route
            self._due[e] = seen.step[e] + self._every
        for f in members:
            if routes[f]:
                goals[f] = routes[f][0]

    def _solve(self, seen: Observation, e: int, able: Able) -> list[list[int]]:
        """Nodes of the route of each forager that is able."""
        collecting, found, at = self._team.collecting, self._found, seen.agent_node[e][able.agents]
        if not able.agents.size:
            return []
        ways, taking, boundary = collecting.group.ways, collecting.taking, collecting.boundary
        drift = self._team.beliefs.wind.mean[e : e + 1]
        gather_stops(collecting.items, boundary, ways, able.kind, at, drift, taking, found)
        first, between = decisions_between(found, ways, able.kind, at, self._task.rules.stay)
        yaw = seen.agent_yaw[e][able.agents]
        add_pickup(taking, boundary, found, able.agents, at, yaw, first, between)
        weight = found.weight[: found.number[0]]
        legs = Legs(weight, first, between, able.kind, able.room, able.lasts)
        routes = solve_routes(routing_library(), legs, *self._search)
        return [[int(found.node[stop]) for stop in route] for route in routes]
