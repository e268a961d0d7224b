"""Auctions: known items are sold to foragers, places to look from to scouts, anew every decision.

Foragers bid on nodes with known items by what the cheapest insertion into their path costs: S.
Koenig et al., "The Power of Sequential Single-Item Auctions for Agent Coordination", AAAI 2006.
Scouts bid on frontiers, the borders of water seen lately and of water that is unseen or long
unseen: B. Yamauchi, "A frontier-based approach for autonomous exploration", CIRA 1997. Foragers
that win no item share out the places that the scouts go to. All agents bid again at every decision.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.option_ranges import check_at_least
from mjforage.base.randomness import Stream, stream_key, uniform
from mjforage.graph_planner.graph.geodesics import (
    FAR,
    DistanceRows,
    Int32Array,
    Workspace,
    distances_of,
)
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policies.registry import register
from mjforage.graph_planner.policy_parts.auctions import (
    UNSOLD,
    Bidders,
    FloatArray,
    Lots,
    in_view,
    sell_items,
    sell_views,
    ways_between,
)
from mjforage.graph_planner.policy_parts.kernel_policy import KernelPolicy, Preferences
from mjforage.graph_planner.policy_parts.seeking import TIE
from mjforage.mission.moves import move_length
from mjforage.mission.task import Observation, Task, TaskArrays

_MOVES, _AGENTS, _NODES = 0, 1 << 16, 1 << 18  # where the indices of draws begin
_ON_THE_WAY = 0.4  # node; what moves of one length are worth more at most for what they pass


class Terms(NamedTuple):
    """The options of the policy as kernels read them."""

    lots: int
    revisit: float
    refresh: float
    warm: float
    cool: float
    patience: float


class Harbour(NamedTuple):
    """The map as auctions read it."""

    arrays: TaskArrays
    views: NodeLists
    discs: NodeLists  # around an item: how far its neighbourhood reaches
    table: DistanceRows
    workspace: Workspace


@kernel
def _lots_of(known: Int32Array, ways: FloatArray, most: int, key: np.uint64) -> NDArray[np.int64]:
    """Known nodes (known,) for sale: those nearest to any bidder."""
    nearest = np.empty(known.size)
    for i in range(known.size):
        nearest[i] = TIE * uniform(key, _NODES + known[i], 0)
        nearest[i] += ways[:, i].min() if ways.shape[0] else 0.0
    order = np.argsort(nearest)
    return order[:most]


@kernel
def _share_items(
    terms: Terms, harbour: Harbour, seen: Observation, e: int, key: np.uint64, goals: Int32Array
) -> None:
    """Give foragers the first item of the path that they win as a goal (agent,)."""
    arrays, at, known = harbour.arrays, seen.agent_node[e], seen.known[e, : seen.n_known[e]]
    energy, room, neighbours = seen.energy_left[e], seen.room_left[e], arrays.neighbours
    table, workspace = harbour.table, harbour.workspace
    able = np.flatnonzero(arrays.collects & (room > 0) & (energy >= 1.0))
    if able.size == 0 or known.size == 0:
        return
    ways = ways_between(table, neighbours, workspace, at[able], known)
    lots = _lots_of(known, ways, terms.lots, key)
    nodes = known[lots]
    tie = np.empty(able.size)
    for i in range(able.size):
        tie[i] = TIE * uniform(key, _AGENTS + able[i], 0)
    lot_tie, items = np.empty(nodes.size), np.empty(nodes.size, np.int64)
    for i in range(nodes.size):
        lot_tie[i] = TIE * uniform(key, _NODES + nodes[i], 0)
        items[i] = seen.belief[e, nodes[i]]
    first = np.ascontiguousarray(ways[:, lots])
    between = ways_between(table, neighbours, workspace, nodes, nodes)
    bidders = Bidders(arrays.moves[able].astype(np.float64), room[able], energy[able], tie)
    path, size = np.empty((able.size, nodes.size), np.int32), np.empty(able.size, np.int32)
    sell_items(bidders, Lots(first, between, items, lot_tie), path, size)
    for i in range(able.size):
        if size[i] > 0:
            goals[able[i]] = nodes[path[i, 0]]


@kernel
def _warm(terms: Terms, discs: NodeLists, known: Int32Array, warmth: FloatArray) -> None:
    """Let water (node,) cool that no item is known near, and be warm where one is."""
    start, nodes = discs.start, discs.nodes
    warmth *= 1.0 - 1.0 / terms.cool
    for node in known:
        for i in range(start[0, node], start[0, node + 1]):
            warmth[nodes[i]] = 1.0


@kernel
def _judge(
    terms: Terms,
    now: int,
    last_seen: NDArray[np.int16],
    warmth: FloatArray,
    worth: FloatArray,
    due: NDArray[np.bool_],
) -> None:
    """Fill what seeing each node (node,) is worth now, and whether it has long been unseen."""
    revisit, refresh, warm = terms.revisit, terms.refresh, terms.warm
    for v in range(worth.size):
        age, heat = np.float64(now - np.int32(last_seen[v])), warmth[v]
        worth[v] = (1.0 - heat) * min(1.0, age / revisit) + heat * warm * min(1.0, age / refresh)
        due[v] = age >= (refresh if heat > 0.5 else revisit)


@kernel
def _frontier(neighbours: Int32Array, due: NDArray[np.bool_]) -> Int32Array:
    """Nodes beside a border of water seen lately and not; all nodes if there is none."""
    places, n = np.empty(due.size, np.int32), 0
    for v in range(due.size):
        for d in range(8):
            other = neighbours[v, d]
            if other >= 0 and due[other] != due[v]:
                places[n] = v
                n += 1
                break
    return places[:n] if n else np.arange(due.size).astype(np.int32)


@kernel
def _share_views(
    terms: Terms,
    harbour: Harbour,
    seen: Observation,
    e: int,
    key: np.uint64,
    lookers: NDArray[np.int64],
    worth: FloatArray,
    due: NDArray[np.bool_],
    goals: Int32Array,
) -> None:
    """Give lookers (looker,) the place that they win to look from as a goal (agent,)."""
    arrays, at, energy = harbour.arrays, seen.agent_node[e], seen.energy_left[e]
    if lookers.size == 0:
        return
    places = _frontier(arrays.neighbours, due)
    ways = ways_between(harbour.table, arrays.neighbours, harbour.workspace, at[lookers], places)
    for i in range(lookers.size):
        for j in range(places.size):
            if ways[i, j] > energy[lookers[i]]:
                ways[i, j] = FAR
    tie = np.empty(places.size)
    for j in range(places.size):
        tie[j] = 1.0 + TIE * uniform(key, _NODES + places[j], 0)
    won, views = np.empty(lookers.size, np.int32), harbour.views
    sell_views(places, ways, lookers, arrays, views, terms.patience, tie, worth, won)
    for i in range(lookers.size):
        goals[lookers[i]] = won[i]


@kernel
def _follow(harbour: Harbour, seen: Observation, e: int, key: np.uint64, goals: Int32Array) -> None:
    """Give foragers without a goal the places that scouts go to, by auction, one each in turn."""
    arrays, at, room, energy = harbour.arrays, seen.agent_node[e], seen.room_left, seen.energy_left
    collects = arrays.collects
    able = collects & (room[e] > 0) & (energy[e] >= 1.0) & (goals == UNSOLD)
    idle, scouts = np.flatnonzero(able), np.flatnonzero(~collects & (goals != UNSOLD))
    if idle.size == 0 or scouts.size == 0:
        return
    wanted = goals[scouts]
    nodes, table = at[idle], harbour.table
    ways = ways_between(table, arrays.neighbours, harbour.workspace, nodes, wanted)
    left = np.ones(wanted.size, np.bool_)
    for _ in range(idle.size):
        best, winner, what = FAR, UNSOLD, UNSOLD
        for i in range(idle.size):
            if goals[idle[i]] != UNSOLD:
                continue
            for j in range(wanted.size):
                bid = ways[i, j] / arrays.moves[idle[i]]
                bid += TIE * uniform(key, _AGENTS + idle[i] * 256 + scouts[j], 0)
                if left[j] and bid < best:
                    best, winner, what = bid, i, j
        if winner < 0:
            return
        goals[idle[winner]] = wanted[what]
        left[what] = False
        if not left.any():
            left[:] = True


@kernel
def _head_for(
    harbour: Harbour,
    a: int,
    node: int,
    goal: int,
    on_the_way: FloatArray,
    key: np.uint64,
    step: int,
    preferences: FloatArray,
) -> None:
    """Fill the preferences (move,) of an agent: down the way to its goal."""
    arrays = harbour.arrays
    targets, moves = arrays.targets[arrays.stride_number[a], node], arrays.moves[a]
    left = distances_of(harbour.table, arrays.neighbours, goal, harbour.workspace)
    for move in range(9):
        preferences[move] = -np.inf
        target = targets[move]
        if target >= 0 and left[target] < FAR:
            cost = 0.5 if move == STAY else 0.01 * move_length(move, moves)
            tie = TIE * uniform(key, _MOVES + 9 * a + move, step)
            preferences[move] = on_the_way[move] + tie - cost - left[target]


@kernel
def _passed(
    harbour: Harbour, a: int, node: int, belief: NDArray[np.int16], worth: FloatArray, warm: float
) -> FloatArray:
    """(move,) what moves of one length pass: items for foragers, worth seeing for scouts."""
    arrays, views = harbour.arrays, harbour.views
    targets, radius = arrays.targets[arrays.stride_number[a], node], arrays.radius_number[a]
    out = np.zeros(9)
    for move in range(9):
        target = targets[move]
        if target < 0 or move == STAY:
            continue
        if arrays.collects[a]:
            out[move] = _ON_THE_WAY if belief[target] > 0 else 0.0
        else:
            most = (views.start[radius, target + 1] - views.start[radius, target]) * max(1.0, warm)
            out[move] = _ON_THE_WAY * in_view(worth, views, radius, target) / most
    return out


@kernel
def _decide(
    terms: Terms,
    harbour: Harbour,
    warmth: FloatArray,
    preferences: FloatArray,
    seen: Observation,
) -> None:
    """Hold the auctions of every row, and fill the preferences by the goals that agents won."""
    active, step, keys, n_known = seen.active, seen.step, seen.keys, seen.n_known
    collects = harbour.arrays.collects
    n_agents, n_nodes = seen.agent_node.shape[1], warmth.shape[1]
    goals, due = np.empty(n_agents, np.int32), np.empty(n_nodes, np.bool_)
    worth, everyone_collects = np.empty(n_nodes), collects.all()
    for e in range(active.size):
        if not active[e]:
            continue
        key, now = stream_key(keys[e], Stream.POLICY), step[e] - 1
        goals[:] = UNSOLD
        _share_items(terms, harbour, seen, e, key, goals)
        _warm(terms, harbour.discs, seen.known[e, : n_known[e]], warmth[e])
        _judge(terms, now, seen.last_seen[e], warmth[e], worth, due)
        able = (seen.energy_left[e] >= 1.0) & (seen.room_left[e] > 0) & (goals == UNSOLD)
        lookers = np.flatnonzero(able if everyone_collects else ~collects)
        _share_views(terms, harbour, seen, e, key, lookers, worth.copy(), due, goals)
        _follow(harbour, seen, e, key, goals)
        for a in range(n_agents):
            node = seen.agent_node[e, a]
            passed = _passed(harbour, a, node, seen.belief[e], worth, terms.warm)
            if goals[a] == UNSOLD:
                passed[:] = 0.0
            goal = goals[a] if goals[a] != UNSOLD else node
            _head_for(harbour, a, node, goal, passed, key, step[e], preferences[e, a])


@register("auction")
class AuctionPolicy(KernelPolicy):
    """Sequential auctions: foragers buy known items, scouts places to look from.

    Parameters
    ----------
    lots : known nodes that are sold in a decision at most, the nearest
    revisit : water unseen for so long counts as unseen [decision]
    refresh : the same near known items, which drift [decision]
    warm : how much more water near known items is worth seeing
    near : how far from an item its neighbourhood reaches [node]
    cool : how long a neighbourhood without known items stays one (time constant) [decision]
    patience : added to the time of a scout's way in its bids; larger: it goes farther [decision]
    """

    def __init__(
        self,
        lots: int = 48,
        revisit: float = 120.0,
        refresh: float = 25.0,
        warm: float = 16.0,
        near: float = 6.0,
        cool: float = 30.0,
        patience: float = 2.0,
    ) -> None:
        times = {"revisit": revisit, "refresh": refresh, "cool": cool, "patience": patience}
        check_at_least("auction", 1, lots=lots, **times)
        check_at_least("auction", 0, warm=warm, near=near)
        scouting = float(revisit), float(refresh), float(warm), float(cool), float(patience)
        self._terms, self._near = Terms(lots, *scouting), float(near)

    def filled(self, task: Task, preferences: Preferences) -> BoundKernel[None]:
        """Down the way to what each agent won."""
        graph, nodes = task.graph, len(task.graph)
        table, workspace = graph.distance_rows, Workspace.of(nodes)
        harbour = Harbour(task.arrays, task.views, graph.discs((self._near,)), table, workspace)
        warmth = np.zeros((len(preferences), nodes))
        return BoundKernel(_decide, self._terms, harbour, warmth, preferences)
