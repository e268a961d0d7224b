"""Where a scout looks next: a beam search over its moves for seeing much and seeing it early.

Every cell of the search (a node to be seen, or a block of places where a hotspot may be) has a
mass. A plan is judged by the sum over all masses of the decision in which each is seen; for mass
that a plan leaves over, by when the scout, or another one, could see the landmark it belongs to.

That sum is as small anywhere between two equal masses far apart: who comes nearer to one goes as
far from the other, and what little can be seen nearby decides. Where later decisions weigh less
(`lateness`), the sum is concave, and the way to one of the two is better than staying between.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.beam import free_slot, insert, limit
from graph_planner.belief_planner.ways import UNREACHED, UInt16Array
from graph_planner.compiled import MARGIN, inlined, kernel, rough
from graph_planner.geodesics import Int32Array

LONGEST = 400.0  # decisions charged for what nobody can reach
SEEN = 1e-9  # so little mass left of a landmark is rounding


class Cover(NamedTuple):
    """What is seen from where, and how far its parts are."""

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
    """(decision,) what seeing a mass of 1 in each decision costs, 0 to `LONGEST`.

    Parameters
    ----------
    discount : weight of a decision over that of the one before; 1: the cost is the decision
    """
    weights = discount ** np.arange(int(LONGEST))
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
    left: NDArray[np.float64]  # (slot, landmark) mass not seen yet
    begun: NDArray[np.int64]  # (slot,) first move


class Trail(NamedTuple):
    """How every plan came about."""

    node: Int32Array  # (decision + 1, slot) where it was then
    parent: NDArray[np.int64]  # (decision + 1, slot) its slot one decision before
    shown: NDArray[np.int64]  # (decision + 1, slot) see `_in_view`


class Search(NamedTuple):
    """One scout's search: what it can do, what it is for, and scratch."""

    ends: Int32Array  # (node, 9) where its moves end
    cover: Cover
    mass: NDArray[np.float64]  # (cell,) not seen when it starts
    elsewhere: NDArray[np.float64]  # (landmark,) decisions in which another agent could see each
    late: NDArray[np.float64]  # see `lateness`
    sight: Sight
    trail: Trail
    rest: NDArray[np.float64]  # (landmark,) scratch: mass that the plan at hand leaves


@kernel
def _plans(beam: int, marks: int) -> Plans:
    """Room for plans, at first of no decisions."""
    return Plans(
        np.zeros(beam, np.int64),
        np.zeros(beam),
        np.zeros(beam),
        np.zeros((beam, marks)),
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
        v = trail.shown[level, slot]
        if v < 0:
            for i in range(start[~v], start[~v + 1]):
                stamp[cells[i]] = token
        else:
            for i in range(fresh_start[v], fresh_start[v + 1]):
                stamp[fresh[i]] = token
        slot = trail.parent[level, slot]


@inlined
def _rest(
    k: int,
    decisions: UInt16Array,
    end: int,
    left: NDArray[np.float64],
    elsewhere: NDArray[np.float64],
    late: NDArray[np.float64],
    price: float,
) -> float:
    """A price plus, for every landmark, the mass left times the cost of when it can be seen.

    Parameters
    ----------
    k, end : decisions in the plan, and the node where it ends
    decisions : (node, landmark) from there until each is seen
    left, elsewhere : (landmark,) mass left, and decision in which another agent could see it
    late : see `lateness`
    """
    for mark in range(left.size):
        if left[mark] > SEEN:
            steps = LONGEST
            if decisions[end, mark] != UNREACHED:
                steps = float(k + max(1, int(decisions[end, mark])))
            price += left[mark] * late[int(min(steps, elsewhere[mark]))]
    return price


@rough
def _rest_roughly(
    k: int,
    decisions: UInt16Array,
    left: NDArray[np.float64],
    elsewhere: NDArray[np.float64],
    late: NDArray[np.float64],
) -> float:
    """`_rest` without its price, to some digits, of the decisions (landmark,) from the end."""
    total = 0.0
    for mark in range(left.size):
        there = decisions[mark]
        steps = LONGEST if there == UNREACHED else float(k + max(1, int(there)))
        mass = left[mark] if left[mark] > SEEN else 0.0
        total += mass * late[int(steps if steps < elsewhere[mark] else elsewhere[mark])]
    return total


@inlined
def _has_twin(
    node: Int32Array, k: int, cost: NDArray[np.float64], kept: int, end: int, price: float
) -> bool:
    """Whether a plan of `k` decisions is kept that ends in the same node at the same cost."""
    found = False
    for slot in range(kept):
        if node[k, slot] == end and abs(cost[slot] - price) <= 1e-9 * price:
            found = True
            break
    return found


@kernel
def _prolong(
    search: Search, plans: Plans, number: int, k: int, longer: Plans, first: NDArray[np.float64]
) -> int:
    """Prolong plans to `k` decisions by every move, and keep the best of them.

    Parameters
    ----------
    plans, number : the plans, of k - 1 decisions, and how many they are
    longer : filled
    first : (9,) filled with preferences for the first moves, if these are the first

    Returns
    -------
    Plans kept
    """
    cover, trail, landmark = search.cover, search.trail, search.cover.landmark
    start, cells = (cover.start, cover.cells) if k == 1 else (cover.fresh_start, cover.fresh)
    decisions, ends, mass = search.cover.decisions, search.ends, search.mass
    elsewhere, late = search.elsewhere, search.late
    token, stamp = search.sight.token, search.sight.stamp
    node, parent, rest = search.trail.node, search.trail.parent, search.rest
    left, order, cost, kept = plans.left, longer.order, longer.cost, 0
    for s in plans.order[:number]:
        token[0] += 1
        _stamp_seen(cover, trail, k - 1, s, token[0], stamp)
        for move in range(9):
            end = ends[node[k - 1, s], move]
            if end < 0:
                continue
            for mark in range(rest.size):
                rest[mark] = left[s, mark]
            got, shown = 0.0, _in_view(k, node[k - 1, s], end, move)
            place = end if k == 1 else shown
            for i in range(start[place], start[place + 1]):
                cell = cells[i]
                if mass[cell] > 0.0 and stamp[cell] != token[0]:
                    got += mass[cell]
                    rest[landmark[cell]] -= mass[cell]
            paid, enough = plans.paid[s] + got * late[k], limit(order, cost, kept)
            if k > 1:
                price = paid + MARGIN * _rest_roughly(k, decisions[end], rest, elsewhere, late)
                if price >= enough:
                    continue
            price = _rest(k, decisions, end, rest, elsewhere, late, paid)
            if k == 1:
                first[move] = -price
            if price >= enough or _has_twin(node, k, cost, kept, end, price):
                continue
            slot = free_slot(order, kept)
            cost[slot], longer.paid[slot], longer.left[slot] = price, paid, rest
            longer.begun[slot] = plans.begun[s] if k > 1 else move
            node[k, slot], parent[k, slot], trail.shown[k, slot] = end, s, shown
            kept = insert(order, cost, kept, slot)
    return kept


@kernel
def _begin_alike(plans: Plans, number: int) -> bool:
    """Whether all of some plans have the same first move."""
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

    Parameters
    ----------
    ends : (node, 9) where its moves end
    cover : what it sees
    at : its node
    mass : (cell,) what seeing each cell is worth, 0 for what need not be seen
    elsewhere : (landmark,) decisions in which another agent could see each landmark
    late : what seeing a mass of 1 in each decision costs, see `lateness`
    beam, depth : plans kept, decisions planned
    whole : whether the path is wanted, else the search ends once all plans begin alike
    preferences : (9,) filled; -inf where illegal
    path : (depth,) nodes of the best plan so far, filled

    Returns
    -------
    Decisions in the plan
    """
    marks = elsewhere.size
    each = (depth + 1, beam)
    trail = Trail(np.empty(each, np.int32), np.zeros(each, np.int64), np.zeros(each, np.int64))
    trail.node[0, 0] = at
    search = Search(ends, cover, mass, elsewhere, late, scratch, trail, np.empty(marks))
    plans, longer = _plans(beam, marks), _plans(beam, marks)
    for cell in range(mass.size):
        if mass[cell] > 0.0:
            plans.left[0, cover.landmark[cell]] += mass[cell]
    preferences[:] = -np.inf
    number, length = 1, 0
    for k in range(1, depth + 1):
        kept = _prolong(search, plans, number, k, longer, preferences)
        if kept == 0:
            break
        number, length = kept, k
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
