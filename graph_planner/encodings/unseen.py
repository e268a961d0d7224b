"""Nodes of idleness 1, called unseen, and the ways to them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.encodings.chart import WORD
from mjforage.graph_planner.graph.geodesics import Int32Array

_ALL = np.uint64(0x0101010101010101)  # a word full of ones


class Unseen(NamedTuple):
    """Lists of nodes of a row; scratch memory. `list_nodes` tells how many entries count."""

    nodes: Int32Array  # (node + WORD,) of idleness 1
    new: NDArray[np.uint8]  # (node,) 1 at those; some more of 0, to fill the last word
    edge: Int32Array  # (node + WORD,) those of them beside a cell of less
    fresh: NDArray[np.uint8]  # (place,) 1 at nodes of idleness 1, see `Chart.place`
    seen: NDArray[np.uint8]  # (place,) 1 at all others
    beside: NDArray[np.uint8]  # (place,) 1 there and to the left and right of them
    near: NDArray[np.uint8]  # (place,) 1 on the edge

    @classmethod
    def of(cls, nodes: int, places: int) -> "Unseen":
        """Memory for a map of so many nodes, and so many places with its frame."""
        maps = (np.zeros(places, np.uint8) for _ in range(4))
        new = np.zeros(-(-nodes // WORD) * WORD, np.uint8)
        lists = (np.zeros(nodes + WORD, np.int32) for _ in range(2))
        return cls(next(lists), new, next(lists), *maps)


@kernel
def _list_edge(water_at: NDArray[np.uint8], node_at: Int32Array, width: int, unseen: Unseen) -> int:
    """Fill the list of the edge from `fresh`; how many nodes are on it."""
    edge, fresh, seen = unseen.edge, unseen.fresh, unseen.seen
    beside, near = unseen.beside, unseen.near
    for i in range(fresh.size):
        seen[i] = water_at[i] ^ fresh[i]
    for i in range(1, fresh.size - 1):
        beside[i] = seen[i - 1] | seen[i] | seen[i + 1]
    north, south = beside[: -2 * width], beside[2 * width :]
    middle, here, out = beside[width:-width], fresh[width:-width], near[width:-width]
    for i in range(out.size):
        out[i] = (north[i] | middle[i] | south[i]) & here[i]
    words, on_edge = near.view(np.uint64), np.uint64(0)
    for word in range(words.size):
        if words[word]:  # most of them are 0
            for i in range(WORD * word, WORD * word + WORD):
                edge[on_edge] = node_at[i]
                on_edge += np.uint64(near[i])
    return int(on_edge)


@kernel
def list_nodes(
    idle: NDArray[np.float64],
    place: Int32Array,
    water_at: NDArray[np.uint8],
    node_at: Int32Array,
    width: int,
    unseen: Unseen,
) -> tuple[int, int]:
    """Fill the lists of `Unseen`; how many unseen nodes there are, and how many on their edge.

    A shortest way from a seen node to the nearest unseen one leads over seen nodes only, so it ends
    on the edge: for that distance the others do not matter.

    `idle`: (node,) see `Fields`; `place`, `water_at`, `node_at`, `width`: see `Chart`.
    """
    nodes, new, fresh, count = unseen.nodes, unseen.new, unseen.fresh, np.uint64(0)
    for node in range(idle.size):
        new[node] = idle[node] >= 1.0
    for node in range(idle.size):
        fresh[np.uint64(place[node])] = new[node]
    words = new.view(np.uint64)
    for word in range(words.size):
        if words[word] == _ALL:
            for i in range(WORD):
                nodes[count + np.uint64(i)] = WORD * word + i
            count += np.uint64(WORD)
        elif words[word]:  # most of them are 0 or full
            for i in range(WORD * word, WORD * word + WORD):
                nodes[count] = i
                count += np.uint64(new[i])
    return int(count), _list_edge(water_at, node_at, width, unseen)


@kernel
def nearest_is_itself(
    idle: NDArray[np.float64], targets: Int32Array, out: NDArray[np.float64]
) -> None:
    """Put 0 where a target (agent, 9) is unseen itself into distances to the nearest unseen node.

    `out`: (agent, 9) those to the nearest on the edge [node].
    """
    for a in range(targets.shape[0]):
        for move in range(9):
            if targets[a, move] >= 0 and idle[targets[a, move]] >= 1.0:
                out[a, move] = 0.0
