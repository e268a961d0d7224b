"""The graph world's rule for items: foragers remove what is in their node, the rest drift.

Items drift by a constant vector plus independent noise per item and step (scenario section 1).
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.fleet import Fleet
from graph_planner.geodesics import Int32Array
from graph_planner.navigation import NavigationGraph, Water
from graph_planner.randomness import Stream, UInt64Array, stream_key
from graph_planner.rows import put_rows
from mjforage.core.dynamics import Transition
from mjforage.core.initial_state import WALLS, InitialState, into_water, item_noise, put_back


@kernel
def collect(
    active: NDArray[np.bool_],
    collects: NDArray[np.bool_],
    room_left: NDArray[np.int64],
    items_in_node: NDArray[np.int16],
    state: Transition,
) -> None:
    """Every forager removes what is in its node, in index order, while it has room."""
    agent_node, item_node, collected_by = state.agent_node, state.item_node, state.collected_by
    for e in range(active.size):
        if not active[e]:
            continue
        for agent in range(collects.size):
            node = agent_node[e, agent]
            if not collects[agent] or items_in_node[e, node] == 0:
                continue
            for k in range(item_node.shape[1]):
                if item_node[e, k] == node and room_left[e, agent] > 0:
                    item_node[e, k] = -1
                    collected_by[e, k] = agent
                    items_in_node[e, node] -= 1
                    room_left[e, agent] -= 1


@kernel
def _drift(
    active: NDArray[np.bool_],
    step: Int32Array,
    keys: UInt64Array,
    drift_rc: NDArray[np.float64],
    noise: float,
    water: Water,
    state: Transition,
    gone: Int32Array,
    n_gone: Int32Array,
) -> None:
    """Move every item left by the episode's drift and its own noise.

    Lists those that left the square of their node: `gone` (episode, item), `n_gone` (episode,).
    The list is made without a branch: whether an item on a quay leaves its square is a coin toss
    that no processor predicts.
    """
    item_rc, item_node = state.item_rc, state.item_node
    rows, cols = water.rows, water.cols
    for e in range(active.size):
        n_gone[e] = 0
        if not active[e]:
            continue
        key, now, n = stream_key(keys[e], Stream.NOISE), step[e], 0
        drift_row, drift_col = drift_rc[e, 0], drift_rc[e, 1]
        for k in range(item_node.shape[1]):
            node = item_node[e, k]
            if node < 0:
                continue
            noise_row, noise_col = item_noise(key, k, now)
            row = item_rc[e, k, 0] + (drift_row + noise * noise_row)
            col = item_rc[e, k, 1] + (drift_col + noise * noise_col)
            item_rc[e, k, 0], item_rc[e, k, 1] = row, col
            gone[e, n] = k
            n += int((abs(row - rows[node]) >= 0.5) | (abs(col - cols[node]) >= 0.5))
        n_gone[e] = n


@kernel
def _settle(
    water: Water,
    walls: int,
    state: Transition,
    gone: Int32Array,
    n_gone: Int32Array,
    items_in_node: NDArray[np.int16],
) -> None:
    """Give every item that left its node the node it is in, or push it back into the water."""
    item_rc, item_node = state.item_rc, state.item_node
    framed, rows, cols = water
    height, width = framed.shape[0] - 2, framed.shape[1] - 2
    for e in range(n_gone.size):
        for i in range(n_gone[e]):
            k = gone[e, i]
            before, after = int(item_node[e, k]), -1
            row, col = item_rc[e, k, 0], item_rc[e, k, 1]
            off_row, off_col = abs(row - rows[before]), abs(col - cols[before])
            squared = off_row * off_row + off_col * off_col
            inside = (row >= -0.5) & (row < height - 0.5) & (col >= -0.5) & (col < width - 0.5)
            if inside:
                after = int(framed[np.uint64(row + 1.5), np.uint64(col + 1.5)])
            within = (row >= 0.0) & (row <= height - 1.0) & (col >= 0.0) & (col <= width - 1.0)
            if after < 0 and within and squared < 1.0:
                # On a quay less than a node away: only the four centres around can be nearest.
                after, r, c = before, rows[before] + 1, cols[before] + 1  # framed: one more
                down, right = 2 * (row >= r - 1) - 1, 2 * (col >= c - 1) - 1
                for at_row, at_col in ((1, 0), (0, 1), (1, 1)):
                    node = framed[np.uint64(r + at_row * down), np.uint64(c + at_col * right)]
                    there = (at_row - off_row) ** 2 + (at_col - off_col) ** 2
                    nearer = (there < squared) | ((there == squared) & (node < after))
                    nearer = nearer & (node >= 0)
                    after = int(node) if nearer else after
                    squared = there if nearer else squared
                row, col = put_back(walls, row, col, rows[after], cols[after])
            elif after < 0:
                row, col, after = into_water(water, walls, row, col)
            item_rc[e, k, 0], item_rc[e, k, 1] = row, col
            if after != before:
                items_in_node[e, before] -= 1
                items_in_node[e, after] += 1
                item_node[e, k] = after


class ItemRule:
    """Items of a batch of episodes, moved by the paper's rule."""

    def __init__(self, graph: NavigationGraph, fleet: Fleet, noise: float, walls: str) -> None:
        """Prepare.

        Parameters
        ----------
        noise : half width of the drift's random part [node/step]
        walls : of `WALLS`, what becomes of items that drift onto land
        """
        self._graph, self._fleet, self._noise = graph, fleet, noise
        self._walls = WALLS.index(walls)

    def reset(self, initial: InitialState, keys: UInt64Array) -> None:
        """Start a batch of episodes."""
        episodes, items = initial.item_node.shape
        self._keys, self._drift_rc = keys, initial.drift_rc
        self.room_left = np.tile(self._fleet.capacity, (episodes, 1))  # (episode, agent) items
        self._items_in_node = np.zeros((episodes, len(self._graph)), np.int16)
        self._gone = np.empty((episodes, items), np.int32)
        self._n_gone = np.empty(episodes, np.int32)
        present = initial.item_node >= 0
        np.add.at(self._items_in_node, (np.nonzero(present)[0], initial.item_node[present]), 1)

    def adopt(self, rows: NDArray[np.int64], other: "ItemRule") -> None:
        """Replace episodes (row,) of the batch by those of another one."""
        for name in ("_keys", "_drift_rc", "room_left", "_items_in_node", "_gone", "_n_gone"):
            setattr(self, name, put_rows(getattr(self, name), rows, getattr(other, name)))

    def advance(self, active: NDArray[np.bool_], step: Int32Array, state: Transition) -> None:
        """One step once all have moved: collect, then drift."""
        collects, water = self._fleet.collects, self._graph.water
        collect(active, collects, self.room_left, self._items_in_node, state)
        _drift(
            active,
            step,
            self._keys,
            self._drift_rc,
            self._noise,
            water,
            state,
            self._gone,
            self._n_gone,
        )
        _settle(water, self._walls, state, self._gone, self._n_gone, self._items_in_node)
