"""What all agents of a row share in the egocentric encoding: idleness, ways, what to see again."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import inlined, kernel
from graph_planner.encodings.chart import COARSE, Chart
from graph_planner.encodings.encoder import TOP, Levels, item_level
from graph_planner.encodings.samples import (
    Distances,
    Sample,
    choose_evenly,
    measure,
    row_from,
    share_out,
)
from graph_planner.encodings.unseen import Unseen, list_nodes, nearest_is_itself
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

MOST_ROWS = 300  # of the table of distances that are compared; beyond it a search is quicker
# Nodes to look at again are those to which an item that was believed near them may have drifted
# unseen. The three numbers are estimates; DUE is in `unseen`.
AGAIN_RADIUS = 4.0  # how far from the believed item [node]
AGAIN_GROWTH = 4.0  # seeing one again counts in full from idleness 1 / AGAIN_GROWTH on
WAY_LEVELS = 2.0  # levels per node of distance: 0 from 127.5 nodes on
IDLENESS, ITEMS, WAY, AGAIN = 0, 8, 16, 24  # where a node's levels stand in its 32 bits


class Fields(NamedTuple):
    """What all agents of a row share; scratch memory, written for every row."""

    idle: NDArray[np.float64]  # (node,) idleness
    again: NDArray[np.float64]  # (node,) 0-1: items were believed near, and it is long unseen
    way: Float32Array  # (node,) distance to the nearest known item [node], or inf
    levels: NDArray[np.uint32]  # (node + 1,) four levels of each in 8 bits; of land, the last: 0
    targets: Int32Array  # (agent, 9) where moves would end, -1 if illegal; the last: its own node
    unseen_way: NDArray[np.float64]  # (agent, 9) from there to the nearest unseen node, or inf
    unseen: Unseen
    cell_items: NDArray[np.int64]  # (COARSE^2,) believed items
    some_items: Sample  # of the known nodes
    some_unseen: Sample  # of the nodes of idleness 1
    some_due: Sample  # of the nodes to look at again

    @classmethod
    def of(cls, task: Task, chart: Chart) -> "Fields":
        """Memory for a task."""
        nodes, agents = len(task.graph), len(task.fleet)
        return cls(
            idle=np.zeros(nodes),
            again=np.zeros(nodes),
            way=np.zeros(nodes, np.float32),
            levels=np.zeros(nodes + 1, np.uint32),
            targets=np.zeros((agents, 9), np.int32),
            unseen_way=np.zeros((agents, 9)),
            unseen=Unseen.of(nodes, chart.places),
            cell_items=np.zeros(COARSE**2, np.int64),
            some_items=Sample.empty(agents),
            some_unseen=Sample.empty(agents),
            some_due=Sample.empty(agents),
        )


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


@inlined
def way_level(distance: float) -> int:
    """Level of a distance [node]: less the farther, 0 where there is no way."""
    level = TOP - WAY_LEVELS * distance
    return int(level if level > 0.0 else 0.0)


@kernel
def _age(
    now: int,
    last_seen: NDArray[np.int16],
    forgetting: float,
    near_item: NDArray[np.bool_],
    idle: NDArray[np.float64],
    again: NDArray[np.float64],
) -> None:
    """Idleness of every node, and how much it is to be looked at again."""
    for node in range(idle.size):
        age = (now - np.int64(last_seen[node])) * forgetting
        idleness = 1.0 if age > 1.0 else age
        grown = AGAIN_GROWTH * idleness
        idle[node] = idleness
        again[node] = (1.0 if grown > 1.0 else grown) if near_item[node] else 0.0


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
def _level(
    idle: NDArray[np.float64],
    again: NDArray[np.float64],
    way: Float32Array,
    known: Int32Array,
    belief: NDArray[np.int16],
    levels: NDArray[np.uint32],
) -> None:
    """The four levels of every node in one number."""
    for node in range(idle.size):
        number = np.uint32(TOP * idle[node]) << IDLENESS
        number |= np.uint32(way_level(np.float64(way[node]))) << WAY
        levels[node] = number | np.uint32(TOP * again[node]) << AGAIN
    for node in known:
        levels[node] |= np.uint32(item_level(belief[node])) << ITEMS


@kernel
def _paint_coarse(
    known: Int32Array,
    belief: NDArray[np.int16],
    chart: Chart,
    idle: NDArray[np.float64],
    again: NDArray[np.float64],
    cell_items: NDArray[np.int64],
    globe: Levels,
) -> None:
    """The whole map in COARSE x COARSE cells: the first four channels (channel, COARSE^2).

    Sums go through the nodes of a cell in ascending order, as rounding depends on it.
    """
    coarse, start, nodes = chart.coarse, chart.start, chart.nodes
    wet, water = chart.wet, chart.water
    for i in range(wet.size):
        cell, first, end = wet[i], start[i], start[i + 1]
        sum_idle, sum_again = 0.0, 0.0
        for k in range(first, end):
            node = np.uint64(nodes[np.uint64(k)])
            sum_idle += idle[node]
            sum_again += again[node]
        globe[0, cell] = water[i]
        globe[1, cell] = np.uint8(TOP * min(1.0, sum_idle / (end - first)))
        globe[2, cell] = 0
        globe[3, cell] = np.uint8(TOP * min(1.0, sum_again / (end - first)))
    for node in known:
        cell_items[coarse[node]] = 0
    for node in known:
        cell_items[coarse[node]] += belief[node]
        globe[2, coarse[node]] = item_level(cell_items[coarse[node]])


@inlined
def share_fields(
    e: int,
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    near_item: NDArray[np.bool_],
    fields: Fields,
    distances: Distances,
    globe: Levels,
) -> int:
    """Fill the fields of row e; the number of unseen nodes.

    Parameters
    ----------
    near_item : (node,) see `remember_items`
    globe : (channel, COARSE^2) whose first four channels are filled
    """
    idle, again, way, targets = fields.idle, fields.again, fields.way, fields.targets
    items, some_unseen, some_due = fields.some_items, fields.some_unseen, fields.some_due
    agent_node, belief, known = seen.agent_node[e], seen.belief[e], seen.known[e, : seen.n_known[e]]
    neighbours, table, unseen = arrays.neighbours, arrays.distances, fields.unseen
    _age(seen.step[e] - 1, seen.last_seen[e], arrays.forgetting, near_item, idle, again)
    _ways(neighbours, table, known, distances.workspace, way)
    _level(idle, again, way, known, belief, fields.levels)
    _paint_coarse(known, belief, chart, idle, again, fields.cell_items, globe)
    count, on_edge, due = list_nodes(idle, again, chart.place, chart.width, unseen)
    possible_targets(arrays, agent_node, targets)
    targets[:, STAY] = agent_node
    edge, slack = unseen.edge[:on_edge], longest_move(arrays.moves)
    distances_to_nearest(
        neighbours, table, edge, agent_node, targets, slack, distances.workspace, fields.unseen_way
    )
    nearest_is_itself(idle, targets, fields.unseen_way)
    choose_evenly(known, known.size, items)
    choose_evenly(unseen.nodes, count, some_unseen)
    choose_evenly(unseen.due, due, some_due)
    rows, whole = distances.rows.distance, table.shape[0] > 0
    for a in range(agent_node.size):
        row = row_from(distances, whole, neighbours, agent_node[a])
        measure(rows, row, items.nodes, items.size[0], items.here[a])
        measure(rows, row, some_unseen.nodes, some_unseen.size[0], some_unseen.here[a])
        measure(rows, row, some_due.nodes, some_due.size[0], some_due.here[a])
    share_out(arrays.collects, items)
    share_out(arrays.collects, some_due)
    return count
