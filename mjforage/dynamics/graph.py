"""Graph dynamics: an agent is in its target node after every decision, items drift by the paper's
rule.

Order (scenario section 1): all move; foragers remove every item in their node; the rest drift by a
constant vector plus independent noise per item and step.
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.fleet import Fleet
from graph_planner.geodesics import Int32Array
from graph_planner.moves import Moves, move_length
from graph_planner.navigation import OFFSETS, STAY, NavigationGraph, Water
from graph_planner.randomness import Stream, UInt64Array, stream_key
from mjforage.dynamics import ARRIVED, BLOCKED, Transition
from mjforage.scenario import Weather
from mjforage.world import INSET, World, into_water, item_noise


@kernel
def _move(
    active: NDArray[np.bool_],
    moves: Moves,
    centres: NDArray[np.float64],
    yaws: NDArray[np.float64],
    state: Transition,
) -> None:
    """Put every agent into its target node; distance, energy and speed follow from the move."""
    direction, target, steps, blocked = moves
    agent_node, agent_rc, yaw = state.agent_node, state.agent_rc, state.agent_yaw
    speed, outcome = state.agent_speed, state.outcome
    distance, energy = state.distance, state.energy
    for e in range(active.size):
        if not active[e]:
            continue
        for a in range(agent_node.shape[1]):
            length = move_length(direction[e, a], steps[e, a])
            node = target[e, a]
            agent_node[e, a] = node
            agent_rc[e, a, 0], agent_rc[e, a, 1] = centres[node, 0], centres[node, 1]
            if direction[e, a] != STAY:
                yaw[e, a] = yaws[direction[e, a]]
            speed[e, a] = length
            outcome[e, a] = BLOCKED if blocked[e, a] else ARRIVED
            distance[e, a] += length
            energy[e, a] += length


@kernel
def _collect(
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
                row = min(max(row, rows[after] - INSET), rows[after] + INSET)
                col = min(max(col, cols[after] - INSET), cols[after] + INSET)
            elif after < 0:
                row, col, after = into_water(water, row, col)
            item_rc[e, k, 0], item_rc[e, k, 1] = row, col
            if after != before:
                items_in_node[e, before] -= 1
                items_in_node[e, after] += 1
                item_node[e, k] = after


class GraphDynamics:
    """The paper's world. Distances and energy are in node lengths."""

    def __init__(self, graph: NavigationGraph, fleet: Fleet, weather: Weather) -> None:
        self._graph, self._fleet, self._weather = graph, fleet, weather
        self._centres = np.stack((graph.rows, graph.cols), axis=1).astype(np.float64)
        self._yaw = np.arctan2(-OFFSETS[:, 0], OFFSETS[:, 1]).astype(np.float64)

    def reset(self, world: World, keys: UInt64Array) -> Transition:
        """Start a batch of episodes and return their state at step 0."""
        episodes, items = world.item_node.shape
        agents = (episodes, len(self._fleet))
        self._keys, self._drift_rc = keys, world.drift_rc
        self._room_left = np.tile(self._fleet.capacity, (episodes, 1))
        self._items_in_node = np.zeros((episodes, len(self._graph)), np.int16)
        self._gone = np.empty((episodes, items), np.int32)
        self._n_gone = np.empty(episodes, np.int32)
        present = world.item_node >= 0
        np.add.at(self._items_in_node, (np.nonzero(present)[0], world.item_node[present]), 1)
        self._state = Transition(
            agent_node=world.agent_node.copy(),
            agent_rc=self._centres[world.agent_node],
            agent_yaw=np.zeros(agents),
            agent_speed=np.zeros(agents),
            outcome=np.full(agents, ARRIVED, np.int8),
            item_rc=world.item_rc.copy(),
            item_node=world.item_node.copy(),
            collected_by=np.full((episodes, items), -1, np.int16),
            distance=np.zeros(agents),
            energy=np.zeros(agents),
            collisions=np.zeros(agents, np.int32),
        )
        return self._state

    def advance(self, active: NDArray[np.bool_], step: Int32Array, moves: Moves) -> Transition:
        """Carry out one decision: move, collect, drift. Inactive episodes do not change."""
        state, fleet = self._state, self._fleet
        _move(active, moves, self._centres, self._yaw, state)
        _collect(active, fleet.collects, self._room_left, self._items_in_node, state)
        _drift(
            active,
            step,
            self._keys,
            self._drift_rc,
            self._weather.noise_node_per_step,
            self._graph.water,
            state,
            self._gone,
            self._n_gone,
        )
        _settle(self._graph.water, state, self._gone, self._n_gone, self._items_in_node)
        return state
