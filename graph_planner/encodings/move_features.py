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
| 9 | nearer to the haunts to look at again, on average | node | gain |
| 10 | nearer to the nearest of them to which no teammate of its kind is nearer | node | gain |

5 to 10 look at up to 96 evenly chosen nodes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import inlined, kernel
from graph_planner.encodings.encoder import TOP, Levels, item_level
from graph_planner.geodesics import (
    FAR,
    DistanceRows,
    Float32Array,
    Int32Array,
    Workspace,
    distances_of,
)
from graph_planner.moves import free_move, move_length
from graph_planner.navigation import STAY
from graph_planner.task import TaskArrays
from graph_planner.visibility import NodeLists

MOVE_FEATURES = (
    *("legal", "items", "nearer item", "idleness", "nearer unseen", "nearer items on average"),
    *("nearer unseen on average", "nearer own item", "attraction"),
    *("nearer haunts on average", "nearer own haunt"),
)
MOST_SAMPLES = 96
MIDDLE, PER_NODE, PER_ATTRACTION = 128, 40.0, 32.0
FADING = 0.85


class Sample(NamedTuple):
    """Some nodes of interest, and which agent of each kind is nearest to each."""

    nodes: Int32Array  # (MOST_SAMPLES,)
    nearest: Int32Array  # (2, MOST_SAMPLES) agent: of those that do not collect, of those that do
    shortest: Float32Array  # (2, MOST_SAMPLES) its distance [node]
    size: Int32Array  # (1,) how many there are

    @classmethod
    def empty(cls) -> "Sample":
        """Memory for a sample."""
        return cls(
            np.zeros(MOST_SAMPLES, np.int32),
            np.zeros((2, MOST_SAMPLES), np.int32),
            np.zeros((2, MOST_SAMPLES), np.float32),
            np.zeros(1, np.int32),
        )


@kernel
def take_sample(
    candidates: Int32Array,
    agent_node: Int32Array,
    arrays: TaskArrays,
    rows: DistanceRows,
    workspace: Workspace,
    sample: Sample,
) -> None:
    """Choose evenly among the candidates (candidate,)."""
    nodes, nearest, shortest = sample.nodes, sample.nearest, sample.shortest
    total, collects = candidates.size, arrays.collects
    count = min(total, MOST_SAMPLES)
    sample.size[0] = count
    for i in range(count):
        nodes[i] = candidates[i * total // count]
    nearest[:, :count] = -1
    shortest[:, :count] = np.float32(np.inf)
    if count == 0:
        return
    for a in range(agent_node.size):
        kind = int(collects[a])
        row = distances_of(rows, arrays.neighbours, agent_node[a], workspace)
        for i in range(count):
            if row[nodes[i]] < shortest[kind, i]:
                nearest[kind, i], shortest[kind, i] = a, row[nodes[i]]


@inlined
def _changed(gain: float, per_unit: float) -> int:
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
def _own_item(row: Float32Array, kind: int, agent: int, sample: Sample) -> float:
    """Distance to the nearest node of the sample that is this agent's, or inf."""
    nodes, nearest, shortest = sample.nodes, sample.nearest, np.inf
    for i in range(sample.size[0]):
        if nearest[kind, i] == agent:
            shortest = min(shortest, np.float64(row[nodes[i]]))
    return shortest


@kernel
def _attraction(row: Float32Array, powers: NDArray[np.float64], sample: Sample) -> float:
    nodes, total = sample.nodes, 0.0
    for i in range(sample.size[0]):
        distance = int(row[nodes[i]])
        if distance < powers.size:
            total += powers[distance]
    return total


_POWERS = np.power(FADING, np.arange(40)).astype(np.float64)


@kernel
def describe_moves(
    agent: int,
    node: int,
    energy: float,
    arrays: TaskArrays,
    belief: NDArray[np.int16],
    idle: NDArray[np.float64],
    way: Float32Array,
    gap: NDArray[np.float64],
    views: NodeLists,
    disc: int,
    items: Sample,
    gaps: Sample,
    lost: Sample,
    rows: DistanceRows,
    workspace: Workspace,
    out: Levels,
) -> None:
    """Fill the features (9, feature) of one agent's moves.

    Parameters
    ----------
    energy : distance that it can still travel [node]
    rows, workspace : distances from single nodes, and memory to search them with
    belief, idle, way : (node,) believed items, idleness, distance to the nearest known item [node]
    gap : (9,) distance of each move's target to the nearest node of idleness 1 [node]
    disc : nodes in view on open water
    items, gaps, lost : samples of the known nodes, of those of idleness 1, of haunts
    """
    neighbours, moves = arrays.neighbours, arrays.moves
    radius, start, nodes = arrays.radius_number[agent], views.start, views.nodes
    nobody, kind = np.empty(0, np.int64), int(arrays.collects[agent])
    here = distances_of(rows, neighbours, node, workspace).copy()
    here_own = _own_item(here, kind, agent, items)
    here_lost = _own_item(here, kind, agent, lost)
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
        out[move, 4] = _changed(gap[STAY] - gap[move] if gap[STAY] < FAR else 0.0, PER_NODE)
        there = distances_of(rows, neighbours, end, workspace)
        out[move, 5] = _changed(_mean_gain(here, there, items), PER_NODE)
        out[move, 6] = _changed(_mean_gain(here, there, gaps), PER_NODE)
        gain = here_own - _own_item(there, kind, agent, items) if here_own < FAR else 0.0
        out[move, 7] = _changed(gain, PER_NODE)
        gain = _attraction(there, _POWERS, items) - here_attraction
        out[move, 8] = _changed(gain, PER_ATTRACTION)
        out[move, 9] = _changed(_mean_gain(here, there, lost), PER_NODE)
        gain = here_lost - _own_item(there, kind, agent, lost) if here_lost < FAR else 0.0
        out[move, 10] = _changed(gain, PER_NODE)
