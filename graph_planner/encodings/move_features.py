"""Features of each move of an agent: Greedy's terms and their longer-sighted relatives.

Features per move, values in [0, 1]: float32 in the environments, here uint8 levels of 1 / 255,
rounded down. An illegal move is 0 throughout. Gains are "nearer is more": 128 / 255 (0.50) is no
change, each node nearer adds and each farther takes 40 / 255 (0.16), cut off at 0 and 1; distances
are geodesic.

| feature | meaning | unit | value |
|---|---|---|---|
| 0 | legal | - | 1 |
| 1 | believed items in the target | item | 0.1 each, at most 1 |
| 2 | nearer to the nearest known item | node | gain |
| 3 | sum of idleness in view of the target | whole open disc | the share, at most 1 |
| 4 | nearer to the nearest node of idleness 1 | node | gain |
| 5 | nearer to the known items, on average | node | gain |
| 6 | nearer to the nodes of idleness 1, on average | node | gain |
| 7 | nearer to the nearest known item to which no teammate of its kind is nearer | node | gain |
| 8 | more of the attraction sum(0.85^d) over known items | 1 | (128 + 32 per unit) / 255 |
| 9 | nearer to the nodes to look at again, on average | node | gain |
| 10 | nearer to the nearest of them to which no teammate of its kind is nearer | node | gain |

5 to 10 look at up to 96 evenly chosen nodes.
"""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import inlined, kernel
from mjforage.graph_planner.encodings.chart import Chart
from mjforage.graph_planner.encodings.encoder import TOP, Levels, item_level
from mjforage.graph_planner.encodings.masks import legal_end
from mjforage.graph_planner.encodings.samples import mean_gain, nearest_own
from mjforage.graph_planner.encodings.shared_fields import Fields
from mjforage.graph_planner.graph.geodesics import FAR, Float32Array, Int32Array
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.mission.task import Observation, TaskArrays

MOVE_FEATURES = (
    *("legal", "items", "nearer item", "idleness", "nearer unseen", "nearer items on average"),
    *("nearer unseen on average", "nearer own item", "attraction"),
    *("nearer due on average", "nearer own due"),
)
MIDDLE, PER_NODE, PER_ATTRACTION = 128, 40.0, 32.0
FADING = 0.85  # estimate: half is left after four nodes


# Of an item, by its distance [node].
_PULLS = np.array([*(FADING**node for node in range(40)), 0.0])


@inlined
def _changed(gain: float, per_unit: float) -> int:
    """Level of a gain: more than the middle is nearer, or more."""
    return int(min(255.0, max(0.0, MIDDLE + per_unit * gain)))


@inlined
def _pull(distance: np.float32) -> float:
    """`FADING` to the power of a distance, which is rounded down; 0 from 40 nodes on."""
    return float(_PULLS[np.uint64(min(distance, np.float32(_PULLS.size - 1)))])


@kernel
def _attraction(bits: Int32Array, there: int, size: int) -> float:
    """Sum of the pulls of the first `size` nodes at their distances in a row of `Sample.bits`."""
    total = 0.0
    for i in range(size):
        total += _pull(np.int32(bits[there, i]).view(np.float32))
    return total


@kernel
def _idleness_in_view(first: int, end: int, nodes: Int32Array, idle: NDArray[np.float64]) -> float:
    """Sum of idleness of a list of nodes, in its order, on which rounding depends."""
    total = 0.0
    for i in range(first, end):
        total += idle[np.uint64(nodes[i])]
    return total


@inlined
def describe_moves(
    e: int,
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    fields: Fields,
    way: Float32Array,
    out: Levels,
) -> None:
    """Fill the features (agent, 9, feature) of all agents' moves in row e.

    `way`: (node,) of `ItemWays`.
    """
    belief, agent_node, collects = seen.belief[e], seen.agent_node[e], arrays.collects
    targets, number, energy = arrays.targets, arrays.stride_number, seen.energy_left[e]
    rows, cols, radius_number = arrays.rows, arrays.cols, arrays.radius_number
    idle, unseen_way = fields.idle, fields.unseen_way
    items, unseen, due = fields.some_items, fields.some_unseen, fields.some_due
    n_items, n_unseen, n_due = items.size[0], unseen.size[0], due.size[0]
    item_bits, item_nearest = items.bits, items.nearest
    due_bits, due_nearest = due.bits, due.nearest
    item_total, unseen_total, due_total = items.total, unseen.total, due.total
    start, nodes, disc = chart.views.start, chart.views.nodes, chart.disc
    for a in range(agent_node.size):
        node, radius, here, kind = agent_node[a], radius_number[a], 9 * a + STAY, int(collects[a])
        attraction = _attraction(item_bits, here, n_items)
        item_way = nearest_own(item_bits, item_nearest, n_items, kind, a, here)
        due_way = nearest_own(due_bits, due_nearest, n_due, kind, a, here)
        for move in range(9):
            end = legal_end(targets, number[a], rows, cols, node, move, energy[a])
            there = 9 * a + move
            if end < 0:
                for feature in range(len(MOVE_FEATURES)):
                    out[a, move, feature] = 0
                continue
            in_view = _idleness_in_view(start[radius, end], start[radius, end + 1], nodes, idle)
            out[a, move, 0] = TOP
            out[a, move, 1] = item_level(belief[end])
            out[a, move, 3] = np.uint8(TOP * min(1.0, in_view / disc[radius]))
            if move == STAY:  # nothing comes nearer
                for feature in (2, 4, 5, 6, 7, 8, 9, 10):
                    out[a, move, feature] = MIDDLE
                continue
            gain = way[node] - way[end] if way[node] < FAR else 0.0
            out[a, move, 2] = _changed(gain, PER_NODE)
            gain = unseen_way[a, STAY] - unseen_way[a, move] if unseen_way[a, STAY] < FAR else 0.0
            out[a, move, 4] = _changed(gain, PER_NODE)
            out[a, move, 5] = _changed(mean_gain(item_total, n_items, here, there), PER_NODE)
            out[a, move, 6] = _changed(mean_gain(unseen_total, n_unseen, here, there), PER_NODE)
            gain = (
                item_way - nearest_own(item_bits, item_nearest, n_items, kind, a, there)
                if item_way < FAR
                else 0.0
            )
            out[a, move, 7] = _changed(gain, PER_NODE)
            gain = _attraction(item_bits, there, n_items) - attraction
            out[a, move, 8] = _changed(gain, PER_ATTRACTION)
            out[a, move, 9] = _changed(mean_gain(due_total, n_due, here, there), PER_NODE)
            gain = (
                due_way - nearest_own(due_bits, due_nearest, n_due, kind, a, there)
                if due_way < FAR
                else 0.0
            )
            out[a, move, 10] = _changed(gain, PER_NODE)
