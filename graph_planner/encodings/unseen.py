"""Nodes of idleness 1, called unseen, those to look at again, and the ways to the unseen ones."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.encodings.chart import Chart
from graph_planner.encodings.samples import Distances
from graph_planner.geodesics import Int32Array, distances_to_nearest
from graph_planner.seeking import longest_move
from graph_planner.task import TaskArrays

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
        lists = (np.zeros(nodes, np.int32) for _ in range(3))
        return cls(*lists, np.zeros(places, np.uint8), np.zeros(places, np.uint8))


@kernel
def list_nodes(
    idle: NDArray[np.float64], again: NDArray[np.float64], chart: Chart, unseen: Unseen
) -> tuple[int, int, int]:
    """Fill the lists of `Unseen`; how many unseen nodes there are, on their edge, and due.

    Parameters
    ----------
    idle, again : (node,) see `Fields`
    """
    place, width, seen, beside = chart.place, chart.width, unseen.seen, unseen.beside
    nodes, edge, due = unseen.nodes, unseen.edge, unseen.due
    for node in range(idle.size):
        seen[np.uint64(place[node])] = idle[node] < 1.0
    for i in range(1, seen.size - 1):
        beside[i] = seen[i - 1] | seen[i] | seen[i + 1]
    count, on_edge, n_due = 0, 0, 0
    for node in range(idle.size):  # without a branch
        middle = place[node]
        north, south = np.uint64(middle - width), np.uint64(middle + width)
        near = beside[north] | beside[np.uint64(middle)] | beside[south]
        fresh = idle[node] >= 1.0
        nodes[count] = edge[on_edge] = due[n_due] = node
        count += fresh
        on_edge += fresh & (near > 0)
        n_due += again[node] >= DUE
    return count, on_edge, n_due


@kernel
def ways_to_unseen(
    arrays: TaskArrays,
    edge: Int32Array,
    idle: NDArray[np.float64],
    agent_node: Int32Array,
    targets: Int32Array,
    distances: Distances,
    out: NDArray[np.float64],
) -> None:
    """Distance of possible targets (agent, 9) to the nearest unseen node [node]; inf without any.

    A shortest way from a seen node to the nearest unseen one leads over seen nodes only, so it ends
    on the edge of the unseen: only that is searched.

    Parameters
    ----------
    edge : (chosen,) unseen nodes beside a seen cell
    """
    slack = longest_move(arrays.moves)
    neighbours, table, workspace = arrays.neighbours, arrays.distances, distances.workspace
    distances_to_nearest(neighbours, table, edge, agent_node, targets, slack, workspace, out)
    for a in range(agent_node.size):
        for move in range(9):
            if targets[a, move] >= 0 and idle[targets[a, move]] >= 1.0:
                out[a, move] = 0.0
