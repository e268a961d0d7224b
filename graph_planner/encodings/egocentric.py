"""The egocentric encoding: the map around an agent, a coarse one of all, features of its moves.

Unlike the paper's channels its size does not depend on the map, so weights fit every map.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel, kinds_of
from mjforage.base.device import Bind, Call, Launch
from mjforage.graph_planner.encodings.chart import COARSE, REACH, Chart
from mjforage.graph_planner.encodings.encoder import (
    TOP,
    TRAIL,
    Levels,
    Shapes,
    encoder,
    remember_places,
    trail_level,
)
from mjforage.graph_planner.encodings.move_features import MOVE_FEATURES, describe_moves
from mjforage.graph_planner.encodings.samples import Distances
from mjforage.graph_planner.encodings.shared_fields import (
    AGAIN,
    AGAIN_RADIUS,
    IDLENESS,
    ITEMS,
    WAY,
    Fields,
    Nearby,
    remember_items,
    share_fields,
)
from mjforage.graph_planner.encodings.ways import ItemWays, way_level
from mjforage.graph_planner.graph.geodesics import FAR, Float32Array, Int32Array, Workspace
from mjforage.graph_planner.graph.navigation import STAY
from mjforage.graph_planner.graph.visibility import NodeLists
from mjforage.mission.task import Observation, Task, TaskArrays

SIDE = 2 * REACH + 1
LOCAL_MAP = ("water", "idleness", "belief", "way to items", "again", "scouts", "foragers", "trail")
GLOBAL_MAP = ("water", "idleness", "belief", "again", "self", "scouts", "foragers")
OWN = (
    *("collects", "time", "known nodes", "unseen share", "energy left", "number in team"),
    *("way to items", "way to unseen", "team size", "others", "moves", "radius"),
)


@kernel
def _paint_local_maps(
    agent_node: Int32Array,
    arrays: TaskArrays,
    framed: Int32Array,
    framed_water: Levels,
    levels: NDArray[np.uint32],
    four: NDArray[np.uint32],
    trail: Int32Array,
    local_maps: Levels,
) -> None:
    """The neighbourhood of each agent (agent, channel, SIDE^2), north up."""
    rows, cols, collects = arrays.rows, arrays.cols, arrays.collects
    agents, cells, width = agent_node.size, SIDE * SIDE, framed.shape[1]
    nodes, all_water = framed.reshape(-1), framed_water.reshape(-1)
    for a in range(agents):
        first, out = rows[agent_node[a]] * width + cols[agent_node[a]], local_maps[a]
        water, idle, items, way, again = out[0], out[1], out[2], out[3], out[4]
        for i in range(SIDE):  # the frame adds REACH
            for j in range(SIDE):
                node = nodes[np.uint64(first + i * width + j)]
                four[np.uint64(i * SIDE + j)] = levels[np.uint64(node)]
        for i in range(SIDE):
            for j in range(SIDE):
                water[np.uint64(i * SIDE + j)] = all_water[np.uint64(first + i * width + j)]
        for k in range(cells):  # a loop for each: together they take five times as long
            idle[k] = np.uint8(four[k] >> np.uint32(IDLENESS))
        for k in range(cells):
            items[k] = np.uint8(four[k] >> np.uint32(ITEMS))
        for k in range(cells):
            way[k] = np.uint8(four[k] >> np.uint32(WAY))
        for k in range(cells):
            again[k] = np.uint8(four[k] >> np.uint32(AGAIN))
        rest, top, left = out[5:].reshape(-1), rows[agent_node[a]], cols[agent_node[a]]
        for k in range(rest.size):
            rest[k] = 0
        for other in range(agents):
            i, j = rows[agent_node[other]] - top + REACH, cols[agent_node[other]] - left + REACH
            if other != a and 0 <= i < SIDE and 0 <= j < SIDE:
                out[6 if collects[other] else 5, i * SIDE + j] = TOP
        for k in range(TRAIL - 1, -1, -1):
            node = trail[a, k]
            if node >= 0:
                i, j = rows[node] - top + REACH, cols[node] - left + REACH
                if 0 <= i < SIDE and 0 <= j < SIDE:
                    out[7, i * SIDE + j] = trail_level(k)


@kernel
def _paint_global_maps(
    agent_node: Int32Array, collects: NDArray[np.bool_], coarse: Int32Array, global_map: Levels
) -> None:
    """The whole map of each agent (agent, channel, COARSE^2), of which the first has four channels.

    The others get a copy of these; the last three are the places of the agents.
    """
    agents, channels, cells = global_map.shape
    for a in range(agents):
        for channel in range(channels):
            if channel >= 4:
                for cell in range(cells):
                    global_map[a, channel, cell] = 0
            elif a > 0:
                for cell in range(cells):
                    global_map[a, channel, cell] = global_map[0, channel, cell]
        for other in range(agents):
            channel = 4 if other == a else (6 if collects[other] else 5)
            global_map[a, channel, coarse[agent_node[other]]] = TOP


@kernel
def _describe_selves(
    agent_node: Int32Array,
    energy_left: NDArray[np.float64],
    past: tuple[int, int],
    arrays: TaskArrays,
    unseen: int,
    way: Float32Array,
    unseen_way: NDArray[np.float64],
    out: Levels,
) -> None:
    """Own state of each agent and the time (agent, entry), in the order of `OWN`."""
    collects, horizon, moves = arrays.collects, arrays.horizon, arrays.moves
    radius, energy, agents = arrays.radius, arrays.energy, agent_node.size
    time, known = min(TOP, TOP * past[0] // horizon), min(TOP, 2 * past[1])
    unseen_share = TOP * unseen // way.size
    for a in range(agents):
        number, team = 0, 0
        for other in range(agents):
            if collects[other] == collects[a]:
                number += other < a
                team += 1
        out[a, 0] = TOP if collects[a] else 0
        out[a, 1], out[a, 2], out[a, 3] = time, known, unseen_share
        share = energy_left[a] / energy[a] if energy[a] < FAR else 1.0
        out[a, 4] = np.uint8(TOP * min(1.0, max(0.0, share)))
        out[a, 5] = TOP * number // team
        out[a, 6] = way_level(np.float64(way[agent_node[a]]))
        out[a, 7] = way_level(unseen_way[a, STAY])
        out[a, 8] = min(TOP, 32 * team)
        out[a, 9] = min(TOP, 32 * (agents - team))
        out[a, 10] = min(TOP, 32 * moves[a])
        out[a, 11] = min(TOP, int(16 * radius[a]))


class Memory(NamedTuple):
    """Memory of the scans before."""

    seen_at: Int32Array  # (row,) step of the last look
    trail: Int32Array  # (row, agent, TRAIL) nodes, -1 for none
    nearby: Nearby
    ways: ItemWays


class Pictures(NamedTuple):
    """The arrays that are filled: levels, their leading axes row and agent."""

    local_map: Levels  # its cells in one axis, as those of the global_map
    global_map: Levels
    moves: Levels
    own: Levels


@kernel
def _look_around(
    arrays: TaskArrays,
    around: NodeLists,
    chart: Chart,
    memory: Memory,
    fields: Fields,
    distances: Distances,
    out: Pictures,
    ids: NDArray[np.int64],
    seen: Observation,
) -> None:
    """Fill the pictures of all agents in some rows (chosen,)."""
    local_map, global_map, moves, own = out
    trail, nearby, ways, collects = memory.trail, memory.nearby, memory.ways, arrays.collects
    framed, water, coarse = chart.framed, chart.framed_water, chart.coarse
    levels, energy_left = fields.levels, seen.energy_left
    way, unseen_way = ways.distance, fields.unseen_way
    step, agent_node, n_known = seen.step, seen.agent_node, seen.n_known
    remember_places(ids, step, agent_node, memory.seen_at, trail)
    remember_items(ids, seen, around, nearby)
    for e in ids:
        shared = global_map[e, 0]
        count = share_fields(e, seen, arrays, chart, nearby, ways, fields, distances, shared)
        nodes, past = agent_node[e], (step[e] - 1, n_known[e])
        _paint_global_maps(nodes, collects, coarse, global_map[e])
        of_nodes = levels, fields.four, trail[e]
        _paint_local_maps(nodes, arrays, framed, water, *of_nodes, local_map[e])
        _describe_selves(nodes, energy_left[e], past, arrays, count, way[e], unseen_way, own[e])
        describe_moves(e, seen, arrays, chart, fields, way[e], moves[e])


LOOK_AROUND = Launch(
    _look_around,
    shared="arrays around chart distances.rows",
    memory="fields workspace",
)


@encoder("egocentric")
class Egocentric:
    """`egocentric`: four arrays per agent, of the same size on every map.

    Values lie in [0, 1]: float32 in the environments; `see` gives them as uint8 levels of 1 / 255,
    rounded down. Distances d are geodesic [node]; I is idleness.

    `local_map` (8, 15, 15): the nodes around the agent, itself in the middle, north up; land is 0.

    | channel | meaning | unit | value |
    |---|---|---|---|
    | 0 | water | - | 1, land 0 |
    | 1 | idleness | 1 | I |
    | 2 | believed items at the node | item | 0.1 each, at most 1 |
    | 3 | d from the node to the nearest known item | node | 1 - d / 127.5, at least 0; 0 if none |
    | 4 | again: within 4 nodes items were believed, and it is long unseen | 1 | 4 I, at most 1 |
    | 5, 6 | scouts, foragers, without itself | - | 1 where one is |
    | 7 | own trail of 10 positions | step | 1, then 0.1 less per step back |

    `global_map` (7, 16, 16): the whole map in 16 x 16 cells, north up.

    | channel | meaning | unit | value |
    |---|---|---|---|
    | 0 | share of water | 1 | the share |
    | 1 | mean idleness of its nodes | 1 | I |
    | 2 | believed items in the cell | item | 0.1 each, at most 1 |
    | 3 | mean of channel 4 of `local_map` over its nodes | 1 | the mean |
    | 4, 5, 6 | itself, scouts, foragers, the latter without itself | - | 1 where one is |

    `moves` (9, 11): a row per move 0-7 compass, 8 stay; see `move_features`.

    `own` (12,), names in `OWN`; a kind is all scouts or all foragers.

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
            "local_map": (len(LOCAL_MAP), SIDE, SIDE),
            "global_map": (len(GLOBAL_MAP), COARSE, COARSE),
            "moves": (9, len(MOVE_FEATURES)),
            "own": (len(OWN),),
        }

    def reset(self, episodes: int) -> None:
        """Forget everything; get ready for a batch of so many episodes."""
        lead, nodes = (episodes, len(self._task.fleet)), (episodes, len(self._task.graph))
        self._memory = Memory(
            seen_at=np.zeros(episodes, np.int32),
            trail=np.full((*lead, TRAIL), -1, np.int32),
            nearby=Nearby.none_yet(*nodes),
            ways=ItemWays.none_yet(*nodes),
        )
        self._out = {k: np.zeros((*lead, *shape), np.uint8) for k, shape in self.shapes.items()}
        local_map = self._out["local_map"].reshape(*lead, len(LOCAL_MAP), -1)
        global_map = self._out["global_map"].reshape(*lead, len(GLOBAL_MAP), -1)
        self._pictures = Pictures(local_map, global_map, self._out["moves"], self._out["own"])
        self._asked: tuple[object, ...] = ()  # of the last look, for whose kinds it is prepared

    @property
    def fits_a_device(self) -> bool:
        """True if the map is small enough for a table of all distances."""
        return bool(self._chart.codes.code.size)

    def on_device(
        self, bind: Bind, ids: NDArray[np.bool_], seen: Observation
    ) -> tuple[Call, dict[str, Levels]]:
        """`see` of the rows that a mask (row,) then has, by a kernel, and the arrays it fills."""
        about = self._task.arrays, self._around, self._chart, self._memory
        memory = self._fields, self._distances, self._pictures
        return bind(LOOK_AROUND, *about, *memory, ids, seen), dict(
            zip(self.shapes, self._pictures, strict=True)
        )

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, Levels]:
        """Look at the episodes `rows` of the batch."""
        asked = (rows, *seen)
        if not _alike(asked, self._asked):
            about = self._task.arrays, self._around, self._chart, self._memory
            memory = self._fields, self._distances, self._pictures
            self._look = BoundKernel(_look_around, *about, *memory)
        self._asked = asked
        self._look(rows, seen)
        return self._out


def _alike(asked: tuple[object, ...], before: tuple[object, ...]) -> bool:
    """True if the arrays of both are of the same kinds; most of them are the same arrays."""
    return len(asked) == len(before) and all(
        new is old or kinds_of(new) == kinds_of(old) for new, old in zip(asked, before, strict=True)
    )
