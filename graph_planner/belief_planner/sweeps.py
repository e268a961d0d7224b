"""Where a scout looks next: a beam search over its moves for seeing much and seeing it early.

Every cell of the search (a node to be seen, or a block of places where a hotspot may be) has a
mass. A plan is judged by the sum over all masses of the decision in which each is seen; for mass
that a plan leaves over, by when the scout, or another one, could see the landmark it belongs to.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.belief_planner.ways import UNREACHED, UInt16Array
from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array

LONGEST = 400.0  # decisions charged for what nobody can reach


class Cover(NamedTuple):
    """What is seen from where, and how far its parts are."""

    start: NDArray[np.int64]  # (node + 1,) cells seen from a node
    cells: Int32Array  # `cells[start[v]:start[v + 1]]`
    landmark: Int32Array  # (cell,) the landmark that a cell belongs to
    decisions: UInt16Array  # (landmark, node) until the landmark is seen


class Sight(NamedTuple):
    """Scratch: which cells the plan at hand has seen."""

    token: NDArray[np.int64]  # (1,)
    stamp: NDArray[np.int64]  # (cell,)


def sight(cells: int) -> Sight:
    """Scratch for so many cells."""
    return Sight(np.zeros(1, np.int64), np.zeros(cells, np.int64))


@kernel
def until_seen(cover: Cover, node: int, delay: float, soonest: NDArray[np.float64]) -> None:
    """Lower the decisions until each landmark (landmark,) is seen by a scout that starts later."""
    for mark in range(soonest.size):
        decisions = cover.decisions[mark, node]
        if decisions != UNREACHED:
            soonest[mark] = min(soonest[mark], delay + decisions)


@kernel
def search_sweep(
    ends: Int32Array,
    cover: Cover,
    at: int,
    mass: NDArray[np.float64],
    elsewhere: NDArray[np.float64],
    beam: int,
    depth: int,
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
    beam, depth : plans kept, decisions planned
    preferences : (9,) filled; -inf where illegal
    path : (depth,) nodes of the best plan, filled

    Returns
    -------
    Decisions in the plan
    """
    start, cells, landmark = cover.start, cover.cells, cover.landmark
    decisions, stamp = cover.decisions, scratch.stamp
    marks = decisions.shape[0]
    node, parent = np.empty((depth + 1, beam), np.int32), np.zeros((depth + 1, beam), np.int64)
    begun, begun_2 = np.full(beam, -1), np.full(beam, -1)
    left, left_2 = np.zeros((beam, marks)), np.zeros((beam, marks))
    paid, paid_2 = np.zeros(beam), np.zeros(beam)
    cost, cost_2 = np.zeros(beam), np.zeros(beam)
    rest = np.empty(marks)
    preferences[:] = -np.inf
    node[0, 0], states = at, 1
    for cell in range(mass.size):
        if mass[cell] > 0.0:
            left[0, landmark[cell]] += mass[cell]
    length = 0
    for k in range(1, depth + 1):
        kept = 0
        for s in range(states):
            scratch.token[0] += 1
            token, ancestor = scratch.token[0], s
            for level in range(k - 1, 0, -1):
                v = node[level, ancestor]
                for i in range(start[v], start[v + 1]):
                    stamp[cells[i]] = token
                ancestor = parent[level, ancestor]
            here = node[k - 1, s]
            for move in range(9):
                end = ends[here, move]
                if end < 0:
                    continue
                rest[:] = left[s]
                got = 0.0
                for i in range(start[end], start[end + 1]):
                    cell = cells[i]
                    if mass[cell] > 0.0 and stamp[cell] != token:
                        got += mass[cell]
                        rest[landmark[cell]] -= mass[cell]
                price = paid[s] + got * k
                now = price
                for mark in range(marks):
                    if rest[mark] > 1e-9:
                        steps = LONGEST
                        if decisions[mark, end] != UNREACHED:
                            steps = float(k + max(1, int(decisions[mark, end])))
                        price += rest[mark] * min(steps, elsewhere[mark])
                if k == 1:
                    preferences[move] = -price
                if kept == beam and price >= cost_2[kept - 1]:
                    continue
                twin = False
                for i in range(kept):
                    if node[k, i] == end and abs(cost_2[i] - price) <= 1e-9 * price:
                        twin = True
                        break
                if twin:
                    continue
                place = kept if kept < beam else beam - 1
                while place > 0 and cost_2[place - 1] > price:
                    cost_2[place], paid_2[place] = cost_2[place - 1], paid_2[place - 1]
                    node[k, place], parent[k, place] = node[k, place - 1], parent[k, place - 1]
                    begun_2[place] = begun_2[place - 1]
                    left_2[place] = left_2[place - 1]
                    place -= 1
                cost_2[place], paid_2[place] = price, now
                node[k, place], parent[k, place] = end, s
                begun_2[place] = begun[s] if k > 1 else move
                left_2[place] = rest
                kept = min(kept + 1, beam)
        if kept == 0:
            break
        states, length = kept, k
        begun, begun_2 = begun_2, begun
        left, left_2 = left_2, left
        paid, paid_2 = paid_2, paid
        cost, cost_2 = cost_2, cost
    if length == 0:
        return 0
    preferences[begun[0]] = 1.0
    ancestor = 0
    for level in range(length, 0, -1):
        path[level - 1] = node[level, ancestor]
        ancestor = parent[level, ancestor]
    return length
