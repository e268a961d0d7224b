"""Routes by OR-tools: against all routes tried one by one, limits, reproducibility, absence."""

import itertools
import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.errors import UserError
from mjforage.graph_planner.belief_planner.routes import Legs
from mjforage.graph_planner.belief_planner.stops import FAR
from mjforage.graph_planner.policies import create_policy
from mjforage.graph_planner.policy_parts.route_solver import routing_library, solve_routes

F64 = NDArray[np.float64]


def legs_of(
    places: F64, weight: list[float], foragers: int, room: float = np.inf, lasts: float = 1e3
) -> Legs:
    """Chebyshev ways between places (forager and stop, 2), those of the foragers first."""
    ways = np.ceil(np.abs(places[:, None] - places[None]).max(axis=-1))
    return Legs(
        np.array(weight),
        ways[:foragers, foragers:].copy(),
        ways[None, foragers:, foragers:].copy(),
        np.zeros(foragers, np.int64),
        np.full(foragers, room),
        np.full(foragers, lasts),
    )


def earned(legs: Legs, routes: list[list[int]], horizon: float) -> float:
    """Sum over stops of weight times what is left of the horizon when they are met."""
    total = 0.0
    for f, route in enumerate(routes):
        clock, last = 0.0, -1
        for stop in route:
            clock += legs.first[f, stop] if last < 0 else legs.between[legs.kind[f], last, stop]
            total += float(legs.weight[stop]) * (horizon - clock)
            last = stop
            assert clock <= min(horizon, legs.lasts[f])
    return total


def best(legs: Legs, horizon: float) -> float:
    """The most that any two routes earn."""
    n, most = legs.weight.size, 0.0
    for order in itertools.permutations(range(n)):
        for cut in range(n + 1):
            for drop in range(n - cut + 1):
                routes = [list(order[:cut]), list(order[cut : n - drop])]
                try:
                    most = max(most, earned(legs, routes, horizon))
                except AssertionError:
                    continue
    return most


@pytest.mark.parametrize("horizon", [12.0, 60.0])
def test_routes_earn_nearly_the_most_and_visit_nothing_twice(horizon: float) -> None:
    library, rng, shares = routing_library(), np.random.default_rng(5), []
    for _ in range(12):
        legs = legs_of(rng.uniform(0, 15, (7, 2)), rng.uniform(0.3, 3.0, 5).tolist(), 2)
        routes = solve_routes(library, legs, horizon, 1000)
        visited = [stop for route in routes for stop in route]
        assert len(set(visited)) == len(visited)
        shares.append(earned(legs, routes, horizon) / best(legs, horizon))
    assert np.mean(shares) > 0.99 and max(shares) <= 1.0 + 1e-9


def test_early_items_are_worth_more_than_short_routes() -> None:
    """The heavy stop comes first although the route is longer that way."""
    places = np.array([(0.0, 10.0), (0.0, 5.0), (0.0, 16.0)])
    legs = legs_of(places, [1.0, 9.0], 1)
    assert solve_routes(routing_library(), legs, 80.0, 1000) == [[1, 0]]
    assert solve_routes(routing_library(), legs_of(places, [1.0, 1.0], 1), 80.0, 1000) == [[0, 1]]


def test_room_energy_and_reach_are_kept() -> None:
    places = np.array([(0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (0.0, 3.0), (0.0, 4.0)])
    library, weight = routing_library(), [1.0] * 4
    assert solve_routes(library, legs_of(places, weight, 1), 80.0, 1000) == [[0, 1, 2, 3]]
    assert solve_routes(library, legs_of(places, weight, 1, room=2.0), 80.0, 1000) == [[0, 1]]
    assert solve_routes(library, legs_of(places, weight, 1, lasts=3.0), 80.0, 1000) == [[0, 1, 2]]
    assert solve_routes(library, legs_of(places, [3.0] * 4, 1, room=1.0), 80.0, 1000) == [[0]]
    apart = legs_of(places, weight, 1)
    apart.first[0, 3] = apart.between[0, :, 3] = FAR
    assert solve_routes(library, apart, 80.0, 1000) == [[0, 1, 2]]


def test_nothing_to_route() -> None:
    library = routing_library()
    assert solve_routes(library, legs_of(np.zeros((2, 2)), [], 2), 80.0, 1000) == [[], []]
    assert solve_routes(library, legs_of(np.zeros((1, 2)), [1.0], 0), 80.0, 1000) == []


def test_the_same_stops_have_the_same_routes_and_few_solutions_suffice() -> None:
    rng, library = np.random.default_rng(1), routing_library()
    legs = legs_of(rng.uniform(0, 30, (27, 2)), [1.0] * 25, 2)
    answers = [solve_routes(library, legs, 80.0, 1000) for _ in range(3)]
    assert answers[0] == answers[1] == answers[2]
    first = solve_routes(library, legs, 80.0, 1)
    assert 0.0 < earned(legs, first, 80.0) < earned(legs, answers[0], 80.0)


def test_without_or_tools_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == "ortools"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "ortools", None)
    with pytest.raises(UserError, match=r"pip install 'mjforage\[orienteering\]'") as refused:
        create_policy("orienteering")
    assert "\n" not in str(refused.value)
