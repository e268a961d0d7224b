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
from graph_planner.encodings.encoder import TOP, Levels, item_level
from graph_planner.encodings.samples import Distances, Sample, distances_from
from graph_planner.encodings.shared_fields import Chart, Fields
from graph_planner.geodesics import FAR, Float32Array
from graph_planner.moves import free_move, move_length
from graph_planner.navigation import STAY
from graph_planner.task import Observation, TaskArrays

MOVE_FEATURES = (
    *("legal", "items", "nearer item", "idleness", "nearer unseen", "nearer items on average"),
    *("nearer unseen on average", "nearer own item", "attraction"),
    *("nearer due on average", "nearer own due"),
)
MIDDLE, PER_NODE, PER_ATTRACTION = 128, 40.0, 32.0
FADING = 0.85  # estimate: half is left after four nodes


@inlined
def _changed(gain: float, per_unit: float) -> int:
    """Level of a gain: more than the middle is nearer, or more."""
    return int(min(255.0, max(0.0, MIDDLE + per_unit * gain)))


@kernel
def _mean_gain(here: Float32Array, there: Float32Array, sample: Sample) -> float:
    """By how much nearer `there` is to the sample than `here`, on average [node]."""
    nodes, count = sample.nodes, sample.size[0]
    total = 0.0
    for i in range(count):
        total += here[nodes[i]] - there[nodes[i]]
    return float(total / max(1, count))


@kernel
def _own_node(row: Float32Array, kind: int, agent: int, sample: Sample) -> float:
    """Distance to the nearest node of the sample that is this agent's, or inf."""
    nodes, nearest, shortest = sample.nodes, sample.nearest, np.inf
    for i in range(sample.size[0]):
        if nearest[kind, i] == agent:
            shortest = min(shortest, np.float64(row[nodes[i]]))
    return shortest


@kernel
def _attraction(row: Float32Array, powers: NDArray[np.float64], sample: Sample) -> float:
    """Sum of `FADING` to the power of each distance, rounded down, from a row of distances."""
    nodes, total = sample.nodes, 0.0
    for i in range(sample.size[0]):
        distance = int(row[nodes[i]])
        if distance < powers.size:
            total += powers[distance]
    return total


_POWERS = np.power(FADING, np.arange(40)).astype(np.float64)


@kernel
def describe_moves(
    e: int,
    agent: int,
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    fields: Fields,
    distances: Distances,
    out: Levels,
) -> None:
    """Fill the features (9, feature) of one agent's moves in row e."""
    neighbours, moves, belief = arrays.neighbours, arrays.moves, seen.belief[e]
    node, energy = seen.agent_node[e, agent], seen.energy_left[e, agent]
    idle, way, unseen_way = fields.idle, fields.way, fields.unseen_way[agent]
    items, unseen, due = fields.some_items, fields.some_unseen, fields.some_due
    radius, start, nodes = arrays.radius_number[agent], chart.views.start, chart.views.nodes
    nobody, kind, disc = np.empty(0, np.int64), int(arrays.collects[agent]), chart.disc[radius]
    here = distances_from(distances, neighbours, node).copy()
    here_item = _own_node(here, kind, agent, items)
    here_due = _own_node(here, kind, agent, due)
    here_attraction = _attraction(here, _POWERS, items)
    out[:] = 0
    for move in range(9):
        end, steps = free_move(
            neighbours, nobody, -1, node, move, moves[agent], arrays.stay, arrays.shorten
        )
        if end < 0 or move_length(move, steps) > energy:
            continue
        in_view = 0.0
        for i in range(start[radius, end], start[radius, end + 1]):
            in_view += idle[nodes[i]]
        out[move, 0] = TOP
        out[move, 1] = item_level(belief[end])
        out[move, 2] = _changed(way[node] - way[end] if way[node] < FAR else 0.0, PER_NODE)
        out[move, 3] = np.uint8(TOP * min(1.0, in_view / disc))
        gain = unseen_way[STAY] - unseen_way[move] if unseen_way[STAY] < FAR else 0.0
        out[move, 4] = _changed(gain, PER_NODE)
        there = distances_from(distances, neighbours, end)
        out[move, 5] = _changed(_mean_gain(here, there, items), PER_NODE)
        out[move, 6] = _changed(_mean_gain(here, there, unseen), PER_NODE)
        gain = here_item - _own_node(there, kind, agent, items) if here_item < FAR else 0.0
        out[move, 7] = _changed(gain, PER_NODE)
        gain = _attraction(there, _POWERS, items) - here_attraction
        out[move, 8] = _changed(gain, PER_ATTRACTION)
        out[move, 9] = _changed(_mean_gain(here, there, due), PER_NODE)
        gain = here_due - _own_node(there, kind, agent, due) if here_due < FAR else 0.0
        out[move, 10] = _changed(gain, PER_NODE)
