"""Simulation of a forager: the worth of a sequence of stops beside what the others may do.

An item counts once, by `discount` to the power of the decisions until the first comes for it. A
sequence's utility is what the fleet gains by it, the difference utility of Best et al. (see this
package). For stops that it leaves over counts how much sooner it could be there afterwards.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.randomness import UInt64Array
from mjforage.graph_planner.belief_planner.routes import Legs
from mjforage.graph_planner.belief_planner.stops import FAR
from mjforage.graph_planner.dec_mcts.plans import Plans, drawn_plan
from mjforage.graph_planner.dec_mcts.search import TreeOptions, draw
from mjforage.graph_planner.dec_mcts.tree import NONE, Tree, back_up, step_down
from mjforage.graph_planner.graph.geodesics import Int32Array


class Claims(NamedTuple):
    """Stops that the others collect from, in one sample."""

    worth: NDArray[np.float64]  # (stop,) of an item there when the first of them comes, 0 if never
    amount: NDArray[np.float64]  # (stop,) items that it takes
    later: NDArray[np.float64]  # (stop,) worth of an item when one could come after its plan


@kernel
def claims_of(stops: int) -> Claims:
    """Room for so many stops."""
    return Claims(np.zeros(stops), np.zeros(stops), np.zeros(stops))


@kernel
def _ways_from(legs: Legs, f: int, at: int) -> NDArray[np.float64]:
    """(stop,) decisions from a forager's last stop, -1 where it started."""
    ways: NDArray[np.float64] = legs.first[f] if at < 0 else legs.between[legs.kind[f], at]
    return ways


@kernel
def sample_claims(
    effort: TreeOptions,
    legs: Legs,
    plans: Plans,
    forager: int,
    follows: NDArray[np.float64],
    state: UInt64Array,
    claims: Claims,
) -> None:
    """Draw the actions of the others.

    `follows`: (forager,) chance that each follows its known plan; `claims`: filled.
    """
    first, amounts, later = claims.worth, claims.amount, claims.later
    weight, pace = legs.weight, -np.log(effort.discount)
    first[:], amounts[:], later[:] = 0.0, 0.0, 0.0
    for g in range(legs.kind.size):
        if g == forager or draw(state) >= follows[g]:
            continue
        c, clock, room, lasts = drawn_plan(plans, g, draw(state)), 0.0, legs.room[g], legs.lasts[g]
        ways = _ways_from(legs, g, NONE)
        for stop in plans.step[g, c, : plans.length[g, c] if c != NONE else 0]:
            clock += ways[stop]
            ways = _ways_from(legs, g, stop)
            worth, amount = np.exp(-pace * clock), min(room, weight[stop])
            if worth > first[stop]:
                first[stop], amounts[stop] = worth, amount
            room -= amount
        if room <= 0.0:
            continue
        for stop in range(weight.size):
            if clock + ways[stop] <= lasts:
                later[stop] = max(later[stop], np.exp(-pace * (clock + ways[stop])))


@kernel
def gain_of(first: float, amount: float, there: float, worth: float, room: float) -> float:
    """Gain of the fleet if a stop with so many items is met when an item has some worth.

    Parameters
    ----------
    first, amount : worth of an item when another comes first, 0 if none does, and what it takes
    there : items at the stop; room : items that can be taken
    """
    if worth <= first:
        return max(0.0, min(room, there - amount)) * worth
    removed = min(room, there)
    return removed * worth - (amount - min(amount, there - removed)) * first


@kernel
def _next_stop(
    effort: TreeOptions,
    legs: Legs,
    f: int,
    at: int,
    clock: float,
    room: float,
    visited: NDArray[np.bool_],
    claims: Claims,
    state: UInt64Array,
) -> int:
    """The stop that a rollout goes to: about the fewest decisions per item, -1 if none is left.

    The ratio rule of W. E. Smith, "Various optimizers for single-stage production", 1956.
    """
    best, next_stop, pace, roam = np.inf, NONE, -np.log(effort.discount), effort.roam
    weight, ways, lasts = legs.weight, _ways_from(legs, f, at), legs.lasts[f]
    first, amount = claims.worth, claims.amount
    for stop in range(weight.size):
        way = ways[stop]
        if visited[stop] or way >= FAR or clock + way > lasts or way >= best * weight[stop]:
            continue
        rank = way / weight[stop] * (1.0 + roam * draw(state))
        if rank < best:
            if first[stop] > 0.0:
                worth = np.exp(-pace * (clock + way))
                if gain_of(first[stop], amount[stop], weight[stop], worth, room) <= 0.0:
                    continue
            best, next_stop = rank, stop
    return next_stop


@kernel
def left_over(
    effort: TreeOptions,
    legs: Legs,
    f: int,
    at: int,
    clock: float,
    visited: NDArray[np.bool_],
    claims: Claims,
) -> float:
    """Worth of the stops not visited, by how much sooner a path that ends there could meet them."""
    value, pace, lasts = 0.0, -np.log(effort.discount), legs.lasts[f]
    weight, ways, first, later = legs.weight, _ways_from(legs, f, at), claims.worth, claims.later
    for stop in range(visited.size):
        there = clock + ways[stop]
        if not visited[stop] and there <= lasts:
            sooner = np.exp(-pace * there) - max(first[stop], later[stop])
            value += weight[stop] * max(0.0, sooner)
    return value


@kernel
def tour_value(effort: TreeOptions, legs: Legs, f: int, plan: Int32Array, claims: Claims) -> float:
    """Utility of a sequence of stops (step,) of a forager."""
    visited, pace = np.zeros(legs.weight.size, np.bool_), -np.log(effort.discount)
    clock, at, room, value = 0.0, NONE, legs.room[f], 0.0
    for stop in plan:
        clock += _ways_from(legs, f, at)[stop]
        worth, there = np.exp(-pace * clock), legs.weight[stop]
        value += gain_of(claims.worth[stop], claims.amount[stop], there, worth, room)
        room -= min(room, there)
        at, visited[stop] = stop, True
    return value + (left_over(effort, legs, f, at, clock, visited, claims) if room > 0.0 else 0.0)


@kernel
def simulate_tour(
    effort: TreeOptions,
    legs: Legs,
    f: int,
    tree: Tree,
    claims: Claims,
    now: int,
    state: UInt64Array,
) -> None:
    """One simulation: down the tree, one node more, and on by a rollout; `now`: its number."""
    longest = min(effort.depth, legs.weight.size)
    path, plan = np.zeros(longest + 1, np.int64), np.empty(longest, np.int32)
    visited, passed, n, inside = np.zeros(legs.weight.size, np.bool_), 1, 0, True
    clock, at, room = 0.0, NONE, legs.room[f]
    while n < longest and room > 0.0:
        stop = _next_stop(effort, legs, f, at, clock, room, visited, claims, state)
        if stop == NONE:
            break
        if inside:
            node, added = step_down(
                tree, path[passed - 1], stop, now, effort.explore, effort.forget
            )
            inside = node != NONE and not added
            if node != NONE:
                path[passed], stop, passed = node, tree.action[node], passed + 1
        clock += _ways_from(legs, f, at)[stop]
        at, plan[n], visited[stop], n = stop, stop, True, n + 1
        room -= min(room, legs.weight[stop])
    utility = tour_value(effort, legs, f, plan[:n], claims)
    back_up(tree, path[:passed], plan[:n], utility, now, effort.forget)
