"""The initial state of an episode: items, drift and starts, from its key alone.

Both dynamics start from the same world, so a graph run and a physics run of one seed differ in
their dynamics and in nothing else. Positions are (row, column) in node units; node centres are
integers.
"""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.errors import UserError
from mjforage.base.randomness import Stream, UInt64Array, normal, stream_key, uniform
from mjforage.base.views import read_only
from mjforage.forcing.steady import steady_wind
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import NavigationGraph, Water
from mjforage.graph_planner.graph.walls import WALLS, into_water
from mjforage.scenario.scenario import Items, Weather


@dataclass(frozen=True)
class InitialState:
    """Initial state of a batch of episodes."""

    n_items: Int32Array  # (episode,)
    item_rc: NDArray[np.float64]  # (episode, item, 2) [node]; padded to the largest episode
    item_node: Int32Array  # (episode, item) node; -1 for padding
    drift_rc: NDArray[np.float64]  # (episode, 2) constant drift [node/step], 0 if it is forced
    agent_node: Int32Array  # (episode, agent)

    def padded(self, items: int) -> "InitialState":
        """The same with places for at least so many items."""
        more = max(0, items - self.item_node.shape[1])
        return replace(
            self,
            item_rc=np.pad(self.item_rc, ((0, 0), (0, more), (0, 0))),
            item_node=np.pad(self.item_node, ((0, 0), (0, more)), constant_values=-1),
        )

    def of_rows(self, rows: NDArray[np.int64]) -> "InitialState":
        """Those of some episodes."""
        return InitialState(*(getattr(self, each.name)[rows] for each in fields(self)))


@kernel
def _nodes_of(water: Water, rc: NDArray[np.float64]) -> Int32Array:
    """Node of each position (position, 2)."""
    nodes = np.empty(rc.shape[0], np.int32)
    for i in range(rc.shape[0]):
        _, _, nodes[i] = into_water(water, 0, rc[i, 0], rc[i, 1])
    return nodes


def item_places(item_node: Int32Array) -> NDArray[np.int64]:
    """(episode,) leading places that hold an item or did, of (episode, item): the rest is padding.

    `item_node`: at step 0, -1 for padding.
    """
    place = np.arange(1, item_node.shape[1] + 1)
    places: NDArray[np.int64] = np.where(item_node >= 0, place, 0).max(axis=1, initial=0)
    return places


def nearest_nodes(water: Water, rc: NDArray[np.float64]) -> Int32Array:
    """(...,) node of each position (..., 2): its cell's, or the nearest one's on land [node]."""
    flat = np.ascontiguousarray(rc.reshape(-1, 2))
    nodes: Int32Array = _nodes_of(water, flat)
    return nodes.reshape(rc.shape[:-1])


@kernel
def _count_items(keys: UInt64Array, mean: float, std: float, otherwise: int) -> Int32Array:
    """Number of items of each episode: a rounded normal draw, `otherwise` if not positive."""
    counts = np.empty(keys.size, np.int32)
    for e in range(keys.size):
        count = int(np.round(mean + std * normal(stream_key(keys[e], Stream.ITEMS), 0, 0)))
        counts[e] = count if count > 0 else otherwise
    return counts


@kernel
def _scatter_items(
    keys: UInt64Array,
    water: Water,
    walls: int,
    counts: Int32Array,
    spread: float,
    hotspots: int,
    item_rc: NDArray[np.float64],
    item_node: Int32Array,
) -> None:
    """Place the items of each episode around its hotspots, in the water."""
    for e in range(keys.size):
        key = stream_key(keys[e], Stream.ITEMS)
        for k in range(counts[e]):
            cluster = k % hotspots
            hotspot = int(uniform(key, 1 + cluster, 1) * water.rows.size)
            row = water.rows[hotspot] + spread * normal(key, 2 * k, 2)
            col = water.cols[hotspot] + spread * normal(key, 2 * k + 1, 2)
            row, col, node = into_water(water, walls, row, col)
            item_rc[e, k, 0], item_rc[e, k, 1], item_node[e, k] = row, col, node


def _place_items(
    graph: NavigationGraph, items: Items, walls: int, keys: UInt64Array
) -> tuple[Int32Array, NDArray[np.float64], Int32Array]:
    counts = _count_items(keys, items.mean, items.std, items.otherwise)
    padded = (keys.size, int(counts.max(initial=1)))
    item_rc = np.zeros((*padded, 2))
    item_node = np.full(padded, -1, np.int32)
    spread = items.covariance_node2**0.5
    _scatter_items(keys, graph.water, walls, counts, spread, items.hotspots, item_rc, item_node)
    return counts, item_rc, item_node


def nodes_around(graph: NavigationGraph, nodes: Int32Array, count: int) -> Int32Array:
    """`count` nodes: the given ones, then those nearest to them by water (ties: lowest index).

    Raises `UserError` if the map has fewer nodes than agents.

    Parameters
    ----------
    nodes : (start,) distinct nodes
    count : number wanted; fewer than given cuts nothing off
    """
    if count > len(graph):
        raise UserError(
            f"{count} agents do not fit on a map of {len(graph)} nodes; use fewer agents"
        )
    if count <= nodes.size:
        return nodes
    order = np.argsort(graph.distances_from(nodes), kind="stable").astype(np.int32)
    others = order[~np.isin(order, nodes)]
    return np.concatenate((nodes, others[: count - nodes.size])).astype(np.int32)


@kernel
def _any_node(key: np.uint64, n_nodes: int) -> int:
    """A node drawn for an episode."""
    return int(uniform(stream_key(key, Stream.STARTS), 0, 0) * n_nodes)


@kernel
def _assign(keys: UInt64Array, starts: Int32Array, placed: Int32Array) -> None:
    """Give every agent one of the start nodes, in an order drawn per episode (Fisher-Yates)."""
    for e in range(keys.size):
        key, order = stream_key(keys[e], Stream.STARTS), starts.copy()
        for i in range(placed.shape[1]):
            j = i + int(uniform(key, i, 1) * (order.size - i))
            order[i], order[j] = order[j], order[i]
            placed[e, i] = order[i]


def _place_agents(
    graph: NavigationGraph, starts: Int32Array, n_agents: int, keys: UInt64Array
) -> Int32Array:
    """(episode, agent) a random assignment of the start nodes, or a random cluster without any."""
    placed = np.empty((keys.size, n_agents), np.int32)
    if starts.size:
        _assign(keys, nodes_around(graph, starts, n_agents), placed)
        return placed
    for e in range(keys.size):
        centre = np.array([_any_node(keys[e], len(graph))], np.int32)
        _assign(keys[e : e + 1], nodes_around(graph, centre, n_agents), placed[e : e + 1])
    return placed


def create_initial_state(
    graph: NavigationGraph,
    items: Items,
    weather: Weather,
    node_mps: float,
    starts: Int32Array,
    n_agents: int,
    keys: UInt64Array,
    walls: str = "clip",
    north_deg: float = 0.0,
) -> InitialState:
    """The worlds of a batch of episodes.

    Raises `UserError` if there are more agents than nodes.

    Parameters
    ----------
    node_mps : speed of a node per decision [m/s]
    starts : (start,) nodes to assign at random, or empty for a random cluster per episode
    keys : (episode,) episode keys
    walls : boundary condition of items on land, of `WALLS`
    north_deg : bearing of the map's y axis, clockwise from true north
    """
    drift = steady_wind(keys, weather, node_mps, north_deg).drift_rc
    counts, item_rc, item_node = read_only(_place_items(graph, items, WALLS.index(walls), keys))
    return InitialState(
        n_items=counts,
        item_rc=item_rc,
        item_node=item_node,
        drift_rc=read_only(np.zeros_like(drift) if weather.forced else drift),
        agent_node=read_only(_place_agents(graph, starts, n_agents, keys)),
    )
