"""Stops: nodes where a forager would meet floating items, with their worth."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.belief_planner.boundary import Boundary, drifted
from mjforage.graph_planner.belief_planner.taking import Taking, dwell, quays_beside, turning
from mjforage.graph_planner.belief_planner.ways import UNREACHED, Ways, row_to
from mjforage.graph_planner.graph.geodesics import Int32Array

MOST = 64  # stops of one search: its states keep the visited ones in one 64-bit word
FAR = 1e6  # decisions to a place that cannot be reached


class Floating(NamedTuple):
    """Items, certain or probable, by position. Only the first `number` entries count."""

    number: NDArray[np.int64]  # (1,)
    row: NDArray[np.float64]  # (item,) [node]
    col: NDArray[np.float64]  # (item,)
    weight: NDArray[np.float64]  # (item,) expected number of items


class Stops(NamedTuple):
    """Nodes worth going to and the decisions between them."""

    number: NDArray[np.int64]  # (1,)
    node: Int32Array  # (stop,)
    weight: NDArray[np.float64]  # (stop,) expected items
    dwell: NDArray[np.float64]  # (stop,) decisions there beyond the first item
    quays: NDArray[np.int64]  # (stop,) most quays beside one of its items, 0 to 2
    place: Int32Array  # (node,) scratch: stop of a node, all -1 between calls


def floating(capacity: int) -> Floating:
    """Room for so many items."""
    return Floating(np.zeros(1, np.int64), *(np.zeros(capacity) for _ in range(3)))


def stops(capacity: int, nodes: int) -> Stops:
    """Room for so many stops on a map of so many nodes."""
    return Stops(
        np.zeros(1, np.int64),
        np.zeros(capacity, np.int32),
        np.zeros(capacity),
        np.zeros(capacity),
        np.zeros(capacity, np.int64),
        np.full(nodes, -1, np.int32),
    )


@kernel
def soonest(ways: tuple[Ways, ...], kind: NDArray[np.int64], at: Int32Array, node: int) -> float:
    """Decisions until the first forager can be in a node; `FAR` if none can."""
    best = FAR
    for f in range(at.size):
        mine = ways[kind[f]]
        decisions = mine.decisions[row_to(mine, node), at[f]]
        if decisions != UNREACHED:
            best = min(best, float(decisions))
    return best


@kernel
def gather_stops(
    items: Floating,
    boundary: Boundary,
    ways: tuple[Ways, ...],
    kind: NDArray[np.int64],
    at: Int32Array,
    drift_rc: NDArray[np.float64],
    taking: Taking,
    found: Stops,
) -> None:
    """Put items that will share a node into one stop; keep the `MOST` that are soonest per worth.

    Where an item is met depends on when: it is carried on for as long as the nearest forager needs
    to its present node, less the last decision: in the graph collecting comes before drifting, and
    hulls seek what is in the node while they are there.

    Parameters
    ----------
    ways : one per kind of forager
    kind, at : (forager,) which of them, and its node
    drift_rc : (item, 2) of each, or (1, 2) of all [node/step]
    found : filled
    """
    place = found.place
    node, worth = np.empty(items.number[0], np.int32), np.empty(items.number[0])
    delay, stay = np.empty(items.number[0]), np.zeros(items.number[0])
    quays = np.zeros(items.number[0], np.int64)
    n = 0
    for i in range(items.number[0]):
        row, col, here = drifted(boundary, items.row[i], items.col[i], 0.0, 0.0, 0.0)
        wait = soonest(ways, kind, at, here)
        if wait >= FAR:
            continue
        if wait > 1.0:
            of = min(i, drift_rc.shape[0] - 1)
            row, col, here = drifted(
                boundary, row, col, drift_rc[of, 0], drift_rc[of, 1], wait - 1.0
            )
        if place[here] < 0:
            place[here] = n
            node[n], worth[n], delay[n] = here, 0.0, max(wait, 1.0)
            n += 1
        worth[place[here]] += items.weight[i]
        quays[place[here]] = max(quays[place[here]], quays_beside(boundary, row, col, here))
    for i in range(n):
        place[node[i]] = -1
        stay[i] = dwell(taking, worth[i])
        delay[i] += taking.usual[quays[i]]
    order = np.argsort((delay[:n] + stay[:n]) / worth[:n], kind="mergesort")
    n = min(n, found.node.size)
    for i in range(n):
        found.node[i], found.weight[i] = node[order[i]], worth[order[i]]
        found.dwell[i], found.quays[i] = stay[order[i]], quays[order[i]]
    found.number[0] = n


@kernel
def decisions_between(
    found: Stops, ways: tuple[Ways, ...], kind: NDArray[np.int64], at: Int32Array, stay: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Decisions from every forager to every stop (forager, stop), and (kind, stop, stop) between.

    Those from a stop to another begin with the stay there.
    Collecting needs a decision that ends in the node: where one already is, it takes one decision
    of staying, or two of going away and coming back.
    """
    n, again = found.number[0], 1.0 if stay else 2.0
    first = np.empty((at.size, n))
    between = np.empty((len(ways), n, n))
    for j in range(n):
        for k in range(len(ways)):
            mine = ways[k]
            row = mine.decisions[row_to(mine, found.node[j])]
            for i in range(n):
                between[k, i, j] = found.dwell[i] + _counted(row[found.node[i]], again)
            for f in range(at.size):
                if kind[f] == k:
                    first[f, j] = _counted(row[at[f]], again)
    return first, between


@kernel
def _counted(decisions: np.uint16, again: float) -> float:
    """Decisions as a number: `FAR` out of reach, `again` where one already is."""
    if decisions == UNREACHED:
        return FAR
    return float(decisions) if decisions > 0 else again


@kernel
def add_pickup(
    taking: Taking,
    boundary: Boundary,
    found: Stops,
    agents: NDArray[np.int64],
    at: Int32Array,
    yaw: NDArray[np.float64],
    first: NDArray[np.float64],
    between: NDArray[np.float64],
) -> None:
    """Add the time of collecting the first item of every stop.

    In the nodes next to a forager that depends on how it heads.

    Parameters
    ----------
    agents, at, yaw : (forager,) index in the fleet, node, heading [rad], 0 = east
    first, between : as of `decisions_between`, added to
    """
    if taking.more == 0.0 and not taking.first.any():
        return  # as in the graph
    for j in range(first.shape[1]):
        quays = found.quays[j]
        for f in range(at.size):
            if first[f, j] > 1.0 or found.node[j] == at[f]:
                first[f, j] += taking.usual[quays]
                continue
            up = boundary.rows[at[f]] - boundary.rows[found.node[j]]
            east = boundary.cols[found.node[j]] - boundary.cols[at[f]]
            first[f, j] += turning(taking, agents[f], quays, math.atan2(up, east) - yaw[f])
        between[:, :, j] += taking.usual[quays]
