"""The egocentric encoding: the map around an agent, a coarse one of all, features of its moves.

Unlike the paper's channels its size does not depend on the map, so weights fit every map.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.encodings.chart import COARSE, REACH, Chart
from graph_planner.encodings.encoder import (
    TOP,
    TRAIL,
    Levels,
    Shapes,
    encoder,
    remember_places,
    trail_level,
)
from graph_planner.encodings.masks import legal_ends
from graph_planner.encodings.move_features import MOVE_FEATURES, describe_moves
from graph_planner.encodings.samples import MOST_SAMPLES, Distances
from graph_planner.encodings.shared_fields import (
    AGAIN,
    AGAIN_RADIUS,
    IDLENESS,
    ITEMS,
    WAY,
    Fields,
    paint_coarse,
    remember_items,
    share_fields,
    way_level,
)
from graph_planner.geodesics import FAR, Int32Array, Workspace
from graph_planner.navigation import STAY
from graph_planner.task import Observation, Task, TaskArrays

SIDE = 2 * REACH + 1
CROP = ("water", "idleness", "belief", "way to items", "again", "scouts", "foragers", "trail")
GLOBE = ("water", "idleness", "belief", "again", "self", "scouts", "foragers")
SELF = (
    *("collects", "time", "known nodes", "unseen share", "energy left", "number in team"),
    *("way to items", "way to unseen", "team size", "others", "moves", "radius"),
)


@kernel
def _paint_crop(
    a: int,
    agent_node: Int32Array,
    arrays: TaskArrays,
    framed: Int32Array,
    levels: NDArray[np.uint32],
    trail: Int32Array,
    crop: Levels,
) -> None:
    """The neighbourhood of one agent, (channel, SIDE, SIDE), north up."""
    rows, cols, collects = arrays.rows, arrays.cols, arrays.collects
    top, left = rows[agent_node[a]], cols[agent_node[a]]  # the frame adds REACH
    land = levels.size - 1
    for i in range(SIDE):
        for j in range(SIDE):
            node = np.uint64(framed[np.uint64(top + i), np.uint64(left + j)])
            four = levels[node]
            crop[0, i, j] = TOP if node < land else 0
            crop[1, i, j] = four >> IDLENESS & TOP
            crop[2, i, j] = four >> ITEMS & TOP
            crop[3, i, j] = four >> WAY & TOP
            crop[4, i, j] = four >> AGAIN & TOP
    crop[5:] = 0
    for other in range(agent_node.size):
        i, j = rows[agent_node[other]] - top + REACH, cols[agent_node[other]] - left + REACH
        if other != a and 0 <= i < SIDE and 0 <= j < SIDE:
            crop[6 if collects[other] else 5, i, j] = TOP
    for k in range(TRAIL - 1, -1, -1):
        node = trail[a, k]
        if node >= 0:
            i, j = rows[node] - top + REACH, cols[node] - left + REACH
            if 0 <= i < SIDE and 0 <= j < SIDE:
                crop[7, i, j] = trail_level(k)


@kernel
def _paint_agents(
    a: int,
    agent_node: Int32Array,
    collects: NDArray[np.bool_],
    coarse: Int32Array,
    globe: Levels,
) -> None:
    """Who is where on the whole map: the last three channels (channel, COARSE^2)."""
    globe[4:] = 0
    for other in range(agent_node.size):
        channel = 4 if other == a else (6 if collects[other] else 5)
        globe[channel, coarse[agent_node[other]]] = TOP


@kernel
def _paint_self(
    e: int,
    a: int,
    seen: Observation,
    arrays: TaskArrays,
    unseen: int,
    fields: Fields,
    out: Levels,
) -> None:
    """What an agent knows of itself and the time, in the order of `SELF`."""
    collects, node, horizon = arrays.collects, seen.agent_node[e, a], arrays.horizon
    radius, energy = arrays.radius[a], arrays.energy[a]
    number, team = 0, 0
    for other in range(collects.size):
        if collects[other] == collects[a]:
            number += other < a
            team += 1
    out[0] = TOP if collects[a] else 0
    out[1] = min(TOP, TOP * (seen.step[e] - 1) // horizon)
    out[2] = min(TOP, 2 * seen.n_known[e])
    out[3] = TOP * unseen // fields.idle.size
    share = seen.energy_left[e, a] / energy if energy < FAR else 1.0
    out[4] = np.uint8(TOP * min(1.0, max(0.0, share)))
    out[5] = TOP * number // team
    out[6] = way_level(fields.way[node])
    out[7] = way_level(fields.unseen_way[a, STAY])
    out[8] = min(TOP, 32 * team)
    out[9] = min(TOP, 32 * (collects.size - team))
    out[10] = min(TOP, 32 * arrays.moves[a])
    out[11] = min(TOP, int(16 * radius))


class Memory(NamedTuple):
    """What agents remember of the looks before."""

    seen_at: Int32Array  # (row,) step of the last look
    trail: Int32Array  # (row, agent, TRAIL) nodes, -1 for none
    believed: NDArray[np.bool_]  # (row, node) an item was believed there once
    near_item: NDArray[np.bool_]  # (row, node) or near it


class Pictures(NamedTuple):
    """The arrays that are filled: levels, their leading axes row and agent."""

    crop: Levels
    globe: Levels  # its cells in one axis
    moves: Levels
    own: Levels


@kernel
def _look_around(
    rows: NDArray[np.int64],
    seen: Observation,
    arrays: TaskArrays,
    chart: Chart,
    memory: Memory,
    fields: Fields,
    distances: Distances,
    out: Pictures,
) -> None:
    """Fill the pictures of all agents in some rows (chosen,)."""
    crop, globe, moves, own = out
    trail, near_item, collects = memory.trail, memory.near_item, arrays.collects
    framed, coarse, levels, energy_left = chart.framed, chart.coarse, fields.levels, seen.energy_left
    ends, there = np.empty(9, np.int32), np.empty(MOST_SAMPLES, np.float32)
    for e in rows:
        count = share_fields(e, seen, arrays, chart, near_item[e], fields, distances)
        nodes, known = seen.agent_node[e], seen.known[e, : seen.n_known[e]]
        paint_coarse(known, seen.belief[e], chart, fields, globe[e, 0])
        for a in range(nodes.size):
            if a > 0:
                globe[e, a, :4] = globe[e, 0, :4]
            _paint_agents(a, nodes, collects, coarse, globe[e, a])
            _paint_crop(a, nodes, arrays, framed, levels, trail[e], crop[e, a])
            _paint_self(e, a, seen, arrays, count, fields, own[e, a])
            legal_ends(arrays, a, nodes[a], energy_left[e, a], ends)
            describe_moves(
                e, a, seen, arrays, chart, fields, distances, ends, there, moves[e, a]
            )


@encoder("egocentric")
class Egocentric:
    """`egocentric`: four arrays per agent, of the same size on every map.

    Values lie in [0, 1]: float32 in the environments; `see` gives them as uint8 levels of 1 / 255,
    rounded down. Distances d are geodesic [node]; I is idleness.

    `crop` (8, 15, 15): the nodes around the agent, itself in the middle, north up; land is 0.

    | channel | meaning | unit | value |
    |---|---|---|---|
    | 0 | water | - | 1, land 0 |
    | 1 | idleness | 1 | I |
    | 2 | believed items at the node | item | 0.1 each, at most 1 |
    | 3 | d from the node to the nearest known item | node | 1 - d / 127.5, at least 0; 0 if none |
    | 4 | again: within 4 nodes items were believed, and it is long unseen | 1 | 4 I, at most 1 |
    | 5, 6 | scouts, foragers, without itself | - | 1 where one is |
    | 7 | own trail of 10 positions | step | 1, then 0.1 less per step back |

    `globe` (7, 16, 16): the whole map in 16 x 16 cells, north up.

    | channel | meaning | unit | value |
    |---|---|---|---|
    | 0 | share of water | 1 | the share |
    | 1 | mean idleness of its nodes | 1 | I |
    | 2 | believed items in the cell | item | 0.1 each, at most 1 |
    | 3 | mean of channel 4 of `crop` over its nodes | 1 | the mean |
    | 4, 5, 6 | itself, scouts, foragers, the latter without itself | - | 1 where one is |

    `moves` (9, 11): a row per move 0-7 compass, 8 stay; see `move_features`.

    `self` (12,), names in `SELF`; a kind is all scouts or all foragers.

    | entry | meaning | unit | value |
    |---|---|---|---|
    | 0 | whether it collects | - | 1 forager, 0 scout |
    | 1 | decisions taken so far | horizon | the share |
    | 2 | nodes n at which items are known | node | n / 127.5, at most 1 |
    | 3 | nodes of idleness 1 | all nodes | the share |
    | 4 | energy left | full store | the share; 1 without a limit |
    | 5 | its number k among the n of its kind, from 0 | agent | k / n |
    | 6 | d to the nearest known item | node | 1 - d / 127.5, at least 0; 0 if none |
    | 7 | d to the nearest node of idleness 1 | node | likewise |
    | 8 | agents of its kind, itself included | agent | 32 / 255 each, at most 1 |
    | 9 | agents of the other kind | agent | 32 / 255 each, at most 1 |
    | 10 | nodes it moves per decision | node | 32 / 255 each, at most 1 |
    | 11 | sensing radius | node | 16 / 255 each, at most 1 |
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._chart = Chart.of(task)
        self._fields = Fields.of(task, self._chart)
        self._around = task.graph.views((AGAIN_RADIUS,))
        self._distances = Distances(task.graph.distance_rows, Workspace.of(len(task.graph)))

    @property
    def shapes(self) -> Shapes:
        """Name -> shape of one agent's array."""
        return {
            "crop": (len(CROP), SIDE, SIDE),
            "globe": (len(GLOBE), COARSE, COARSE),
            "moves": (9, len(MOVE_FEATURES)),
            "self": (len(SELF),),
        }

    def reset(self, episodes: int) -> None:
        """Forget everything; get ready for a batch of so many episodes."""
        lead, nodes = (episodes, len(self._task.fleet)), (episodes, len(self._task.graph))
        self._memory = Memory(
            seen_at=np.zeros(episodes, np.int32),
            trail=np.full((*lead, TRAIL), -1, np.int32),
            believed=np.zeros(nodes, np.bool_),
            near_item=np.zeros(nodes, np.bool_),
        )
        self._out = {k: np.zeros((*lead, *shape), np.uint8) for k, shape in self.shapes.items()}
        globe = self._out["globe"].reshape(*lead, len(GLOBE), -1)
        self._pictures = Pictures(self._out["crop"], globe, self._out["moves"], self._out["self"])

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, Levels]:
        """Look at the episodes `rows` of the batch."""
        memory = self._memory
        remember_places(rows, seen.step, seen.agent_node, memory.seen_at, memory.trail)
        remember_items(rows, seen, self._around, memory.believed, memory.near_item)
        _look_around(
            rows,
            seen,
            self._task.arrays,
            self._chart,
            memory,
            self._fields,
            self._distances,
            self._pictures,
        )
        return self._out
