"""Decisions that an agent needs from node to node, for each number of nodes per decision.

A two-node mover's ways are not symmetric and may not reach every node, so they are searched
backwards from the target over the moves themselves. Rows are searched when first asked for and
kept; on a map too large for a table of all nodes, the oldest row makes room.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import kernel
from mjforage.base.row_cache import RowCache, row_of, rows_worth_keeping
from mjforage.graph_planner.graph.geodesics import Int32Array
from mjforage.graph_planner.graph.navigation import STAY, TABLE_LIMIT, NavigationGraph
from mjforage.mission.moves import MoveRules, all_targets
from mjforage.mission.task import Task

UInt16Array = NDArray[np.uint16]

UNREACHED = np.uint16(65535)


class Ways(NamedTuple):
    """Moves of one kind of mover, and rows of decisions to the targets asked for so far."""

    ends: Int32Array  # (node, 9) where a move ends, -1 illegal
    before_start: NDArray[np.int64]  # (node + 1,) the moves that end in a node come from
    before: Int32Array  # (move,) `before[before_start[v]:before_start[v + 1]]`
    cache: RowCache  # rows of targets
    decisions: UInt16Array  # (row, node) decisions from a node to the row's target


@kernel
def _reversed(ends: Int32Array) -> tuple[NDArray[np.int64], Int32Array]:
    """Compressed lists of the nodes from which a move ends in each node."""
    n = ends.shape[0]
    start = np.zeros(n + 1, np.int64)
    for node in range(n):
        for move in range(STAY):
            if ends[node, move] >= 0:
                start[ends[node, move] + 1] += 1
    for node in range(n):
        start[node + 1] += start[node]
    place, before = start.copy(), np.empty(start[n], np.int32)
    for node in range(n):
        for move in range(STAY):
            end = ends[node, move]
            if end >= 0:
                before[place[end]] = node
                place[end] += 1
    return start, before


@kernel
def search_back(
    before_start: NDArray[np.int64], before: Int32Array, targets: Int32Array, row: UInt16Array
) -> None:
    """Fill a row (node,) with the decisions to the nearest of the targets, breadth first."""
    row[:] = UNREACHED
    queue = np.empty(row.size, np.int32)
    first, last = 0, 0
    for target in targets:
        if row[target] != 0:
            row[target] = 0
            queue[last] = target
            last += 1
    while first < last:
        node = queue[first]
        first += 1
        there = min(np.int64(row[node]) + 1, np.int64(UNREACHED) - 1)
        for i in range(before_start[node], before_start[node + 1]):
            if row[before[i]] == UNREACHED:
                row[before[i]] = there
                queue[last] = before[i]
                last += 1


@kernel
def row_to(ways: Ways, node: int) -> int:
    """Number of the row of `decisions` that leads to a node; searched if it is not kept.

    Asking for another may overwrite it.
    """
    row, missing = row_of(ways.cache, node)
    if missing:
        goal = np.empty(1, np.int32)
        goal[0] = node
        search_back(ways.before_start, ways.before, goal, ways.decisions[row])
    return row


@lru_cache(maxsize=16)
def ways_of(graph: NavigationGraph, moves: int, rules: MoveRules) -> Ways:
    """Ways of a mover on a map, made once and kept; `graph`: map; `moves`: nodes per decision."""
    ends, n = all_targets(graph, np.array([moves]), rules)[1][0], len(graph)
    start, before = _reversed(ends)
    rows = n if n <= TABLE_LIMIT else rows_worth_keeping(n, 2)
    return Ways(
        ends=ends,
        before_start=start,
        before=before,
        cache=RowCache.of(n, rows),
        decisions=np.empty((rows, n), np.uint16),
    )


@dataclass(frozen=True)
class Group:
    """Agents that one search moves.

    Attributes
    ----------
    agents : (member,) indices in the fleet
    kind : (member,) which of `ways` it moves by
    ways : one per number of nodes per decision
    """

    agents: NDArray[np.int64]
    kind: NDArray[np.int64]
    ways: tuple[Ways, ...]

    @classmethod
    def of(cls, task: Task, agents: NDArray[np.int64]) -> "Group":
        """The group of some agents of a task."""
        lengths = sorted({int(m) for m in task.fleet.moves[agents]}) or [1]
        kind = np.searchsorted(lengths, task.fleet.moves[agents]).astype(np.int64)
        return cls(agents, kind, tuple(ways_of(task.graph, m, task.rules) for m in lengths))

    def ways_of(self, agent: int) -> Ways:
        """The ways of one of the agents."""
        return self.ways[int(self.kind[np.flatnonzero(self.agents == agent)[0]])]
