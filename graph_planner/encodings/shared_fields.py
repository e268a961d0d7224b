"""What all agents of a row share in the egocentric encoding: idleness, ways, what to see again."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.encodings.encoder import TOP, Levels
from graph_planner.encodings.samples import Distances, Sample, take_sample
from graph_planner.geodesics import (
    FAR,
    Float32Array,
    Int32Array,
    Workspace,
    distances_to_nearest,
    spread,
)
from graph_planner.navigation import STAY
from graph_planner.seeking import longest_move, possible_targets
from graph_planner.task import Observation, Task, TaskArrays
from graph_planner.visibility import NodeLists

REACH = 7  # nodes to each side in the crop
COARSE = 16  # cells per side of the coarse map
MOST_ROWS = 300  # of the table of distances that are compared; beyond it a search is quicker
# Nodes to look at again are those to which an item that was believed near them may have drifted
# unseen. The three numbers are estimates.
AGAIN_RADIUS = 4.0  # how far from the believed item [node]
AGAIN_GROWTH = 4.0  # seeing one again counts in full from idleness 1 / AGAIN_GROWTH on
DUE = 0.5  # from this level on it is due


class Chart(NamedTuple):
    """The map as the kernels here read it."""

    framed: Int32Array  # (row + 2 REACH, column + 2 REACH) node of each cell, -1 on land
    coarse: Int32Array  # (node,) cell of the coarse map
    cell_nodes: Int32Array  # (COARSE^2,) nodes in each
    water: Levels  # (COARSE^2,) level of the share of water
    views: NodeLists
    disc: NDArray[np.int64]  # (radius,) nodes in view on open water

    @classmethod
    def of(cls, task: Task) -> "Chart":
        """The chart of a task's map."""
        graph = task.graph
        height, width = graph.shape
        coarse = (graph.rows * COARSE // height) * COARSE + graph.cols * COARSE // width
        cells = np.arange(height)[:, None] * COARSE // height * COARSE
        cells = cells + np.arange(width)[None, :] * COARSE // width
        area = np.bincount(cells.reshape(-1), minlength=COARSE**2)
        nodes = np.bincount(coarse, minlength=COARSE**2)
        discs = graph.discs(task.view_radii)
        return cls(
            framed=np.pad(graph.node_of_cell, REACH, constant_values=-1),
            coarse=coarse.astype(np.int32),
            cell_nodes=nodes.astype(np.int32),
            water=(TOP * nodes // np.maximum(area, 1)).astype(np.uint8),
            views=task.views,
            disc=np.diff(discs.start, axis=1).max(axis=1).astype(np.int64),
        )


class Fields(NamedTuple):
    """What all agents of a row share; scratch memory, written for every row."""

    idle: NDArray[np.float64]  # (node,) idleness
    way: Float32Array  # (node,) distance to the nearest known item [node], or inf
    targets: Int32Array  # (agent, 9) where moves would end, -1 if illegal; the last: its own node
    unseen_way: NDArray[np.float64]  # (agent, 9) from there to the nearest unseen node, or inf
    unseen: Int32Array  # (node,) the first `n` are the nodes of idleness 1
    again: NDArray[np.float64]  # (node,) 0-1: items were believed near, and it is long unseen
    due: Int32Array  # (node,) the first `n` are nodes to look at again
    cell_idle: NDArray[np.float64]  # (COARSE^2,) sum of idleness
    cell_again: NDArray[np.float64]  # (COARSE^2,) sum of `again`
    cell_items: NDArray[np.int64]  # (COARSE^2,) believed items
    some_items: Sample  # of the known nodes
    some_unseen: Sample  # of the nodes of idleness 1
    some_due: Sample  # of the nodes to look at again

    @classmethod
    def of(cls, task: Task) -> "Fields":
        """Memory for a task."""
        nodes, agents = len(task.graph), len(task.fleet)
        return cls(
            idle=np.zeros(nodes),
            way=np.zeros(nodes, np.float32),
            targets=np.zeros((agents, 9), np.int32),
            unseen_way=np.zeros((agents, 9)),
            unseen=np.zeros(nodes, np.int32),
            again=np.zeros(nodes),
            due=np.zeros(nodes, np.int32),
            cell_idle=np.zeros(COARSE**2),
            cell_again=np.zeros(COARSE**2),
            cell_items=np.zeros(COARSE**2, np.int64),
            some_items=Sample.empty(),
            some_unseen=Sample.empty(),
            some_due=Sample.empty(),
        )


@kernel
def _ways(
    neighbours: Int32Array,
    table: Float32Array,
    known: Int32Array,
    workspace: Workspace,
    way: Float32Array,
) -> None:
    """Distance of every node to the nearest known item: from the table, or by a search."""
    way[:] = np.float32(np.inf)
    if table.shape[0] > 0 and known.size <= MOST_ROWS:
        for item in known:
            row = table[item]
            for node in range(way.size):
                way[node] = row[node] if row[node] < way[node] else way[node]
        return
    distance, touched = workspace.distance, workspace.touched
    count = spread(neighbours, known, np.empty(0, np.int32), workspace)
    for i in range(count):
        way[touched[i]] = np.float32(distance[touched[i]])
        distance[touched[i]] = FAR


@kernel
def remember_items(
    rows: NDArray[np.int64],
    seen: Observation,
    around: NodeLists,
    believed: NDArray[np.bool_],
    near_item: NDArray[np.bool_],
) -> None:
    """Mark the surroundings of every node at which an item has ever been believed.

    Parameters
    ----------
    believed, near_item : (row, node) the nodes themselves, and all around them; written
    """
    step, known, n_known = seen.step, seen.known, seen.n_known
    start, nodes = around.start, around.nodes
    for e in rows:
        if step[e] <= 1:
            believed[e] = False
            near_item[e] = False
        for i in range(n_known[e]):
            node = known[e, i]
            if not believed[e, node]:
                believed[e, node] = True
                for k in range(start[0, node], start[0, node + 1]):
                    near_item[e, nodes[k]] = True


@kernel
def share_fields(
    e: int,
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    near_item: NDArray[np.bool_],
    fields: Fields,
    distances: Distances,
) -> int:
    """Fill the fields of row e; the number of unseen nodes.

    Parameters
    ----------
    near_item : (node,) see `remember_items`
    """
    idle, unseen, coarse = fields.idle, fields.unseen, chart.coarse
    again, due, cell_again = fields.again, fields.due, fields.cell_again
    cell_idle, cell_items = fields.cell_idle, fields.cell_items
    last_seen, belief, now = seen.last_seen[e], seen.belief[e], seen.step[e] - 1
    forgetting = arrays.forgetting
    cell_idle[:] = 0.0
    cell_again[:] = 0.0
    cell_items[:] = 0
    count, n_due = 0, 0
    for node in range(idle.size):
        idle[node] = min(1.0, (now - np.int64(last_seen[node])) * forgetting)
        again[node] = min(1.0, AGAIN_GROWTH * idle[node]) if near_item[node] else 0.0
        cell_idle[coarse[node]] += idle[node]
        cell_again[coarse[node]] += again[node]
        cell_items[coarse[node]] += belief[node]
        if idle[node] >= 1.0:
            unseen[count] = node
            count += 1
        if again[node] >= DUE:
            due[n_due] = node
            n_due += 1
    neighbours, table, targets = arrays.neighbours, arrays.distances, fields.targets
    agent_node, known = seen.agent_node[e], seen.known[e, : seen.n_known[e]]
    workspace = distances.workspace
    _ways(neighbours, table, known, workspace, fields.way)
    possible_targets(arrays, agent_node, targets)
    targets[:, STAY] = agent_node
    slack = longest_move(arrays.moves)
    distances_to_nearest(
        neighbours, table, unseen[:count], agent_node, targets, slack, workspace, fields.unseen_way
    )
    take_sample(known, agent_node, arrays, distances, fields.some_items)
    take_sample(unseen[:count], agent_node, arrays, distances, fields.some_unseen)
    take_sample(due[:n_due], agent_node, arrays, distances, fields.some_due)
    return count
