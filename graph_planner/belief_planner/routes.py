"""Routes of the foragers together: who goes where, so that items are met early.

A beam search over joint routes. In every state the forager that is free first goes on to one of
its best stops (decisions per item, the ratio rule of W. E. Smith, "Various optimizers for
single-stage production", 1956). A state is judged by the sum over all items of the decision in
which each is met; for those not yet on a route, by when the first forager could be there.
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.stops import FAR
from graph_planner.compiled import inlined, kernel

NOWHERE = -1
_ONE = np.uint64(1)
_ODD = np.uint64(0x9E3779B97F4A7C15)


@inlined
def _mark(stop: int, kind: int) -> np.uint64:
    """A number for a forager's place that adds up the same whatever the order of foragers."""
    value = np.uint64(stop + 2 + 1009 * kind) * _ODD
    value = (value ^ (value >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return value ^ (value >> np.uint64(32))


@kernel
def search_routes(
    weight: NDArray[np.float64],
    first: NDArray[np.float64],
    between: NDArray[np.float64],
    kind: NDArray[np.int64],
    beam: int,
    choices: int,
    depth: int,
) -> NDArray[np.int64]:
    """The stop that each forager goes to first in the best joint route found.

    Parameters
    ----------
    weight : (stop,) items at each stop, at most 64 stops
    first : (forager, stop) decisions from where the foragers are
    between : (kind, stop, stop) decisions from stop to stop
    kind : (forager,) which layer of `between`
    beam : states kept
    choices : stops tried from a state
    depth : stops in a route, over all foragers

    Returns
    -------
    (forager,) stop, `NOWHERE` for a forager that is better left out
    """
    foragers, n = first.shape
    target = np.full(foragers, NOWHERE, np.int64)
    if n == 0 or foragers == 0:
        return target
    clock, clock_2 = np.zeros((beam, foragers)), np.zeros((beam, foragers))
    at, at_2 = np.full((beam, foragers), -1), np.full((beam, foragers), -1)
    begun, begun_2 = np.full((beam, foragers), -1), np.full((beam, foragers), -1)
    visited, visited_2 = np.zeros(beam, np.uint64), np.zeros(beam, np.uint64)
    paid, paid_2 = np.zeros(beam), np.zeros(beam)
    cost, cost_2 = np.zeros(beam), np.zeros(beam)
    mark, mark_2 = np.zeros(beam, np.uint64), np.zeros(beam, np.uint64)
    parent, who, goal = np.empty(beam, np.int64), np.empty(beam, np.int64), np.empty(beam, np.int64)
    arrival, others, rank = np.empty(n), np.empty(n), np.empty(n)
    chosen = np.empty(choices + 1, np.int64)
    states, full = 1, np.uint64(0)
    for j in range(n):
        full |= _ONE << np.uint64(j)
    for _ in range(min(depth, n + foragers)):
        kept, open_states = 0, 0
        for s in range(states):
            f = 0
            for g in range(1, foragers):
                if clock[s, g] < clock[s, f]:
                    f = g
            done = visited[s] == full or clock[s, f] >= FAR
            tried = 0
            if not done:
                open_states += 1
                # When could each stop be met, by this forager and by the others?
                for j in range(n):
                    if visited[s] & (_ONE << np.uint64(j)):
                        arrival[j], others[j], rank[j] = 0.0, 0.0, np.inf
                        continue
                    nearest = FAR
                    for g in range(foragers):
                        if g != f and clock[s, g] < FAR:
                            way = first[g, j] if at[s, g] < 0 else between[kind[g], at[s, g], j]
                            nearest = min(nearest, clock[s, g] + way)
                    way = first[f, j] if at[s, f] < 0 else between[kind[f], at[s, f], j]
                    arrival[j], others[j] = clock[s, f] + way, nearest
                    rank[j] = way / weight[j] if way < FAR else np.inf
                for _ in range(min(choices, n)):
                    best = -1
                    for j in range(n):
                        if rank[j] < np.inf and (best < 0 or rank[j] < rank[best]):
                            best = j
                    if best < 0:
                        break
                    rank[best] = np.inf
                    chosen[tried] = best
                    tried += 1
            leave = foragers > 1 and not done
            for c in range(tried + (1 if leave or done else 0)):
                j = chosen[c] if c < tried else NOWHERE
                if done:
                    price = cost[s]
                    total = mark[s] + visited[s] * _ODD
                else:
                    price = paid[s]
                    total = mark[s] - _mark(at[s, f], kind[f]) if at[s, f] >= 0 else mark[s]
                    if j >= 0:
                        price += weight[j] * arrival[j]
                        total += _mark(j, kind[f])
                        total += (visited[s] | (_ONE << np.uint64(j))) * _ODD
                    else:
                        total += visited[s] * _ODD + np.uint64(7)
                    now = arrival[j] if j >= 0 else FAR
                    for i in range(n):
                        if i == j or visited[s] & (_ONE << np.uint64(i)):
                            continue
                        nearest = others[i]
                        if j >= 0:
                            nearest = min(nearest, now + between[kind[f], j, i])
                        price += weight[i] * nearest
                if kept == beam and price >= cost_2[kept - 1]:
                    continue
                twin = False
                for i in range(kept):
                    if mark_2[i] == total and cost_2[i] <= price:
                        twin = True
                        break
                if twin:
                    continue
                place = kept if kept < beam else beam - 1
                while place > 0 and cost_2[place - 1] > price:
                    cost_2[place], mark_2[place] = cost_2[place - 1], mark_2[place - 1]
                    parent[place], who[place], goal[place] = (
                        parent[place - 1],
                        who[place - 1],
                        goal[place - 1],
                    )
                    place -= 1
                cost_2[place], mark_2[place], parent[place] = price, total, s
                who[place], goal[place] = f if not done else -1, j
                kept = min(kept + 1, beam)
        if open_states == 0 or kept == 0:
            break
        for i in range(kept):
            s, f, j = parent[i], who[i], goal[i]
            clock_2[i], at_2[i], begun_2[i] = clock[s], at[s], begun[s]
            visited_2[i], paid_2[i] = visited[s], paid[s]
            if f >= 0:
                old = _mark(at[s, f], kind[f]) if at[s, f] >= 0 else np.uint64(0)
                if j >= 0:
                    way = first[f, j] if at[s, f] < 0 else between[kind[f], at[s, f], j]
                    clock_2[i, f] = clock[s, f] + way
                    paid_2[i] += weight[j] * clock_2[i, f]
                    visited_2[i] |= _ONE << np.uint64(j)
                    if begun[s, f] < 0:
                        begun_2[i, f] = j
                    at_2[i, f] = j
                    mark_2[i] = mark[s] - old + _mark(j, kind[f])
                else:
                    clock_2[i, f] = FAR
                    mark_2[i] = mark[s] - old + np.uint64(7)
            else:
                mark_2[i] = mark[s]
        states = kept
        clock, clock_2 = clock_2, clock
        at, at_2 = at_2, at
        begun, begun_2 = begun_2, begun
        visited, visited_2 = visited_2, visited
        paid, paid_2 = paid_2, paid
        cost, cost_2 = cost_2, cost
        mark, mark_2 = mark_2, mark
    target[:] = begun[0]
    return target
