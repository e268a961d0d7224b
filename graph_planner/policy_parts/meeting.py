"""Meeting items that drift: time and place of meeting, and an assignment by ratios of pairs.

Online greedy with reassignment, the idea of Heine, "Team Orienteering with Moving Targets" (from a
summary of it): of all pairs of an agent and an item the one with the largest ratio of reward to the
time until they meet is made, then the next; made anew at every decision, an item changes hands when
a better pair appears.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, drifted
from mjforage.graph_planner.belief_planner.foraging import Able
from mjforage.graph_planner.belief_planner.routes import NOWHERE
from mjforage.graph_planner.belief_planner.stops import FAR, Floating
from mjforage.graph_planner.belief_planner.taking import Taking, dwell, quays_beside
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Ways, row_to
from mjforage.graph_planner.graph.geodesics import Int32Array

_STRIDE = 0.5  # of the decisions still missing are let pass at once: items drift slower than agents


class Sea(NamedTuple):
    """Drift of items, and ways of agents."""

    boundary: Boundary
    ways: tuple[Ways, ...]  # one per kind of forager
    drift: NDArray[np.float64]  # (2,) [node/step]
    taking: Taking
    stay: bool  # whether staying put is a move
    latest: float  # decision after which nothing is met


class Groups(NamedTuple):
    """Nodes with items, certain or probable."""

    node: Int32Array  # (lot,) now
    row: NDArray[np.float64]  # (lot,) mean place of its items [node]
    col: NDArray[np.float64]
    weight: NDArray[np.float64]  # (lot,) items


@kernel
def meet(
    sea: Sea, kind: int, at: int, row: float, col: float, free: float, latest: float
) -> tuple[float, int]:
    """Decision at whose end an agent meets an item, and the node; `FAR` if later than `latest`.

    It is the first one in which the agent can be where the item is then; an agent that moves
    several nodes at a time does not reach every node, and may be given a later one. An item that is
    collected in a decision has drifted in those before: collecting comes before drifting.

    Parameters
    ----------
    kind, at : which of the ways it moves by, and its node in decision `free`
    row, col : place of the item now [node]
    free : decisions from now until it sets out
    """
    boundary, drift = sea.boundary, sea.drift
    ways, again = sea.ways[kind], 1.0 if sea.stay else 2.0
    row, col, node = drifted(boundary, row, col, drift[0], drift[1], free)
    when = free + 1.0
    while when <= latest:
        decisions = ways.decisions[row_to(ways, node), at]
        missing = 1.0  # where nobody can be: the item may drift on to where somebody can
        if decisions != UNREACHED:
            missing = free + (float(decisions) if decisions > 0 else again) - when
        if missing <= 0.0:
            stop = when + sea.taking.usual[quays_beside(boundary, row, col, node)]
            return stop, node
        passed = max(1.0, np.floor(_STRIDE * missing))
        row, col, node = drifted(boundary, row, col, drift[0], drift[1], passed)
        when += passed
    return FAR, NOWHERE


@kernel
def groups_of(items: Floating, boundary: Boundary) -> Groups:
    """The items of every node in one lot."""
    place = np.full(boundary.rows.size, NOWHERE)
    n, count = 0, items.number[0]
    node, weight = np.empty(count, np.int32), np.zeros(count)
    row, col = np.zeros(count), np.zeros(count)
    for i in range(count):
        if items.weight[i] <= 0.0:
            continue
        down, right, here = drifted(boundary, items.row[i], items.col[i], 0.0, 0.0, 0.0)
        if place[here] == NOWHERE:
            place[here], node[n] = n, here
            n += 1
        lot, more = place[here], items.weight[i]
        weight[lot] += more
        row[lot] += more * down
        col[lot] += more * right
    for i in range(n):
        row[i], col[i] = row[i] / weight[i], col[i] / weight[i]
    return Groups(node[:n], row[:n], col[:n], weight[:n])


@kernel
def _meet_all(
    sea: Sea,
    able: Able,
    f: int,
    at: int,
    free: float,
    lots: Groups,
    open_: NDArray[np.bool_],
    when: NDArray[np.float64],
    where: Int32Array,
) -> None:
    """Fill time and place (lot,) at which a forager free at `at` from `free` on meets each lot."""
    for lot in range(open_.size):
        if open_[lot]:
            place = lots.row[lot], lots.col[lot]
            latest = min(able.lasts[f], sea.latest)
            about = sea, able.kind[f], at, place[0], place[1], free, latest
            when[lot], where[lot] = meet(*about)


@kernel
def assign(
    sea: Sea,
    able: Able,
    at: Int32Array,
    items: Floating,
    ahead: int,
    goal: Int32Array,
) -> None:
    """Fill the node (forager,) in which each forager meets its first item, `NOWHERE` without one.

    A forager that has one goes on from there, so that the others do not count on what it will have
    collected by then. A forager takes on nothing beyond its room or its energy.

    Parameters
    ----------
    able : foragers that can collect
    at : (forager,) nodes
    ahead : items that a forager is given at most
    """
    lots, n_foragers = groups_of(items, sea.boundary), at.size
    n = lots.node.size
    open_, room = np.ones(n, np.bool_), able.room.copy()
    when, where = np.full((n_foragers, n), FAR), np.full((n_foragers, n), np.int32(NOWHERE))
    given = np.zeros(n_foragers, np.int64)
    goal[:] = NOWHERE
    for f in range(n_foragers):
        _meet_all(sea, able, f, at[f], 0.0, lots, open_, when[f], where[f])
    for _ in range(n):
        best, who, what = 0.0, NOWHERE, NOWHERE
        for f in range(n_foragers):
            if given[f] < ahead and room[f] > 0.0:
                for lot in range(n):
                    if open_[lot] and when[f, lot] < FAR:
                        ratio = lots.weight[lot] / when[f, lot]
                        if ratio > best:
                            best, who, what = ratio, f, lot
        if who == NOWHERE:
            return
        weight, met = lots.weight[what], where[who, what]
        free = when[who, what] + dwell(sea.taking, weight)
        goal[who] = met if given[who] == 0 else goal[who]
        given[who] += 1
        room[who] -= weight
        open_[what] = False
        _meet_all(sea, able, who, met, free, lots, open_, when[who], where[who])
