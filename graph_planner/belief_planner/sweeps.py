"""Sweeps of a scout: a beam search over its moves for seeing much and seeing it early.

Every cell of the search (a node to be seen, or a block of places where a hotspot may be) has a
mass. A plan is judged by the sum over all masses of the decision in which each is seen; for mass
that a plan leaves over, by when the scout, or another one, could see the landmark it belongs to.

That sum is the same anywhere between two equal masses far apart: a scout that comes nearer to one
goes as far from the other, and small masses nearby decide. Where later decisions weigh less
(`lateness`), the sum is concave, and the way to one of the two is better than staying between.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.belief_planner.beam import free_slot, insert, limit
from mjforage.graph_planner.belief_planner.ways import UNREACHED, UInt16Array
from mjforage.graph_planner.graph.geodesics import Int32Array

LONGEST = 400.0  # decisions charged for what nobody can reach
SEEN = 1e-9  # so little mass left of a landmark is rounding


class Cover(NamedTuple):
    """Cells seen from each node, and the decisions to each landmark."""

    start: NDArray[np.int64]  # (node + 1,) cells seen from a node
    cells: Int32Array  # `cells[start[v]:start[v + 1]]`
    landmark: Int32Array  # (cell,) the landmark that a cell belongs to
    decisions: UInt16Array  # (node, landmark) until the landmark is seen
    fresh_start: NDArray[np.int64]  # (9 node + 1,) cells seen after a move, and not before it:
    fresh: Int32Array  # `fresh[fresh_start[9 * v + m]:fresh_start[9 * v + m + 1]]`


class Sight(NamedTuple):
    """Scratch: which cells the plan at hand has seen."""

    token: NDArray[np.int64]  # (1,)
    stamp: NDArray[np.int64]  # (cell,)


def lateness(discount: float) -> NDArray[np.float64]:
    """(decision,) cost of seeing a mass of 1 in each decision, 0 to `LONGEST`.

    `discount`: weight of a decision over that of the one before; 1: the cost is the decision.
    """
    weights = [discount**decision for decision in range(int(LONGEST))]
    return np.concatenate([np.zeros(1), np.cumsum(weights)])


def sight(cells: int) -> Sight:
    """Scratch for so many cells."""
    return Sight(np.zeros(1, np.int64), np.zeros(cells, np.int64))


@kernel
def until_seen(cover: Cover, node: int, delay: float, soonest: NDArray[np.float64]) -> None:
    """Lower the decisions until each landmark (landmark,) is seen by a scout that starts later."""
    for mark in range(soonest.size):
        decisions = cover.decisions[node, mark]
        if decisions != UNREACHED:
            soonest[mark] = min(soonest[mark], delay + decisions)


class Plans(NamedTuple):
    """Plans of one length in slots as in `beam`; `order` lists them, the cheapest first."""

    order: NDArray[np.int64]  # (slot,)
    cost: NDArray[np.float64]  # (slot,) decisions in which all mass is seen: done and to come
    paid: NDArray[np.float64]  # (slot,) what of it is done
    left: NDArray[np.float64]  # (slot, place + 1) mass not seen yet of the landmarks of `Marks`
    begun: NDArray[np.int64]  # (slot,) first move


class Trail(NamedTuple):
    """Predecessors of every plan."""

    node: Int32Array  # (decision + 1, slot) where it was then
    parent: NDArray[np.int64]  # (decision + 1, slot) its slot one decision before
    in_view: NDArray[np.int64]  # (decision + 1, slot) see `_in_view`


class Marks(NamedTuple):
    """The landmarks that have mass when a search starts: others never count."""

    landmark: Int32Array  # (place,)
    place: Int32Array  # (landmark,) of each among them; of others one more than they have
    mass: NDArray[np.float64]  # (place,) of each when the search starts
    elsewhere: Int32Array  # (place,) decisions in which another agent could see each


class Search(NamedTuple):
    """One scout's search: its moves, its masses, and scratch memory."""

    ends: Int32Array  # (node, 9) where its moves end
    cover: Cover
    mass: NDArray[np.float64]  # (cell,) not seen when it starts
    marks: Marks
    late: NDArray[np.float64]  # see `lateness`
    sight: Sight
    trail: Trail
    rest: NDArray[np.float64]  # (place + 1,) scratch: mass that the plan at hand leaves


@kernel
def _plans(beam: int, places: int) -> Plans:
    """Room for plans, at first of no decisions."""
    return Plans(
        np.zeros(beam, np.int64),
        np.zeros(beam),
        np.zeros(beam),
        np.zeros((beam, places + 1)),
        np.full(beam, -1),
    )


@inlined
def _in_view(k: int, node: int, end: int, move: int) -> int:
    """The list of what the k-th decision of a plan shows: all that is seen from the end of the
    first one, ~ its node; what is new in a later one, its place in `Cover.fresh_start`.
    """
    return ~end if k == 1 else 9 * node + move


@inlined
def _stamp_seen(
    cover: Cover, trail: Trail, k: int, slot: int, token: int, stamp: NDArray[np.int64]
) -> None:
    """Stamp the cells that a plan of `k` decisions has seen on its way: see `Trail`, `Sight`."""
    start, cells, fresh_start, fresh = cover.start, cover.cells, cover.fresh_start, cover.fresh
    for level in range(k, 0, -1):
        v = trail.in_view[level, slot]
        if v < 0:
            for i in range(start[~v], start[~v + 1]):
                stamp[cells[i]] = token
        else:
            for i in range(fresh_start[v], fresh_start[v + 1]):
                stamp[fresh[i]] = token
        slot = trail.parent[level, slot]


@kernel
def _marks(cover: Cover, mass: NDArray[np.float64], elsewhere: NDArray[np.float64]) -> Marks:
    """The landmarks that are worth going to, see `search_sweep` for the arguments."""
    masses = np.zeros(elsewhere.size)
    for cell in range(mass.size):
        if mass[cell] > 0.0:
            masses[cover.landmark[cell]] += mass[cell]
    some = np.flatnonzero(masses > SEEN)
    place = np.full(elsewhere.size, some.size, np.int32)
    for i in range(some.size):
        place[some[i]] = i
    return Marks(some.astype(np.int32), place, masses[some], elsewhere[some].astype(np.int32))


@inlined
def _rest(
    k: int,
    decisions: UInt16Array,
    marks: Int32Array,
    left: NDArray[np.float64],
    elsewhere: Int32Array,
    late: NDArray[np.float64],
    price: float,
) -> float:
    """A price plus, for every landmark, the mass left times the cost of when it can be seen."""
    for i in range(marks.size):
        steps = np.int32(k + max(np.int32(1), np.int32(decisions[np.uint64(marks[i])])))
        mass = left[i] if left[i] > SEEN else 0.0  # no branch: who has seen what is a coin toss
        price += mass * late[np.uint64(min(steps, elsewhere[i]))]
    return price


@inlined
def _has_twin(
    node: Int32Array, k: int, cost: NDArray[np.float64], count: int, end: int, price: float
) -> bool:
    """True if a plan of `k` decisions is kept that ends in the same node at the same cost."""
    found = False
    for slot in range(count):
        if node[k, slot] == end and abs(cost[slot] - price) <= 1e-9 * price:
            found = True
            break
    return found


@kernel
def _prolong(
    search: Search, plans: Plans, number: int, k: int, longer: Plans, first: NDArray[np.float64]
) -> int:
    """Prolong plans to `k` decisions by every move, and keep the best of them.

    Returns: plans kept.
    """
    cover, trail, landmark = search.cover, search.trail, search.cover.landmark
    marks, place_of, elsewhere = search.marks.landmark, search.marks.place, search.marks.elsewhere
    start, cells = (cover.start, cover.cells) if k == 1 else (cover.fresh_start, cover.fresh)
    decisions, ends, mass = search.cover.decisions, search.ends, search.mass
    late, token, stamp = search.late, search.sight.token, search.sight.stamp
    node, parent, rest = search.trail.node, search.trail.parent, search.rest
    left, order, cost, count = plans.left, longer.order, longer.cost, 0
    for s in plans.order[:number]:
        token[0] += 1
        _stamp_seen(cover, trail, k - 1, s, token[0], stamp)
        for move in range(9):
            end = ends[node[k - 1, s], move]
            if end < 0:
                continue
            for i in range(marks.size):
                rest[i] = left[s, i]
            got, in_view = 0.0, _in_view(k, node[k - 1, s], end, move)
            place = end if k == 1 else in_view
            for i in range(start[place], start[place + 1]):
                cell = cells[i]
                if mass[cell] > 0.0 and stamp[cell] != token[0]:
                    got += mass[cell]
                    rest[place_of[landmark[cell]]] -= mass[cell]
            paid, enough = plans.paid[s] + got * late[k], limit(order, cost, count)
            price = _rest(k, decisions[end], marks, rest, elsewhere, late, paid)
            if k == 1:
                first[move] = -price
            if price >= enough or _has_twin(node, k, cost, count, end, price):
                continue
            slot = free_slot(order, count)
            cost[slot], longer.paid[slot], longer.left[slot] = price, paid, rest
            longer.begun[slot] = plans.begun[s] if k > 1 else move
            node[k, slot], parent[k, slot], trail.in_view[k, slot] = end, s, in_view
            count = insert(order, cost, count, slot)
    return count


@kernel
def _begin_alike(plans: Plans, number: int) -> bool:
    """True if all of some plans have the same first move."""
    alike = True
    for slot in plans.order[:number]:
        alike &= plans.begun[slot] == plans.begun[plans.order[0]]
    return bool(alike)


@kernel
def search_sweep(
    ends: Int32Array,
    cover: Cover,
    at: int,
    mass: NDArray[np.float64],
    elsewhere: NDArray[np.float64],
    late: NDArray[np.float64],
    beam: int,
    depth: int,
    whole: bool,
    scratch: Sight,
    preferences: NDArray[np.float64],
    path: Int32Array,
) -> int:
    """Plan one scout's moves.

    Returns: decisions in the plan.

    Parameters
    ----------
    ends : (node, 9) where its moves end
    cover : what it sees
    at : its node
    mass : (cell,) what seeing each cell is worth, 0 for what need not be seen
    elsewhere : (landmark,) decisions in which another agent could see each, `LONGEST` if none
    late : what seeing a mass of 1 in each decision costs, see `lateness`
    beam, depth : plans kept, decisions planned
    whole : True if the path is wanted, else the search ends once all plans begin alike
    preferences : (9,) filled; -inf where illegal
    path : (depth,) nodes of the best plan so far, filled
    """
    marks = _marks(cover, mass, elsewhere)
    each = (depth + 1, beam)
    trail = Trail(np.empty(each, np.int32), np.zeros(each, np.int64), np.zeros(each, np.int64))
    trail.node[0, 0] = at
    places = marks.landmark.size
    search = Search(ends, cover, mass, marks, late, scratch, trail, np.zeros(places + 1))
    plans, longer = _plans(beam, places), _plans(beam, places)
    plans.left[0, :places] = marks.mass
    preferences[:] = -np.inf
    number, length = 1, 0
    for k in range(1, depth + 1):
        count = _prolong(search, plans, number, k, longer, preferences)
        if count == 0:
            break
        number, length = count, k
        plans, longer = longer, plans
        if not whole and _begin_alike(plans, number):
            break
    if length == 0:
        return 0
    slot = plans.order[0]
    preferences[plans.begun[slot]] = 1.0
    for level in range(length, 0, -1):
        path[level - 1] = trail.node[level, slot]
        slot = trail.parent[level, slot]
    return length
