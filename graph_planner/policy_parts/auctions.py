"""Sequential single-item auctions: tours of known items, and places of scouts.

In every round all bidders bid on all that is unsold, the smallest bid wins, and the winner's bids
change: S. Koenig et al., "The Power of Sequential Single-Item Auctions for Agent Coordination",
AAAI 2006. Times are in decisions, by geodesic distances over an agent's nodes per decision.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.graph.geodesics import (
    FAR,
    DistanceRows,
    Int32Array,
    Workspace,
    distances_of,
)
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import TaskArrays

FloatArray = NDArray[np.float64]

UNSOLD = -1


class Bidders(NamedTuple):
    """Bidders on items."""

    pace: FloatArray  # (bidder,) nodes per decision
    room: NDArray[np.int64]  # (bidder,) items
    energy: FloatArray  # (bidder,) [node]
    tie: FloatArray  # (bidder,) added to bids: who wins among equals


class Lots(NamedTuple):
    """Lots for sale: nodes with known items."""

    first: FloatArray  # (bidder, lot) way from each bidder [node]
    between: FloatArray  # (lot, lot) [node]
    items: NDArray[np.int64]  # (lot,)
    tie: FloatArray  # (lot,) added to bids


@kernel
def insertion(
    bidder: int,
    lot: int,
    path: Int32Array,
    pace: float,
    energy: float,
    lots: Lots,
) -> tuple[float, int]:
    """Smallest bid on a lot, and the place in the bidder's path where it costs that; inf if none.

    A bid is by how much the mean time until an item is met grows (MiniAve).

    Parameters
    ----------
    path : (stop,) lots that the bidder has won, in the order in which it goes
    pace, energy : of the bidder, see `Bidders`
    """
    first, between, items = lots.first, lots.between, lots.items
    length, later = 0.0, 0  # of the whole path; items of the stops from the place on
    for i in range(path.size):
        length += first[bidder, path[0]] if i == 0 else between[path[i - 1], path[i]]
        later += items[path[i]]
    best, place, so_far = FAR, 0, 0.0
    for i in range(path.size + 1):
        to_lot = first[bidder, lot] if i == 0 else between[path[i - 1], lot]
        detour, leg = to_lot, 0.0
        if i < path.size:
            leg = first[bidder, path[0]] if i == 0 else between[path[i - 1], path[i]]
            detour += between[lot, path[i]] - leg
        if length + detour <= energy:
            bid = so_far + to_lot + detour * later / items[lot]
            if bid / pace < best:
                best, place = bid / pace, i
        if i < path.size:
            so_far += leg
            later -= items[path[i]]
    return best, place


@kernel
def sell_items(bidders: Bidders, lots: Lots, path: Int32Array, size: Int32Array) -> None:
    """Sell lots one by one until there are no bids.

    An agent bids on no more than it has room for, and on nothing beyond its energy.

    Parameters
    ----------
    path : (bidder, lot) filled: the first `size` are what each won, in the order in which it goes
    size : (bidder,) filled
    """
    first, items, lot_tie = lots.first, lots.items, lots.tie
    pace, room, energy, tie = bidders.pace, bidders.room, bidders.energy, bidders.tie
    n_bidders, n_lots = first.shape
    bids, places = np.full((n_bidders, n_lots), FAR), np.zeros((n_bidders, n_lots), np.int32)
    load, sold = np.zeros(n_bidders, np.int64), np.zeros(n_lots, np.bool_)
    size[:] = 0
    changed_from, changed_to = 0, n_bidders
    for _ in range(n_lots):
        for f in range(changed_from, changed_to):
            for lot in range(n_lots):
                bids[f, lot] = FAR
                if not sold[lot] and load[f] < room[f]:
                    won = path[f, : size[f]]
                    bid, place = insertion(f, lot, won, pace[f], energy[f], lots)
                    bids[f, lot], places[f, lot] = bid + tie[f] + lot_tie[lot], place
        winner, what = UNSOLD, UNSOLD
        for f in range(n_bidders):
            for lot in range(n_lots):
                if not sold[lot] and bids[f, lot] < (FAR if winner < 0 else bids[winner, what]):
                    winner, what = f, lot
        if winner < 0:
            return
        for i in range(size[winner], places[winner, what], -1):
            path[winner, i] = path[winner, i - 1]
        path[winner, places[winner, what]] = what
        size[winner] += 1
        load[winner] += items[what]
        sold[what] = True
        changed_from, changed_to = winner, winner + 1


@kernel
def ways_between(
    table: DistanceRows,
    neighbours: Int32Array,
    workspace: Workspace,
    sources: Int32Array,
    targets: Int32Array,
) -> FloatArray:
    """(source, target) geodesic distances [node]."""
    out = np.empty((sources.size, targets.size))
    for i in range(sources.size):
        row = distances_of(table, neighbours, sources[i], workspace)
        for j in range(targets.size):
            out[i, j] = row[targets[j]]
    return out


@kernel
def in_view(worth: FloatArray, views: NodeLists, radius: int, node: int) -> float:
    """Sum of the worth (node,) of what is seen from a node."""
    start, nodes = views.start, views.nodes
    found = 0.0
    for i in range(start[radius, node], start[radius, node + 1]):
        found += worth[np.uint64(nodes[np.uint64(i)])]
    return found


@kernel
def _look_again(
    places: Int32Array,
    near: int,
    radius: NDArray[np.float64],
    arrays: TaskArrays,
    views: NodeLists,
    worth: FloatArray,
    shows: FloatArray,
) -> None:
    """Sum anew what places (list, place) show whose views may overlap that of the node `near`."""
    rows, cols, widest = arrays.rows, arrays.cols, radius.max()
    for number in range(radius.size):
        reach = radius[number] + widest
        for c in range(places.size):
            place = places[c]
            if near < 0 or (
                abs(rows[place] - rows[near]) <= reach and abs(cols[place] - cols[near]) <= reach
            ):
                shows[number, c] = in_view(worth, views, number, place)


@kernel
def sell_views(
    places: Int32Array,
    ways: FloatArray,
    bidders: NDArray[np.int64],
    arrays: TaskArrays,
    views: NodeLists,
    patience: float,
    tie: FloatArray,
    worth: FloatArray,
    won: Int32Array,
) -> None:
    """Sell places to look from, one to each bidder: the best rate of worth over time wins.

    What a place that is sold shows is worth nothing to the others any more.

    Parameters
    ----------
    places : (place,) nodes
    ways : (bidder, place) [node]; inf where a bidder cannot go
    bidders : (bidder,) agents
    patience : added to every way's time [decision]
    tie : (place,) factor of a rate, about 1
    worth : (node,) of seeing each node now; changed
    won : (bidder,) filled: node, `UNSOLD` if all is worthless
    """
    won[:] = UNSOLD
    start, nodes = views.start, views.nodes
    pace, radius_number = arrays.moves[bidders], arrays.radius_number[bidders]
    radius, shows = np.zeros(start.shape[0]), np.zeros((start.shape[0], places.size))
    for a in range(arrays.radius.size):
        radius[arrays.radius_number[a]] = arrays.radius[a]
    sold = UNSOLD
    for _ in range(bidders.size):
        _look_again(places, sold, radius, arrays, views, worth, shows)
        best, winner = 0.0, UNSOLD
        for s in range(bidders.size):
            if won[s] != UNSOLD:
                continue
            visible = shows[radius_number[s]]
            for c in range(places.size):
                rate = tie[c] * visible[c] / (ways[s, c] / pace[s] + patience)
                if rate > best:
                    best, winner, sold = rate, s, places[c]
        if winner < 0:
            return
        won[winner] = sold
        list_number = radius_number[winner]
        for i in range(start[list_number, sold], start[list_number, sold + 1]):
            worth[nodes[i]] = 0.0
