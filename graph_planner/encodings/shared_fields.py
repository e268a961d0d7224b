"""Fields that all agents of a row share in the egocentric encoding: idleness, ways, stale nodes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.encodings.chart import COARSE, REACH, Chart
from mjforage.graph_planner.encodings.codes import Hopeful, targets_to_nearest
from mjforage.graph_planner.encodings.encoder import TOP, Levels, item_level
from mjforage.graph_planner.encodings.samples import (
    Distances,
    Sample,
    choose_evenly,
    measure,
    share_out,
)
from mjforage.graph_planner.encodings.unseen import Unseen, list_nodes, nearest_is_itself
from mjforage.graph_planner.encodings.ways import ItemWays, find_ways
from mjforage.graph_planner.graph.geodesics import Int32Array, distances_to_nearest
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.graph_planner.policy_parts.seeking import longest_move, possible_targets
from mjforage.mission.task import Observation, Task, TaskArrays

# Nodes to look at again are those to which an item that was believed near them may have drifted
# unseen. The three numbers are estimates.
AGAIN_RADIUS = 4.0  # how far from the believed item [node]
AGAIN_GROWTH = 4.0  # seeing one again counts in full from idleness 1 / AGAIN_GROWTH on
DUE = 0.5  # from this much on a node is due to be looked at again
IDLENESS, ITEMS, WAY, AGAIN = 0, 8, 16, 24  # where a node's levels stand in its 32 bits


class Fields(NamedTuple):
    """Fields that all agents of a row share; scratch memory, written for every row."""

    idle: NDArray[np.float64]  # (node,) idleness
    again: NDArray[np.float64]  # (place,) of `Nearby.nodes`: 0-1, the more the longer unseen
    due: Int32Array  # (node,) nodes to look at again
    levels: NDArray[np.uint32]  # (node + 1,) four levels of each in 8 bits; of land, the last: 0
    targets: Int32Array  # (agent, 9) where moves would end, -1 if illegal; the last: its own node
    unseen_way: NDArray[np.float64]  # (agent, 9) from there to the nearest unseen node, or inf
    unseen: Unseen
    hopeful: Hopeful
    nearest: NDArray[np.uint16]  # (node,) memory of `find_ways`
    four: NDArray[np.uint32]  # (SIDE^2,) `levels` around an agent
    cell_items: NDArray[np.int64]  # (COARSE^2,) believed items
    cell_again: NDArray[np.float64]  # (COARSE^2,) sum of `again`; 0 between looks
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
            due=np.zeros(nodes, np.int32),
            levels=np.zeros(nodes + 1, np.uint32),
            targets=np.zeros((agents, 9), np.int32),
            unseen_way=np.zeros((agents, 9)),
            unseen=Unseen.of(nodes, chart.water_at.size),
            hopeful=Hopeful.of(nodes),
            nearest=np.zeros(nodes, np.uint16),
            four=np.zeros((2 * REACH + 1) ** 2, np.uint32),
            cell_items=np.zeros(COARSE**2, np.int64),
            cell_again=np.zeros(COARSE**2),
            some_items=Sample.empty(agents),
            some_unseen=Sample.empty(agents),
            some_due=Sample.empty(agents),
        )


class Nearby(NamedTuple):
    """Nodes with items believed in the present episode of every row, and those around."""

    believed: NDArray[np.bool_]  # (row, node) an item was believed there once
    marked: NDArray[np.bool_]  # (row, node) or near it
    nodes: Int32Array  # (row, node) the marked ones, ascending
    size: Int32Array  # (row,) how many of them there are

    @classmethod
    def none_yet(cls, rows: int, nodes: int) -> "Nearby":
        """Empty fields of so many rows, on a map of so many nodes."""
        return cls(
            np.zeros((rows, nodes), np.bool_),
            np.zeros((rows, nodes), np.bool_),
            np.zeros((rows, nodes), np.int32),
            np.zeros(rows, np.int32),
        )


@kernel
def remember_items(
    rows: NDArray[np.int64], seen: Observation, around: NodeLists, nearby: Nearby
) -> None:
    """Mark the surroundings of every node at which an item has ever been believed."""
    step, known, n_known = seen.step, seen.known, seen.n_known
    believed, marked, nodes, size = nearby
    start, those_around = around.start, around.nodes
    for e in rows:
        if step[e] <= 1:
            believed[e] = marked[e] = False
            size[e] = 0
        more = False
        for i in range(n_known[e]):
            node = known[e, i]
            if not believed[e, node]:
                believed[e, node] = more = True
                for k in range(start[0, node], start[0, node + 1]):
                    marked[e, those_around[k]] = True
        if more:
            size[e] = 0
            for node in range(marked.shape[1]):
                if marked[e, node]:
                    nodes[e, size[e]] = node
                    size[e] += 1


@kernel
def _level(
    now: int,
    last_seen: NDArray[np.int16],
    forgetting: float,
    way_levels: Levels,
    idle: NDArray[np.float64],
    levels: NDArray[np.uint32],
) -> None:
    """Idleness of every node, and its levels of idleness and way in one number.

    All in signed numbers of 32 bits, which processors convert several at a time.
    """
    for node in range(idle.size):
        age = np.float64(np.int32(now - np.int32(last_seen[node]))) * forgetting
        idle[node] = 1.0 if age > 1.0 else age
    for node in range(idle.size):
        number = np.int32(np.int32(TOP * idle[node]) << IDLENESS)
        levels[node] = np.uint32(np.int32(number | np.int32(np.int32(way_levels[node]) << WAY)))


@kernel
def _look_again(
    nodes: Int32Array,
    idle: NDArray[np.float64],
    chart: Chart,
    fields: Fields,
    global_map: Levels,
) -> int:
    """Nodes near items of before that are to be looked at again; returns how many are due.

    Fills `again` and `due`, that level of each node, and channel 3 of the coarse map.
    """
    again, due, levels, cell_again = fields.again, fields.due, fields.levels, fields.cell_again
    coarse, extent, wet = chart.coarse, chart.extent, chart.wet
    n_due = 0
    for i in range(nodes.size):
        node = nodes[i]
        grown = AGAIN_GROWTH * idle[node]
        again[i] = 1.0 if grown > 1.0 else grown
        levels[node] |= np.uint32(TOP * again[i]) << AGAIN
        cell_again[coarse[node]] += again[i]
        due[n_due] = node
        n_due += again[i] >= DUE
    for cell in wet:
        global_map[3, cell] = 0
    for node in nodes:
        cell = coarse[node]
        if cell_again[cell] > 0.0:
            global_map[3, cell] = np.uint8(TOP * min(1.0, cell_again[cell] / extent[cell]))
            cell_again[cell] = 0.0
    return n_due


@kernel
def _paint_coarse(
    known: Int32Array,
    belief: NDArray[np.int16],
    chart: Chart,
    idle: NDArray[np.float64],
    cell_items: NDArray[np.int64],
    global_map: Levels,
) -> None:
    """The whole map in COARSE x COARSE cells: the first three channels (channel, COARSE^2).

    Sums go through the nodes of a cell in ascending order, as rounding depends on it.
    """
    coarse, start, nodes = chart.coarse, chart.start, chart.nodes
    wet, water = chart.wet, chart.water
    for i in range(wet.size):
        cell, first, end = wet[i], start[i], start[i + 1]
        total = 0.0
        for k in range(first, end):
            total += idle[np.uint64(nodes[np.uint64(k)])]
        global_map[0, cell] = water[i]
        global_map[1, cell] = np.uint8(TOP * min(1.0, total / (end - first)))
        global_map[2, cell] = 0
    for node in known:
        cell_items[coarse[node]] = 0
    for node in known:
        cell_items[coarse[node]] += belief[node]
        global_map[2, coarse[node]] = item_level(cell_items[coarse[node]])


@inlined
def share_fields(
    e: int,
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    nearby: Nearby,
    ways: ItemWays,
    fields: Fields,
    distances: Distances,
    global_map: Levels,
) -> int:
    """Fill the fields of row e, and its ways; the number of unseen nodes.

    `global_map`: (channel, COARSE^2) whose first four channels are filled.
    """
    idle, levels, targets = fields.idle, fields.levels, fields.targets
    items, some_unseen, some_due = fields.some_items, fields.some_unseen, fields.some_due
    agent_node, belief, known = seen.agent_node[e], seen.belief[e], seen.known[e, : seen.n_known[e]]
    neighbours, codes, unseen = arrays.neighbours, chart.codes, fields.unseen
    now, forgetting = seen.step[e] - 1, arrays.forgetting
    find_ways(e, known, neighbours, codes, distances.workspace, fields.nearest, ways)
    _level(now, seen.last_seen[e], forgetting, ways.level[e], idle, levels)
    for node in known:
        levels[node] |= np.uint32(item_level(belief[node])) << ITEMS
    _paint_coarse(known, belief, chart, idle, fields.cell_items, global_map)
    due = _look_again(nearby.nodes[e, : nearby.size[e]], idle, chart, fields, global_map)
    count, on_edge = list_nodes(
        idle, chart.place, chart.water_at, chart.node_at, chart.width, unseen
    )
    possible_targets(arrays, agent_node, targets)
    for a in range(agent_node.size):
        targets[a, STAY] = agent_node[a]
    edge, slack = unseen.edge[:on_edge], longest_move(arrays)
    if codes.code.shape[0] > 0:
        targets_to_nearest(
            codes, edge, agent_node, targets, slack, fields.hopeful, fields.unseen_way
        )
    else:
        distances_to_nearest(
            neighbours,
            arrays.distances,
            edge,
            agent_node,
            targets,
            slack,
            distances.workspace,
            fields.unseen_way,
        )
    nearest_is_itself(idle, targets, fields.unseen_way)
    choose_evenly(known, known.size, items)
    choose_evenly(unseen.nodes, count, some_unseen)
    choose_evenly(fields.due, due, some_due)
    measure(neighbours, codes, targets, distances, (items, some_due), some_unseen)
    share_out(arrays.collects, items)
    share_out(arrays.collects, some_due)
    return count
