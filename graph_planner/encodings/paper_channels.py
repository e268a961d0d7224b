"""The paper's six channels: the whole map as one agent sees it (definitions, section 3)."""

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.graph_planner.encodings.encoder import (
    TOP,
    TRAIL,
    Levels,
    Shapes,
    encoder,
    item_level,
    remember_places,
    trail_level,
)
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.mission.task import Observation, Task, TaskArrays

CHANNELS = ("idleness", "belief", "belief 1 step ago", "belief 2 steps ago", "self", "teammates")
SCOUT_LEVEL, FORAGER_LEVEL = 128, TOP


@kernel
def _remember_beliefs(
    rows: NDArray[np.int64],
    step: Int32Array,
    seen_at: Int32Array,
    belief: NDArray[np.int16],
    past: Levels,
) -> None:
    """Shift the beliefs of the last three scans on, past (episode, 3, node), newest first."""
    for e in rows:
        if step[e] <= 1:
            past[e] = 0
        elif seen_at[e] != step[e]:
            past[e, 2] = past[e, 1]
            past[e, 1] = past[e, 0]
        for node in range(belief.shape[1]):
            past[e, 0, node] = item_level(belief[e, node])


@kernel
def _paint(
    rows: NDArray[np.int64],
    seen: Observation,
    arrays: TaskArrays,
    past: Levels,
    trail: Int32Array,
    out: Levels,
) -> None:
    """Fill the pictures of all agents in some rows (chosen,)."""
    step, agent_node, last_seen = seen.step, seen.agent_node, seen.last_seen
    map_rows, map_cols, collects = arrays.rows, arrays.cols, arrays.collects
    forgetting = arrays.forgetting
    agents = agent_node.shape[1]
    for e in rows:
        now = step[e] - 1
        for a in range(agents):
            picture = out[e, a]
            picture[:] = 0
            for node in range(map_rows.size):
                row, col = map_rows[node], map_cols[node]
                idle = min(1.0, (now - np.int64(last_seen[e, node])) * forgetting)
                picture[0, row, col] = np.uint8(TOP * idle)
                for k in range(3):
                    picture[1 + k, row, col] = past[e, k, node]
            for k in range(TRAIL - 1, -1, -1):
                node = trail[e, a, k]
                if node >= 0:
                    picture[4, map_rows[node], map_cols[node]] = trail_level(k)
            for other in range(agents):
                if other != a:
                    node = agent_node[e, other]
                    level = FORAGER_LEVEL if collects[other] else SCOUT_LEVEL
                    before = picture[5, map_rows[node], map_cols[node]]
                    picture[5, map_rows[node], map_cols[node]] = max(before, level)


@encoder("paper")
class PaperChannels:
    """`paper`: one array `map` of (6, row, column); land is 0 everywhere.

    Values lie in [0, 1]: float32 in the environments; `see` gives them as uint8 levels of 1 / 255,
    rounded down.

    | channel | meaning | unit | value |
    |---|---|---|---|
    | 0 | idleness I | 1 | I |
    | 1, 2, 3 | believed items at the node now, 1 and 2 steps ago | item | 0.1 each, at most 1 |
    | 4 | own position and trail of 10 positions | step | 1, then 0.1 less per step back |
    | 5 | teammates' positions | - | scout 128 / 255, forager 1 |
    """

    map_bound = True

    def __init__(self, task: Task) -> None:
        self._task = task

    @property
    def shapes(self) -> Shapes:
        """Name -> shape of one agent's array."""
        return {"map": (len(CHANNELS), *self._task.graph.shape)}

    def reset(self, episodes: int) -> None:
        """Forget everything; get ready for a batch of so many episodes."""
        agents, shape = len(self._task.fleet), self.shapes["map"]
        self._seen_at = np.zeros(episodes, np.int32)
        self._trail = np.full((episodes, agents, TRAIL), -1, np.int32)
        self._past = np.zeros((episodes, 3, len(self._task.graph)), np.uint8)
        self._out = np.zeros((episodes, agents, *shape), np.uint8)

    def see(self, seen: Observation, rows: NDArray[np.int64]) -> dict[str, Levels]:
        """Look at the episodes `rows` of the batch."""
        _remember_beliefs(rows, seen.step, self._seen_at, seen.belief, self._past)
        remember_places(rows, seen.step, seen.agent_node, self._seen_at, self._trail)
        _paint(rows, seen, self._task.arrays, self._past, self._trail, self._out)
        return {"map": self._out}
