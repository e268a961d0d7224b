"""What each move of an agent would lead to: Greedy's terms and their longer-sighted relatives.

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

from graph_planner.compiled import inlined, kernel
from graph_planner.encodings.chart import Chart
from graph_planner.encodings.encoder import TOP, Levels, item_level
from graph_planner.encodings.samples import Distances, distances_from, measure
from graph_planner.encodings.shared_fields import Fields
from graph_planner.geodesics import FAR, Float32Array, Int32Array
from graph_planner.navigation import STAY
from graph_planner.task import Observation, TaskArrays

MOVE_FEATURES = (
    *("legal", "items", "nearer item", "idleness", "nearer unseen", "nearer items on average"),
    *("nearer unseen on average", "nearer own item", "attraction"),
    *("nearer due on average", "nearer own due"),
)
MIDDLE, PER_NODE, PER_ATTRACTION = 128, 40.0, 32.0
FADING = 0.85  # estimate: half is left after four nodes


_POWERS = np.power(FADING, np.arange(40)).astype(np.float64)


@inlined
def _changed(gain: float, per_unit: float) -> int:
    """Level of a gain: more than the middle is nearer, or more."""
    return int(min(255.0, max(0.0, MIDDLE + per_unit * gain)))


@kernel
def _mean_gain(here: Float32Array, there: Float32Array, size: int) -> float:
    """By how much nearer the first `size` places are in `there` than in `here`, on average [node].

    Four sums side by side: in one, every addition would wait for the one before. They give the
    same: a difference is a multiple of 2^-23, as distances are 0 or at least 1, and a double holds
    the sum of 96 such exactly.
    """
    first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
    whole = size - size % 4
    for i in range(0, whole, 4):
        k = np.uint64(i)
        first += here[k] - there[k]
        second += here[k + np.uint64(1)] - there[k + np.uint64(1)]
        third += here[k + np.uint64(2)] - there[k + np.uint64(2)]
        fourth += here[k + np.uint64(3)] - there[k + np.uint64(3)]
    for i in range(whole, size):
        first += here[i] - there[i]
    return float((first + second + third + fourth) / max(1, size))


@kernel
def _nearest(row: Float32Array, nodes: Int32Array, size: int) -> float:
    """Distance (node,) to the nearest of the first `size` nodes, or inf."""
    shortest = np.float32(np.inf)
    for i in range(size):
        distance = row[np.uint64(nodes[i])]
        shortest = distance if distance < shortest else shortest
    return np.float64(shortest)


@kernel
def _attraction(distances: Float32Array, size: int) -> float:
    """Sum of `FADING` to the power of each of the first `size` distances, rounded down."""
    total = 0.0
    for i in range(size):
        distance = int(distances[i])
        if distance < _POWERS.size:
            total += _POWERS[distance]
    return total


@kernel
def _idleness_in_view(first: int, end: int, nodes: Int32Array, idle: NDArray[np.float64]) -> float:
    """Sum of idleness of a list of nodes, in its order, on which rounding depends."""
    total = 0.0
    for i in range(first, end):
        total += idle[np.uint64(nodes[i])]
    return total


@kernel
def describe_moves(
    e: int,
    agent: int,
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    fields: Fields,
    distances: Distances,
    ends: Int32Array,
    there: Float32Array,
    out: Levels,
) -> None:
    """Fill the features (9, feature) of one agent's moves in row e.

    Parameters
    ----------
    ends : (9,) where each move ends, -1 if it is illegal
    there : (MOST_SAMPLES,) memory
    """
    neighbours, belief, node = arrays.neighbours, seen.belief[e], seen.agent_node[e, agent]
    idle, way, unseen_way = fields.idle, fields.way, fields.unseen_way[agent]
    items, unseen, due = fields.some_items, fields.some_unseen, fields.some_due
    item_nodes, unseen_nodes, due_nodes = items.nodes, unseen.nodes, due.nodes
    item_here, unseen_here, due_here = items.here[agent], unseen.here[agent], due.here[agent]
    n_items, n_unseen, n_due = items.size[0], unseen.size[0], due.size[0]
    own_items, own_due = items.own[agent], due.own[agent]
    n_own_items, n_own_due = items.owned[agent], due.owned[agent]
    own_item_way, own_due_way = items.own_way[agent], due.own_way[agent]
    radius, start, nodes = arrays.radius_number[agent], chart.views.start, chart.views.nodes
    disc, attraction = chart.disc[radius], _attraction(item_here, n_items)
    out[:] = 0
    for move in range(9):
        end = ends[move]
        if end < 0:
            continue
        in_view = _idleness_in_view(start[radius, end], start[radius, end + 1], nodes, idle)
        out[move, 0] = TOP
        out[move, 1] = item_level(belief[end])
        out[move, 3] = np.uint8(TOP * min(1.0, in_view / disc))
        if move == STAY:  # nothing comes nearer
            for feature in (2, 4, 5, 6, 7, 8, 9, 10):
                out[move, feature] = MIDDLE
            continue
        out[move, 2] = _changed(way[node] - way[end] if way[node] < FAR else 0.0, PER_NODE)
        gain = unseen_way[STAY] - unseen_way[move] if unseen_way[STAY] < FAR else 0.0
        out[move, 4] = _changed(gain, PER_NODE)
        row = distances_from(distances, neighbours, end)
        measure(row, item_nodes, n_items, there)
        out[move, 5] = _changed(_mean_gain(item_here, there, n_items), PER_NODE)
        out[move, 8] = _changed(_attraction(there, n_items) - attraction, PER_ATTRACTION)
        gain = own_item_way - _nearest(row, own_items, n_own_items) if n_own_items else 0.0
        out[move, 7] = _changed(gain, PER_NODE)
        measure(row, unseen_nodes, n_unseen, there)
        out[move, 6] = _changed(_mean_gain(unseen_here, there, n_unseen), PER_NODE)
        measure(row, due_nodes, n_due, there)
        out[move, 9] = _changed(_mean_gain(due_here, there, n_due), PER_NODE)
        gain = own_due_way - _nearest(row, own_due, n_own_due) if n_own_due else 0.0
        out[move, 10] = _changed(gain, PER_NODE)
