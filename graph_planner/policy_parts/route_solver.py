"""Routes of a team by OR-tools' routing solver, where that is installed.

Team orienteering (I. M. Chao, B. L. Golden and E. A. Wasil, "The team orienteering problem",
European Journal of Operational Research 88, 1996) whose profits fall with time: a stop of w items
that is met in decision t of a horizon L earns w (L - t), one that is left out nothing.

A solve ends in a local optimum or after a number of solutions, never by a clock, so that the same
stops give the same routes.
"""

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from mjforage.base.extras import require
from mjforage.graph_planner.belief_planner.routes import Legs

_TICKS = 10  # parts of a decision that the solver, which counts in integers, tells apart
_SHARES = 100  # parts of an item that it tells apart
_NEVER_S = 10**9  # no sub-search of the solver may be cut off by its clock
_DEAR = (  # searches of the neighbourhood that took long and found little: half the time without
    *("relocate_pair", "light_relocate_pair", "exchange_pair", "relocate_subtrip"),
    *("exchange_subtrip", "relocate_expensive_chain", "lin_kernighan", "make_chain_inactive"),
    *("global_cheapest_insertion_path_lns", "local_cheapest_insertion_path_lns"),
    *("relocate_path_global_cheapest_insertion_insert_unperformed", "shortest_path_swap_active"),
)


class Library(NamedTuple):
    """The parts of OR-tools that are used."""

    solver: ModuleType  # ortools.constraint_solver.pywrapcp
    enums: ModuleType  # ortools.constraint_solver.routing_enums_pb2
    switches: ModuleType  # ortools.util.optional_boolean_pb2


def routing_library() -> Library:
    """OR-tools. Raises `UserError` if it is not installed."""
    require("policy orienteering", "ortools")
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2
    from ortools.util import optional_boolean_pb2

    return Library(pywrapcp, routing_enums_pb2, optional_boolean_pb2)


def _parameters(library: Library, solutions: int) -> Any:
    """Search parameters: from insertions downhill to a local optimum."""
    found = library.solver.DefaultRoutingSearchParameters()
    strategies = library.enums.FirstSolutionStrategy
    found.first_solution_strategy = strategies.PARALLEL_CHEAPEST_INSERTION
    found.local_search_metaheuristic = library.enums.LocalSearchMetaheuristic.GREEDY_DESCENT
    found.solution_limit = solutions
    found.lns_time_limit.seconds = _NEVER_S
    found.fallback_to_cp_sat_size_threshold = 0
    for name in _DEAR:
        setattr(found.local_search_operators, f"use_{name}", library.switches.BOOL_FALSE)
    return found


def _ticks(legs: Legs, kind: int, horizon: float) -> list[list[int]]:
    """Ticks (place, place) from place to place: stops, then starts, then the end."""
    foragers, n = legs.first.shape
    ways = np.zeros((n + foragers + 1, n + foragers + 1))
    ways[:n, :n], ways[n : n + foragers, :n] = legs.between[kind], legs.first
    ticks: list[list[int]] = np.rint(np.minimum(ways, 2.0 * horizon) * _TICKS).astype(int).tolist()
    return ticks


def _limit_room(routing: Any, legs: Legs) -> None:
    """Limit every forager's route to its room; a stop is no more than the least room."""
    finite = legs.room[np.isfinite(legs.room)]
    if not finite.size:
        return
    others = legs.first.shape[0] + 1
    shares = np.rint(np.minimum(legs.weight, finite.min()) * _SHARES).astype(int).tolist()
    load = routing.RegisterUnaryTransitVector(shares + [0] * others)
    most = float(finite.sum() + legs.weight.sum())
    rooms = np.rint(np.minimum(legs.room, most) * _SHARES).astype(int).tolist()
    routing.AddDimensionWithVehicleCapacity(load, 0, rooms, True, "room")


def solve_routes(library: Library, legs: Legs, horizon: float, solutions: int) -> list[list[int]]:
    """The stops that each forager goes to, in order.

    Returns: for each forager the numbers of its stops.

    Parameters
    ----------
    legs : stops and how far they are
    horizon : decisions after which items earn nothing
    solutions : how many solutions, each better than the last, are tried at most
    """
    foragers, n = legs.first.shape
    if n == 0 or foragers == 0:
        return [[] for _ in range(foragers)]
    starts, end = list(range(n, n + foragers)), n + foragers
    manager = library.solver.RoutingIndexManager(end + 1, foragers, starts, [end] * foragers)
    routing = library.solver.RoutingModel(manager)
    kinds = [
        routing.RegisterTransitMatrix(_ticks(legs, kind, horizon))
        for kind in range(legs.between.shape[0])
    ]
    ways = [kinds[kind] for kind in legs.kind.tolist()]
    lasts = np.floor(np.minimum(legs.lasts, horizon) * _TICKS).astype(int).tolist()
    routing.AddDimensionWithVehicleTransitAndCapacity(ways, 0, lasts, True, "time")
    for f, way in enumerate(ways):
        routing.SetArcCostEvaluatorOfVehicle(way, f)
    _limit_room(routing, legs)
    clock = routing.GetDimensionOrDie("time")
    worth = np.maximum(1, np.rint(legs.weight * _SHARES)).astype(int).tolist()
    for stop in range(n):
        index = manager.NodeToIndex(stop)
        clock.SetCumulVarSoftUpperBound(index, 0, worth[stop])
        routing.AddDisjunction([index], worth[stop] * int(horizon * _TICKS))
    answer = routing.SolveWithParameters(_parameters(library, solutions))
    return [_route(manager, routing, answer, f) for f in range(foragers)]


def _route(manager: Any, routing: Any, answer: Any, forager: int) -> list[int]:
    """Stops of one forager in a solution; none where there is no solution."""
    if answer is None:
        return []
    stops, index = [], answer.Value(routing.NextVar(routing.Start(forager)))
    while not routing.IsEnd(index):
        stops.append(int(manager.IndexToNode(index)))
        index = answer.Value(routing.NextVar(index))
    return stops
