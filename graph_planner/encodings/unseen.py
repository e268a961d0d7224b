"""Nodes of idleness 1, called unseen, those to look at again, and the ways to the unseen ones."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array

DUE = 0.5  # from this much on a node is due to be looked at again


class Unseen(NamedTuple):
    """Lists of nodes of a row; scratch memory. `list_nodes` tells how many entries count."""

    nodes: Int32Array  # (node,) of idleness 1
    edge: Int32Array  # (node,) those of them beside a cell of less
    due: Int32Array  # (node,) nodes to look at again
    seen: NDArray[np.uint8]  # (place,) 1 where idleness is less than 1, see `Chart.place`
    beside: NDArray[np.uint8]  # (place,) 1 there and to the left and right of it

    @classmethod
    def of(cls, nodes: int, places: int) -> "Unseen":
        """Memory for a map of so many nodes, and so many places with its frame."""
        return cls(
            np.zeros(nodes, np.int32),
            np.zeros(nodes, np.int32),
            np.zeros(nodes, np.int32),
            np.zeros(places, np.uint8),
            np.zeros(places, np.uint8),
        )


@kernel
def list_nodes(
    idle: NDArray[np.float64],
    again: NDArray[np.float64],
    place: Int32Array,
    width: int,
    unseen: Unseen,
) -> tuple[int, int, int]:
    """Fill the lists of `Unseen`; how many unseen nodes there are, on their edge, and due.

    A shortest way from a seen node to the nearest unseen one leads over seen nodes only, so it ends
    on the edge: who asks for that distance need not look at the others.

    Parameters
    ----------
    idle, again : (node,) see `Fields`
    place, width : see `Chart`
    """
    nodes, edge, due, seen, beside = unseen
    for node in range(idle.size):
        seen[np.uint64(place[node])] = idle[node] < 1.0
    for i in range(1, seen.size - 1):
        beside[i] = seen[i - 1] | seen[i] | seen[i + 1]
    one = np.uint64(1)
    count, on_edge, n_due = np.uint64(0), np.uint64(0), np.uint64(0)
    for node in range(idle.size):  # without a branch
        middle = np.uint64(place[node])
        north, south = middle - np.uint64(width), middle + np.uint64(width)
        near = beside[north] | beside[middle] | beside[south]
        fresh = idle[node] >= 1.0
        nodes[count] = edge[on_edge] = due[n_due] = node
        count += one if fresh else np.uint64(0)
        on_edge += np.uint64(near) if fresh else np.uint64(0)
        n_due += one if again[node] >= DUE else np.uint64(0)
    return int(count), int(on_edge), int(n_due)


@kernel
def nearest_is_itself(
    idle: NDArray[np.float64], targets: Int32Array, out: NDArray[np.float64]
) -> None:
    """Put 0 where a target (agent, 9) is unseen itself into distances to the nearest unseen node.

    Parameters
    ----------
    out : (agent, 9) those to the nearest on the edge [node]
    """
    for a in range(targets.shape[0]):
        for move in range(9):
            if targets[a, move] >= 0 and idle[targets[a, move]] >= 1.0:
                out[a, move] = 0.0
