import itertools
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.base.compiled import TOLERANCE
from mjforage.graph_planner.belief_planner.boundary import boundary_of
from mjforage.graph_planner.belief_planner.routes import (
    NOWHERE,
    Legs,
    _rest,
    _rest_roughly,
    search_routes,
)
from mjforage.graph_planner.belief_planner.stops import (
    FAR,
    MOST,
    add_pickup,
    decisions_between,
    floating,
    gather_stops,
    stops,
)
from mjforage.graph_planner.belief_planner.taking import Taking, quays_beside
from mjforage.graph_planner.belief_planner.ways import ways_of
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.mission.moves import MoveRules
from tests.graph_planner.driver import float_item

F64 = NDArray[np.float64]


def routes(
    weight: F64,
    first: F64,
    between: F64,
    *effort: int,
    room: list[float] | None = None,
    lasts: list[float] | None = None,
) -> NDArray[np.int64]:
    """First stops of foragers of one kind, without limits unless given."""
    endless = [np.inf] * len(first)
    kind = np.zeros(len(first), np.int64)
    limits = np.array(room or endless), np.array(lasts or endless)
    return search_routes(Legs(weight, first, between, kind, *limits), *effort)


ONE_KIND = np.zeros(1, np.int64)


def cheapest(weight: F64, first: F64, between: F64) -> tuple[float, set[tuple[int, ...]]]:
    """Least sum of weighted times over all joint routes, and the first stops that attain it."""
    foragers, n = first.shape
    best, targets = np.inf, set[tuple[int, ...]]()
    for owner in itertools.product(range(foragers), repeat=n):
        for order in itertools.permutations(range(n)):
            clock, place, cost = [0.0] * foragers, [-1] * foragers, 0.0
            begun = [NOWHERE] * foragers
            for j in order:
                f = owner[j]
                clock[f] += first[f, j] if place[f] < 0 else between[0, place[f], j]
                begun[f] = j if place[f] < 0 else begun[f]
                place[f] = j
                cost += weight[j] * clock[f]
            if cost < best - 1e-9:
                best, targets = cost, set()
            if cost < best + 1e-9:
                targets.add(tuple(begun))
    return best, targets


def test_rough_prices_are_prices() -> None:
    """In any order of summing, to more digits than the margin has."""
    rng = np.random.default_rng(0)
    for n in (1, 7, 64):
        weight, others = rng.uniform(0, 2, n), rng.choice([3.0, 30.0, FAR], n)
        way = rng.integers(1, 40, n).astype(float)
        exact = _rest(weight, others, 5.0, way, 0.0)
        assert _rest_roughly(weight, others, 5.0, way) == pytest.approx(exact, rel=1e-12)
    assert 1.0 - 1e-6 < TOLERANCE < 1.0 - 1e-12


@pytest.mark.parametrize("seed", range(12))
def test_a_wide_beam_finds_the_best_joint_route(seed: int) -> None:
    """Points in the plane: the first stops are those of some route of the least cost."""
    rng = np.random.default_rng(seed)
    foragers, n = 1 + seed % 2, 5
    points, at = rng.uniform(0, 20, (n, 2)), rng.uniform(0, 20, (foragers, 2))
    first = np.ceil(np.abs(at[:, None] - points).max(axis=2)) + 1
    between = np.ceil(np.abs(points[:, None] - points).max(axis=2))[None] + 1
    weight = rng.integers(1, 4, n).astype(np.float64)
    found = routes(weight, first, between, 3000, n, 40)
    assert tuple(found.tolist()) in cheapest(weight, first, between)[1]


T = TypeVar("T")
Twin = tuple[frozenset[int], tuple[tuple[int, int], ...], int]


@dataclass(frozen=True)
class Route:
    """A joint route as a plain object: what the search keeps in arrays."""

    clock: tuple[float, ...]
    room: tuple[float, ...]
    at: tuple[int, ...]
    begun: tuple[int, ...]
    visited: frozenset[int]
    retired: frozenset[int]
    paid: float
    cost: float

    def twin(self, kind: NDArray[np.int64]) -> Twin:
        """Key of routes of which one is enough."""
        held = [
            (j, int(kind[f])) for f, j in enumerate(self.at) if j >= 0 and f not in self.retired
        ]
        return self.visited, tuple(sorted(held)), len(self.retired)


def put(values: tuple[T, ...], f: int, value: T) -> tuple[T, ...]:
    return (*values[:f], value, *values[f + 1 :])


def next_routes(legs: Legs, route: Route, choices: int) -> list[Route]:
    """All that the search tries from a route, in its order."""
    n, foragers = legs.weight.size, legs.kind.size
    f = min(range(foragers), key=lambda g: route.clock[g])
    if route.clock[f] >= FAR or len(route.visited) == n:
        return [route]

    def way(g: int, at: int) -> F64:
        row: F64 = legs.first[g] if at < 0 else legs.between[legs.kind[g], at]
        return row

    mine, others = way(f, route.at[f]), np.full(n, FAR)
    for g in range(foragers):
        if g != f and route.clock[g] < FAR:
            there = route.clock[g] + way(g, route.at[g])
            others = np.where(there <= legs.lasts[g], np.minimum(others, there), others)
    arrival = route.clock[f] + mine
    stops = [
        int(j)
        for j in np.argsort(mine / legs.weight, kind="stable")
        if j not in route.visited and mine[j] < FAR and arrival[j] <= legs.lasts[f]
    ][:choices]
    found = []
    for j in [*stops, NOWHERE] if not stops or foragers > 1 else stops:
        paid, free, visited, retired = route.paid, FAR, route.visited, route.retired
        begun, at, room = route.begun, route.at, route.room
        if j == NOWHERE:
            retired = retired | {f}
        else:
            taken = min(legs.weight[j], room[f])
            paid = paid + taken * arrival[j]
            paid = paid + (legs.weight[j] - taken) * others[j]
            free = arrival[j] if room[f] > legs.weight[j] else FAR
            visited = visited | {j}
            begun = put(begun, f, j) if begun[f] < 0 else begun
            at, room = put(at, f, j), put(room, f, room[f] - legs.weight[j])
        cost, on = paid, legs.between[legs.kind[f], max(j, 0)]
        for k in range(n):
            weight = 0.0 if k in visited else legs.weight[k]
            cost = cost + weight * min(others[k], free + on[k])
        clock = put(route.clock, f, free)
        found.append(Route(clock, room, at, begun, visited, retired, paid, cost))
    return found


def plainly_searched(legs: Legs, beam: int, choices: int, depth: int) -> list[int]:
    """`search_routes` by lists: to the full depth, every price exact, nothing ranked in advance."""
    foragers = legs.kind.size
    zero, nowhere = (0.0,) * foragers, (NOWHERE,) * foragers
    empty = frozenset[int]()
    kept = [Route(zero, tuple(legs.room), nowhere, nowhere, empty, empty, 0.0, 0.0)]
    for _ in range(min(depth, legs.weight.size + foragers)):
        after: list[Route] = []
        for route in kept:
            for other in next_routes(legs, route, choices):
                twin = other.twin(legs.kind)
                alike = any(r.twin(legs.kind) == twin and r.cost <= other.cost for r in after)
                if not alike and (len(after) < beam or other.cost < after[-1].cost):
                    after = sorted([*after, other], key=lambda r: r.cost)[:beam]
        kept = after
    return [int(j) for j in kept[0].begun]


@pytest.mark.parametrize("seed", range(60))
def test_the_search_is_a_plain_beam_search(seed: int) -> None:
    """With kinds of foragers that differ, room and energy that end, and stops out of reach."""
    rng = np.random.default_rng(seed)
    foragers, n = 1 + seed % 3, int(rng.integers(2, 9))
    kind = rng.integers(0, 2, foragers)
    between = rng.integers(1, 20, (2, n, n)).astype(float)
    between[rng.random(between.shape) < 0.1] = FAR
    legs = Legs(
        rng.choice([0.25, 0.5, 1.0, 3.0], n),
        rng.integers(1, 30, (foragers, n)).astype(float),
        between,
        kind,
        rng.choice([1.0, 2.0, 4.0, np.inf], foragers),
        rng.choice([12.0, 40.0, np.inf], foragers),
    )
    effort = int(rng.integers(1, 7)), int(rng.integers(1, 4)), 30
    assert search_routes(legs, *effort).tolist() == plainly_searched(legs, *effort)


def test_foragers_share_two_groups_instead_of_both_going_for_the_nearer() -> None:
    """On a line: foragers at 0; groups at 8 (three items) and at -9 (three items)."""
    place = np.array([8.0, 9.0, 10.0, -9.0, -10.0, -11.0])
    between = np.abs(place[:, None] - place)[None]
    first = np.tile(np.abs(place), (2, 1))
    target = routes(np.ones(6), first, between, 16, 6, 40)
    assert sorted(place[target].tolist()) == [-9.0, 8.0]


def test_a_forager_too_far_off_is_left_out() -> None:
    first, between = np.array([[1.0], [30.0]]), np.zeros((1, 1, 1))
    target = routes(np.ones(1), first, between, 8, 4, 10)
    assert target.tolist() == [0, NOWHERE]
    nothing = routes(np.ones(0), np.zeros((2, 0)), np.zeros((1, 0, 0)), 4, 4, 4)
    assert nothing.tolist() == [NOWHERE, NOWHERE]


def test_a_forager_is_counted_for_no_more_than_it_has_room_for() -> None:
    """On a line: foragers at 0 and 30; ten items at 4, one at 20. A full boat cannot take both."""
    place, at = np.array([4.0, 20.0]), np.array([0.0, 30.0])
    first, between = np.abs(at[:, None] - place), np.abs(place[:, None] - place)[None]
    weight = np.array([10.0, 1.0])
    assert routes(weight, first, between, 16, 4, 10).tolist() == [0, 1]
    assert routes(weight, first, between, 16, 4, 10, room=[np.inf, 1.0]).tolist() == [0, 1]
    close = np.array([[4.0, 20.0], [6.0, 26.0]])  # both near the ten
    assert routes(weight, close, between, 16, 4, 10, room=[10.0, 10.0])[0] == 0
    assert routes(weight, close, between, 16, 4, 10, room=[1.0, 10.0]).tolist() == [1, 0]


def test_a_forager_is_not_counted_on_beyond_its_energy() -> None:
    place, at = np.array([5.0, 12.0]), np.array([0.0, 40.0])
    first, between = np.abs(at[:, None] - place), np.abs(place[:, None] - place)[None]
    assert routes(np.ones(2), first, between, 16, 4, 10).tolist() == [0, NOWHERE]
    spent = routes(np.ones(2), first, between, 16, 4, 10, lasts=[6.0, np.inf])
    assert spent.tolist() == [0, 1]
    assert routes(np.ones(2), first[:1], between, 16, 4, 10, lasts=[3.0]).tolist() == [NOWHERE]


def test_sixty_four_stops_are_searched() -> None:
    place = np.arange(64.0)
    between = np.abs(place[:, None] - place)[None] + 1
    target = routes(np.ones(64), (place + 1)[None], between, 8, 4, 70)
    assert target[0] == 0


SEA = navigation_graph(np.ones((40, 40), np.bool_), 1.0, False)
AT_ONCE = Taking(np.zeros((2, 3, 4)), np.zeros(3), 0.0)
FORAGER = 0.1 * np.arange(12.0).reshape(3, 4)  # after a scout, which takes nothing
HULLS = Taking(np.stack((np.full((3, 4), 9.0), FORAGER)), np.array([0.0, 0.2, 1.5]), 0.5)
BOUNDARY, WAYS = boundary_of(SEA), (ways_of(SEA, 1, MoveRules(True, True)),)


def test_stops_are_where_items_are_met_and_add_up_their_weights() -> None:
    """Forager at (20, 0); drift 0.1 southwards: ten decisions away, an item moved 0.9 node."""
    items, found = floating(10), stops(MOST, len(SEA))
    at = SEA.node_of_cell[20:21, 0].copy()
    for row, col, weight in ((20.0, 10.0, 1.0), (20.1, 10.2, 0.5), (5.0, 1.0, 1.0)):
        float_item(items, row, col, weight)
    gather_stops(items, BOUNDARY, WAYS, ONE_KIND, at, np.array([[0.1, 0.0]]), AT_ONCE, found)
    cells = [(int(SEA.rows[v]), int(SEA.cols[v])) for v in found.node[: found.number[0]]]
    assert cells == [(21, 10), (6, 1)]  # the sooner per worth first
    assert found.weight[:2].tolist() == [1.5, 1.0]
    assert (found.place == -1).all()
    first, between = decisions_between(found, WAYS, ONE_KIND, at, True)
    assert first.tolist() == [[10.0, 14.0]] and between[0, 0, 1] == between[0, 1, 0] == 15.0


def test_items_that_drift_each_their_own_way_are_met_where_each_will_be() -> None:
    """As above, the second by .2 to the east: nine tenths of ten decisions, 1.8 nodes."""
    items, found = floating(10), stops(MOST, len(SEA))
    at = SEA.node_of_cell[20:21, 0].copy()
    for row in (20.0, 24.0):
        float_item(items, row, 10.0, 1.0)
    drift = np.array([[0.1, 0.0], [0.0, 0.2]])
    gather_stops(items, BOUNDARY, WAYS, ONE_KIND, at, drift, AT_ONCE, found)
    cells = {(int(SEA.rows[v]), int(SEA.cols[v])) for v in found.node[: found.number[0]]}
    assert cells == {(21, 10), (24, 12)}


def test_an_item_in_the_foragers_own_node_takes_a_decision_or_two() -> None:
    items, found = floating(2), stops(MOST, len(SEA))
    at = SEA.node_of_cell[20:21, 7].copy()
    float_item(items, 20.0, 7.0, 1.0)
    gather_stops(items, BOUNDARY, WAYS, ONE_KIND, at, np.array([[0.1, 0.0]]), AT_ONCE, found)
    assert decisions_between(found, WAYS, ONE_KIND, at, True)[0][0, 0] == 1.0
    assert decisions_between(found, WAYS, ONE_KIND, at, False)[0][0, 0] == 2.0


def test_of_too_many_items_the_soonest_per_worth_become_stops() -> None:
    items, found = floating(1600), stops(MOST, len(SEA))
    at = SEA.node_of_cell[0:1, 0].copy()
    for node in range(len(SEA)):
        float_item(items, SEA.rows[node], SEA.cols[node], 1.0)
    gather_stops(items, BOUNDARY, WAYS, ONE_KIND, at, np.zeros((1, 2)), AT_ONCE, found)
    assert found.number[0] == MOST
    assert max(SEA.rows[found.node].max(), SEA.cols[found.node].max()) == 7


def test_hulls_stay_longer_the_more_there_is() -> None:
    """Three items in open water, one in the corner of the sea: from the three it takes longer."""
    at = SEA.node_of_cell[20:21, 20].copy()
    for taking, longer in ((AT_ONCE, 0.0), (HULLS, 1.0)):
        items, found = floating(4), stops(MOST, len(SEA))
        for row, col in ((20.0, 25.0), (20.1, 25.0), (20.2, 25.0), (39.45, 39.45)):
            float_item(items, row, col, 1.0)
        gather_stops(items, BOUNDARY, WAYS, ONE_KIND, at, np.zeros((1, 2)), taking, found)
        between = decisions_between(found, WAYS, ONE_KIND, at, True)[1][0]
        assert between[0, 1] - 19.0 == pytest.approx(longer)
        assert between[1, 0] - 19.0 == 0.0


def test_hulls_lose_time_over_quays_and_turning_to_what_lies_behind_them_in_the_next_node() -> None:
    """A forager at (20, 20) heads north-north-west; in open water the quarters cost 0 to 0.3.

    The node to the west lies 67 degrees off, that to the south-east 157, to the east 113. Elsewhere
    it is the usual time, in the corner of the sea 1.5 decisions more.
    """
    at, yaw = SEA.node_of_cell[20:21, 20].copy(), np.array([0.625 * np.pi])
    agents, cells = np.ones(1, np.int64), [(20, 19), (21, 21), (20, 21), (23, 20), (20, 20)]
    places = [*cells, (39.45, 39.45)]
    for taking, expected in (
        (AT_ONCE, [0.0] * 6),
        (HULLS, [0.1, 0.3, 0.2, 0.0, 0.0, 1.5]),
    ):
        items, found = floating(6), stops(MOST, len(SEA))
        for row, col in places:
            float_item(items, row, col, 1.0)
        gather_stops(items, BOUNDARY, WAYS, ONE_KIND, at, np.zeros((1, 2)), taking, found)
        before = decisions_between(found, WAYS, ONE_KIND, at, True)
        first, between = before[0].copy(), before[1].copy()
        add_pickup(taking, BOUNDARY, found, agents, at, yaw, first, between)
        number = {int(node): j for j, node in enumerate(found.node[:6])}
        order = [number[int(SEA.node_of_cell[cell])] for cell in (*cells, (39, 39))]
        assert (first - before[0])[0, order] == pytest.approx(expected)
        usual = [0.0] * 5 + [expected[-1]]
        assert (between - before[1])[0, 0, order] == pytest.approx(usual)


def test_quays_beside_an_item_are_counted() -> None:
    corner, side = int(SEA.node_of_cell[39, 39]), int(SEA.node_of_cell[39, 20])
    assert quays_beside(BOUNDARY, 39.45, 39.45, corner) == 2
    assert quays_beside(BOUNDARY, 39.45, 39.0, corner) == 1
    assert quays_beside(BOUNDARY, 38.6, 38.6, corner) == 0
    assert quays_beside(BOUNDARY, 39.45, 20.45, side) == 1
