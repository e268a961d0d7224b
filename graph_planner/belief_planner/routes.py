"""Routes of the foragers together: who goes where, so that items are met early.

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

from graph_planner.belief_planner.beam import free_slot, insert, limit
from graph_planner.belief_planner.stops import FAR
from graph_planner.compiled import inlined, kernel

NOWHERE = -1
NOBODY = -1
_ONE = np.uint64(1)
_ODD = np.uint64(0x9E3779B97F4A7C15)
_RETIRED = np.uint64(7)  # what a forager that goes nowhere any more adds to a mark


class Legs(NamedTuple):
    """What there is to collect, and how far it is."""

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
    """The stops that a state has not visited, in ascending order, for the forager that is next."""

    stop: NDArray[np.int64]  # (open,)
    weight: NDArray[np.float64]  # (open,)
    arrival: NDArray[np.float64]  # (open,) decision in which it could be there
    others: NDArray[np.float64]  # (open,) decision in which the first of the others could
    rank: NDArray[np.float64]  # (open,) decisions per item from where it is, inf if out of reach


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


@kernel
def _outlook(stops: int) -> Outlook:
    """Room for the open stops of a state."""
    open_, empty = np.zeros(stops, np.int64), np.zeros((4, stops))
    return Outlook(open_, empty[0], empty[1], empty[2], empty[3])


@inlined
def _first_free(clock: NDArray[np.float64], s: int) -> int:
    """The forager of a state that is free first."""
    f = 0
    for g in range(1, clock.shape[1]):
        if clock[s, g] < clock[s, f]:
            f = g
    return f


@inlined
def _soonest(
    clock: NDArray[np.float64],
    at: NDArray[np.int64],
    first: NDArray[np.float64],
    between: NDArray[np.float64],
    kind: NDArray[np.int64],
    lasts: NDArray[np.float64],
    s: int,
    f: int,
    j: int,
) -> float:
    """Decision in which stop `j` could be met first by a forager of state `s` other than `f`."""
    nearest = FAR
    for g in range(clock.shape[1]):
        if g != f and clock[s, g] < FAR:
            way = first[g, j] if at[s, g] < 0 else between[kind[g], at[s, g], j]
            if clock[s, g] + way <= lasts[g]:
                nearest = min(nearest, clock[s, g] + way)
    return nearest


@inlined
def _choose(rank: NDArray[np.float64], n: int, chosen: NDArray[np.int64]) -> int:
    """Fill `chosen` with those of least rank of the first `n`, the best first; their number."""
    number, worst = 0, np.inf
    for i in range(n):
        if rank[i] < worst:
            number = insert(chosen, rank, number, i)
            worst = limit(chosen, rank, number)
    return number


@inlined
def _rest(
    weight: NDArray[np.float64],
    others: NDArray[np.float64],
    stop: NDArray[np.int64],
    n: int,
    chosen: int,
    free: float,
    way: NDArray[np.float64],
    price: float,
    enough: float,
) -> float:
    """A price plus, for every open stop but the chosen one, its weight by when it can be met first.

    Parameters
    ----------
    weight, others, stop, n : of an `Outlook`
    chosen : the forager's next stop, as a number among the open ones
    free, way : the decision in which it is free there, and (stop,) its ways from there
    enough : a price of this or more is as good as any, so the sum is broken off there
    """
    for i in range(n):
        if i != chosen:
            price += weight[i] * min(others[i], free + way[stop[i]])
            if price >= enough:
                break
    return price


@inlined
def _has_twin(
    names: NDArray[np.uint64], cost: NDArray[np.float64], kept: int, name: np.uint64, price: float
) -> bool:
    """Whether a step to the same state is kept that is no dearer."""
    found = False
    for slot in range(kept):
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
    chosen: NDArray[np.int64],
    steps: Steps,
) -> tuple[int, bool]:
    """Try what can be done next in every state, and keep the best steps.

    Parameters
    ----------
    number : states
    outlook, chosen : scratch for the open stops of a state, and the best of them

    Returns
    -------
    Steps kept, and whether any of the routes could go on
    """
    worth, first, between, kind = legs.weight, legs.first, legs.between, legs.kind
    clock, at, visited, room, lasts = (
        states.clock,
        states.at,
        states.visited,
        states.room,
        legs.lasts,
    )
    stop, weight, arrival = outlook.stop, outlook.weight, outlook.arrival
    others, rank = outlook.others, outlook.rank
    order, cost, names = steps.order, steps.cost, steps.name
    parents, whos, goals, frees = steps.parent, steps.who, steps.stop, steps.free
    kept, goes_on = 0, False
    for s in range(number):
        f, n = _first_free(clock, s), 0
        if clock[s, f] < FAR:
            for j in range(worth.size):
                if not visited[s] & (_ONE << np.uint64(j)):
                    way = first[f, j] if at[s, f] < 0 else between[kind[f], at[s, f], j]
                    stop[n], weight[n], arrival[n] = j, worth[j], clock[s, f] + way
                    others[n] = _soonest(clock, at, first, between, kind, lasts, s, f, j)
                    rank[n] = way / weight[n] if way < FAR and arrival[n] <= lasts[f] else np.inf
                    n += 1
        complete = n == 0
        goes_on = goes_on or not complete
        held = states.mark[s]  # the marks of those who stay where they are
        if not complete and at[s, f] >= 0:
            held -= _mark(at[s, f], kind[f])
        stops = _choose(rank, n, chosen)
        for c in range(stops + (1 if complete or stops == 0 or clock.shape[1] > 1 else 0)):
            i, j, free, paid, met, who = NOWHERE, NOWHERE, FAR, states.paid[s], visited[s], f
            mark = held + _RETIRED
            if complete:
                who, mark = NOBODY, held
            elif c < stops:
                i = chosen[c]
                j, taken = stop[i], min(weight[i], room[s, f])
                paid += taken * arrival[i]
                paid += (weight[i] - taken) * others[i]
                free = arrival[i] if room[s, f] > weight[i] else FAR
                met |= _ONE << np.uint64(j)
                mark = held + _mark(j, kind[f])
            name, enough = mark + met * _ODD, limit(order, cost, kept)
            price, way_on = states.cost[s] if complete else paid, between[kind[f], max(j, 0)]
            price = _rest(weight, others, stop, n, i, free, way_on, price, enough)
            if price < enough and not _has_twin(names, cost, kept, name, price):
                slot = free_slot(order, kept)
                cost[slot], names[slot] = price, name
                parents[slot], whos[slot], goals[slot] = s, who, j
                frees[slot], steps.paid[slot] = free, paid
                kept = insert(order, cost, kept, slot)
    return kept, goes_on


@kernel
def _follow(legs: Legs, states: States, steps: Steps, kept: int, after: States) -> None:
    """Make the next generation `after` from the states and the steps kept."""
    clock, room, at, begun = after.clock, after.room, after.at, after.begun
    visited, parent, who, goal = after.visited, steps.parent, steps.who, steps.stop
    for i in range(kept):
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
def search_routes(legs: Legs, beam: int, choices: int, depth: int) -> NDArray[np.int64]:
    """The stop that each forager goes to first in the best joint route found.

    Parameters
    ----------
    legs : of at most 64 stops
    beam : states kept
    choices : stops tried from a state
    depth : stops in a route, over all foragers

    Returns
    -------
    (forager,) stop, `NOWHERE` for a forager that is better left out
    """
    foragers, n = legs.first.shape
    if n == 0 or foragers == 0:
        return np.full(foragers, NOWHERE, np.int64)
    states, after, number = _states(beam, legs.room), _states(beam, legs.room), 1
    steps, outlook, chosen = _steps(beam), _outlook(n), np.empty(choices, np.int64)
    for _ in range(min(depth, n + foragers)):
        kept, goes_on = _grow(legs, states, number, outlook, chosen, steps)
        if not goes_on:
            break
        _follow(legs, states, steps, kept, after)
        number = kept
        states, after = after, states
    begun: NDArray[np.int64] = states.begun[0].copy()
    return begun
