"""Routes of the foragers together, by which items are met early.

A beam search over joint routes. In every state the forager that is free first goes on to one of
its best stops (decisions per item, the ratio rule of W. E. Smith, "Various optimizers for
single-stage production", 1956), or goes nowhere any more. A state is judged by the sum over all
items of the decision in which each is met; for those not yet on a route, by when the first forager
could be there. A forager takes no more than it has room for and goes no farther than its energy
lasts; what it leaves of a stop is charged as if the next one came for it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import TOLERANCE, inlined, kernel, reassociating
from mjforage.graph_planner.belief_planner.beam import free_slot, insert, limit
from mjforage.graph_planner.belief_planner.stops import FAR

NOWHERE = -1
NOBODY = -1
_ONE = np.uint64(1)
_ODD = np.uint64(0x9E3779B97F4A7C15)
_RETIRED = np.uint64(7)  # what a forager that goes nowhere any more adds to a mark


class Legs(NamedTuple):
    """Stops to collect from, and the ways between them."""

    weight: NDArray[np.float64]  # (stop,) items at each
    first: NDArray[np.float64]  # (forager, stop) decisions from where the foragers are
    between: NDArray[np.float64]  # (kind, stop, stop) decisions from stop to stop
    kind: NDArray[np.int64]  # (forager,) which layer of `between`
    room: NDArray[np.float64]  # (forager,) items that it can still take aboard
    lasts: NDArray[np.float64]  # (forager,) decisions that its energy lasts for


class States(NamedTuple):
    """A generation of joint routes, the cheapest first."""

    clock: NDArray[np.float64]  # (state, forager) decision in which it is free; `FAR`: never again
    room: NDArray[np.float64]  # (state, forager) items that it can still take aboard
    at: NDArray[np.int64]  # (state, forager) its last stop, -1 where it started
    begun: NDArray[np.int64]  # (state, forager) its first stop, -1 none yet
    visited: NDArray[np.uint64]  # (state,) a bit per stop
    paid: NDArray[np.float64]  # (state,) sum over the items on the routes of when they are met
    cost: NDArray[np.float64]  # (state,) the same plus the least for all others
    mark: NDArray[np.uint64]  # (state,) sum of `_mark` over the foragers


class Steps(NamedTuple):
    """The best next steps found so far, in slots as in `beam`."""

    order: NDArray[np.int64]  # (slot,)
    cost: NDArray[np.float64]  # (slot,) of the state that the step leads to
    name: NDArray[np.uint64]  # (slot,) of that state: equal where the same is visited and held
    parent: NDArray[np.int64]  # (slot,) the state that it starts from
    who: NDArray[np.int64]  # (slot,) the forager that goes, `NOBODY` if the state stays as it is
    stop: NDArray[np.int64]  # (slot,) where it goes, `NOWHERE` if it retires
    free: NDArray[np.float64]  # (slot,) decision in which it is free then, `FAR` if never again
    paid: NDArray[np.float64]  # (slot,) as in `States`, of the state that the step leads to


class Outlook(NamedTuple):
    """The stops as a state sees them, for the forager that is next."""

    weight: NDArray[np.float64]  # (stop,) items there; 0 if visited
    arrival: NDArray[np.float64]  # (stop,) decision in which it could be there
    others: NDArray[np.float64]  # (stop,) decision in which the first of the others could, or FAR


class Ranking(NamedTuple):
    """Ranks of the stops from a forager's place, by decisions per item; filled on demand."""

    known: NDArray[np.bool_]  # (place,) places: where foragers start, then (kind, stop)
    stops: NDArray[np.int64]  # (place, stop) the best first


@inlined
def _mark(stop: int, kind: int) -> np.uint64:
    """A number for a forager's place that adds up the same whatever the order of foragers."""
    value = np.uint64(stop + 2 + 1009 * kind) * _ODD
    value = (value ^ (value >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return value ^ (value >> np.uint64(32))


@kernel
def _states(beam: int, room: NDArray[np.float64]) -> States:
    """Memory for a generation; in its first state every forager is where it started."""
    foragers = room.size
    return States(
        np.zeros((beam, foragers)),
        np.zeros((beam, foragers)) + room,
        np.full((beam, foragers), -1),
        np.full((beam, foragers), -1),
        np.zeros(beam, np.uint64),
        np.zeros(beam),
        np.zeros(beam),
        np.zeros(beam, np.uint64),
    )


@kernel
def _steps(beam: int) -> Steps:
    """Room for the steps of one generation."""
    return Steps(
        np.zeros(beam, np.int64),
        np.zeros(beam),
        np.zeros(beam, np.uint64),
        np.zeros(beam, np.int64),
        np.zeros(beam, np.int64),
        np.zeros(beam, np.int64),
        np.zeros(beam),
        np.zeros(beam),
    )


@inlined
def _first_free(clock: NDArray[np.float64], s: int) -> int:
    """The forager of a state that is free first."""
    f = 0
    for g in range(1, clock.shape[1]):
        if clock[s, g] < clock[s, f]:
            f = g
    return f


@kernel
def _see(
    worth: NDArray[np.float64],
    visited: np.uint64,
    way: NDArray[np.float64],
    clock: float,
    outlook: Outlook,
) -> None:
    """Fill an outlook but for what the others can do: ways (stop,) begin where the forager is."""
    weight, arrival, others = outlook.weight, outlook.arrival, outlook.others
    for j in range(worth.size):
        weight[j] = worth[j] if (visited >> np.uint64(j)) & _ONE == 0 else 0.0
        arrival[j] = clock + way[j]
        others[j] = FAR


@kernel
def _see_another(
    way: NDArray[np.float64], clock: float, lasts: float, others: NDArray[np.float64]
) -> None:
    """Lower the decisions (stop,) in which others could be there by those of one of them."""
    for j in range(others.size):
        there = clock + way[j]
        others[j] = there if there <= lasts and there < others[j] else others[j]


@kernel
def _rank(
    ranking: Ranking, place: int, way: NDArray[np.float64], worth: NDArray[np.float64]
) -> NDArray[np.int64]:
    """(stop,) the stops by decisions per item from a place from which the ways (stop,) are."""
    if not ranking.known[place]:
        ranking.known[place] = True
        ranking.stops[place] = np.argsort(way / worth, kind="mergesort")
    ranked: NDArray[np.int64] = ranking.stops[place]
    return ranked


@inlined
def _choose(
    ranked: NDArray[np.int64],
    weight: NDArray[np.float64],
    way: NDArray[np.float64],
    arrival: NDArray[np.float64],
    lasts: float,
    candidates: NDArray[np.int64],
) -> int:
    """Fill `candidates` with the best stops that are open and within reach; their number."""
    number = 0
    for j in ranked:
        if weight[j] > 0.0 and way[j] < FAR and arrival[j] <= lasts:
            candidates[number] = j
            number += 1
            if number == candidates.size:
                break
    return number


@reassociating
def _rest_roughly(
    weight: NDArray[np.float64], others: NDArray[np.float64], free: float, way: NDArray[np.float64]
) -> float:
    """`_rest` without its price, to some digits."""
    total = 0.0
    for j in range(weight.size):
        own = free + way[j]
        total += weight[j] * (own if own < others[j] else others[j])
    return total


@inlined
def _rest(
    weight: NDArray[np.float64],
    others: NDArray[np.float64],
    free: float,
    way: NDArray[np.float64],
    price: float,
) -> float:
    """A price plus, for every stop, its weight by when it can be met first."""
    for j in range(weight.size):
        price += weight[j] * min(others[j], free + way[j])
    return price


@inlined
def _has_twin(
    names: NDArray[np.uint64], cost: NDArray[np.float64], count: int, name: np.uint64, price: float
) -> bool:
    """True if a step to the same state is kept that is no dearer."""
    found = False
    for slot in range(count):
        if names[slot] == name and cost[slot] <= price:
            found = True
            break
    return found


@kernel
def _grow(
    legs: Legs,
    states: States,
    number: int,
    outlook: Outlook,
    ranking: Ranking,
    candidates: NDArray[np.int64],
    steps: Steps,
) -> tuple[int, bool]:
    """Try what can be done next in every state, and keep the best steps.

    Returns: steps kept, and whether any of the routes could go on.
    """
    worth, first, between, kind = legs.weight, legs.first, legs.between, legs.kind
    clock, at, visited, room = states.clock, states.at, states.visited, states.room
    weight, arrival, others = outlook.weight, outlook.arrival, outlook.others
    order, cost, names, lasts = steps.order, steps.cost, steps.name, legs.lasts
    parents, whos, goals, frees = steps.parent, steps.who, steps.stop, steps.free
    count, goes_on, everything = 0, False, ~np.uint64(0) >> np.uint64(64 - worth.size)
    for s in range(number):
        f, stops = _first_free(clock, s), 0
        complete = clock[s, f] >= FAR or visited[s] == everything
        if not complete:
            here = at[s, f]
            way = first[f] if here < 0 else between[kind[f], here]
            _see(worth, visited[s], way, clock[s, f], outlook)
            place = f if here < 0 else kind.size + kind[f] * worth.size + here
            ranked = _rank(ranking, place, way, worth)
            stops = _choose(ranked, weight, way, arrival, lasts[f], candidates)
            for g in range(clock.shape[1]):
                if g != f and clock[s, g] < FAR:
                    way = first[g] if at[s, g] < 0 else between[kind[g], at[s, g]]
                    _see_another(way, clock[s, g], lasts[g], others)
        goes_on = goes_on or not complete
        others_mark = states.mark[s]  # the marks of those who stay where they are
        if not complete and at[s, f] >= 0:
            others_mark -= _mark(at[s, f], kind[f])
        for c in range(stops + (1 if complete or stops == 0 or clock.shape[1] > 1 else 0)):
            j, free, paid, met, who = NOWHERE, FAR, states.paid[s], visited[s], f
            mark, weight_there = others_mark + _RETIRED, 0.0
            if complete:
                who, mark = NOBODY, others_mark
            elif c < stops:
                j = candidates[c]
                weight_there, amount = weight[j], min(weight[j], room[s, f])
                paid += amount * arrival[j]
                paid += (weight_there - amount) * others[j]
                free = arrival[j] if room[s, f] > weight_there else FAR
                met |= _ONE << np.uint64(j)
                mark = others_mark + _mark(j, kind[f])
            name, enough = mark + met * _ODD, limit(order, cost, count)
            price = states.cost[s]
            if not complete:
                way_on = between[kind[f], max(j, 0)]
                weight[max(j, 0)] -= weight_there  # it is not among the rest
                price = paid + TOLERANCE * _rest_roughly(weight, others, free, way_on)
                if price < enough:
                    price = _rest(weight, others, free, way_on, paid)
                weight[max(j, 0)] += weight_there
            if price < enough and not _has_twin(names, cost, count, name, price):
                slot = free_slot(order, count)
                cost[slot], names[slot] = price, name
                parents[slot], whos[slot], goals[slot] = s, who, j
                frees[slot], steps.paid[slot] = free, paid
                count = insert(order, cost, count, slot)
    return count, goes_on


@kernel
def _follow(legs: Legs, states: States, steps: Steps, count: int, after: States) -> None:
    """Make the next generation `after` from the states and the steps kept."""
    clock, room, at, begun = after.clock, after.room, after.at, after.begun
    visited, parent, who, goal = after.visited, steps.parent, steps.who, steps.stop
    for i in range(count):
        slot = steps.order[i]
        s, f, j = parent[slot], who[slot], goal[slot]
        for g in range(clock.shape[1]):
            clock[i, g], room[i, g] = states.clock[s, g], states.room[s, g]
            at[i, g], begun[i, g] = states.at[s, g], states.begun[s, g]
        visited[i] = states.visited[s]
        if f != NOBODY:
            clock[i, f] = steps.free[slot]
        if j != NOWHERE:
            room[i, f] -= legs.weight[j]
            visited[i] |= _ONE << np.uint64(j)
            at[i, f] = j
            begun[i, f] = j if begun[i, f] < 0 else begun[i, f]
        after.cost[i], after.paid[i] = steps.cost[slot], steps.paid[slot]
        after.mark[i] = steps.name[slot] - visited[i] * _ODD


@kernel
def _begin_alike(states: States, number: int) -> bool:
    """True if all of some states have the same first stops, which none that follows can change."""
    clock, begun = states.clock, states.begun
    for i in range(number):
        for f in range(begun.shape[1]):
            if begun[i, f] != begun[0, f] or (begun[i, f] < 0 and clock[i, f] < FAR):
                return False
    return True


@kernel
def search_routes(legs: Legs, beam: int, choices: int, depth: int) -> NDArray[np.int64]:
    """The stop that each forager goes to first in the best joint route found.

    Returns: (forager,) stop, `NOWHERE` for a forager that is better left out.

    Parameters
    ----------
    legs : of at most 64 stops
    beam : states kept
    choices : stops tried from a state
    depth : stops in a route, over all foragers
    """
    foragers, n = legs.first.shape
    if n == 0 or foragers == 0:
        return np.full(foragers, NOWHERE, np.int64)
    states, after, number = _states(beam, legs.room), _states(beam, legs.room), 1
    steps, candidates = _steps(beam), np.empty(choices, np.int64)
    outlook = Outlook(np.zeros(n), np.zeros(n), np.zeros(n))
    places = foragers + legs.between.shape[0] * n
    ranking = Ranking(np.zeros(places, np.bool_), np.zeros((places, n), np.int64))
    for _ in range(min(depth, n + foragers)):
        count, goes_on = _grow(legs, states, number, outlook, ranking, candidates, steps)
        if not goes_on:
            break
        _follow(legs, states, steps, count, after)
        number = count
        states, after = after, states
        if _begin_alike(states, number):
            break
    begun: NDArray[np.int64] = states.begun[0].copy()
    return begun
