"""Particle swarm: every agent has a velocity, pulled to two places, and takes the nearest compass
move.

Velocity = inertia x velocity + sum of weight x uniform x (place - position) (scenario section 3):
scouts are pulled with 0.5 to the best node they have seen themselves and with 3.27 to the most idle
node, foragers with 2 to the node with most known items and with 3 to the nearest known item. Among
equal places the one nearest to the agent as the crow flies is taken. Inertia: Clerc and Kennedy,
"The particle swarm", IEEE Trans. Evolutionary Computation 6, 2002.
"""

import numpy as np
from numpy.typing import NDArray

from graph_planner.compiled import kernel
from graph_planner.geodesics import Int32Array
from graph_planner.navigation import OFFSETS, STAY
from graph_planner.policies.registry import register
from graph_planner.randomness import Stream, UInt64Array, stream_key, uniform
from graph_planner.task import Observation, Task

INERTIA = 0.7298
OWN_BEST_WEIGHT, IDLEST_WEIGHT = 0.5, 3.27
RICHEST_WEIGHT, NEAREST_WEIGHT = 2.0, 3.0
NOWHERE = -1


@kernel
def _best_place(
    values: NDArray[np.float64], nodes: Int32Array, rows: Int32Array, cols: Int32Array, node: int
) -> int:
    """Entry of `nodes` with the largest value, the nearest of them to `node`; -1 if empty."""
    best, best_value, best_squared = NOWHERE, -np.inf, 0
    for i in range(nodes.size):
        if values[i] < best_value:
            continue
        d_row, d_col = rows[nodes[i]] - rows[node], cols[nodes[i]] - cols[node]
        squared = d_row * d_row + d_col * d_col
        if values[i] > best_value or squared < best_squared:
            best, best_value, best_squared = i, values[i], squared
    return best


@kernel
def _remember_best(
    belief: NDArray[np.int16], seen: Int32Array, best_node: Int32Array, best_items: Int32Array
) -> None:
    """Keep the node with most items that the agent has seen itself (one episode, one agent)."""
    for node in seen:
        if belief[node] > best_items[0]:
            best_items[0], best_node[0] = belief[node], node


@kernel
def _pull(
    velocity: NDArray[np.float64],
    weight: float,
    place: int,
    node: int,
    rows: Int32Array,
    cols: Int32Array,
) -> None:
    if place >= 0:
        velocity[0] += weight * (rows[place] - rows[node])
        velocity[1] += weight * (cols[place] - cols[node])


@kernel
def _swarm(
    active: NDArray[np.bool_],
    keys: UInt64Array,
    step: Int32Array,
    agent_node: Int32Array,
    belief: NDArray[np.int16],
    last_seen: NDArray[np.int16],
    known: Int32Array,
    n_known: Int32Array,
    rows: Int32Array,
    cols: Int32Array,
    view_start: NDArray[np.int64],
    view_nodes: Int32Array,
    radius_number: NDArray[np.int64],
    collects: NDArray[np.bool_],
    full_after: int,
    velocity: NDArray[np.float64],
    best_node: Int32Array,
    best_items: Int32Array,
    preferences: NDArray[np.float64],
) -> None:
    n_nodes = rows.size
    everywhere = np.arange(n_nodes).astype(np.int32)
    values = np.empty(n_nodes)
    for e in range(active.size):
        if not active[e]:
            continue
        key = stream_key(keys[e], Stream.POLICY)
        for a in range(agent_node.shape[1]):
            node, radius = agent_node[e, a], radius_number[a]
            first, second = uniform(key, 4 * a, step[e]), uniform(key, 4 * a + 1, step[e])
            velocity[e, a] *= INERTIA
            if collects[a]:
                items = known[e, : n_known[e]]
                for i in range(items.size):
                    values[i] = belief[e, items[i]]
                richest = _best_place(values, items, rows, cols, node)
                values[: items.size] = 0.0
                nearest = _best_place(values, items, rows, cols, node)
                if richest >= 0:
                    _pull(velocity[e, a], RICHEST_WEIGHT * first, items[richest], node, rows, cols)
                    _pull(velocity[e, a], NEAREST_WEIGHT * second, items[nearest], node, rows, cols)
            else:
                seen = view_nodes[view_start[radius, node] : view_start[radius, node + 1]]
                _remember_best(belief[e], seen, best_node[e, a : a + 1], best_items[e, a : a + 1])
                for i in range(n_nodes):
                    values[i] = min(full_after, step[e] - 1 - np.int64(last_seen[e, i]))
                idlest = _best_place(values, everywhere, rows, cols, node)
                _pull(velocity[e, a], OWN_BEST_WEIGHT * first, best_node[e, a], node, rows, cols)
                _pull(velocity[e, a], IDLEST_WEIGHT * second, idlest, node, rows, cols)
            speed = np.sqrt(velocity[e, a, 0] ** 2 + velocity[e, a, 1] ** 2)
            for d in range(8):
                norm = np.sqrt(OFFSETS[d, 0] ** 2 + OFFSETS[d, 1] ** 2)
                along = velocity[e, a, 0] * OFFSETS[d, 0] + velocity[e, a, 1] * OFFSETS[d, 1]
                tie = 1e-6 * uniform(key, 1_000_000 + 9 * a + d, step[e])
                preferences[e, a, d] = tie + (along / (norm * speed) if speed > 1e-9 else 0.0)
            preferences[e, a, STAY] = -2.0


@register("pso")
class PsoPolicy:
    """Particle swarm: velocities pulled to idle nodes (scouts) and known items (foragers)."""

    def reset(self, task: Task, keys: UInt64Array) -> None:
        """Get ready for a batch of episodes (episode,)."""
        self._task = task
        self._radius_number = task.radius_number
        agents = (keys.size, len(task.fleet))
        self._velocity = np.zeros((*agents, 2))
        self._best_node = np.full(agents, NOWHERE, np.int32)
        self._best_items = np.zeros(agents, np.int32)
        self._preferences = np.zeros((*agents, 9))

    def act(self, observation: Observation) -> NDArray[np.float64]:
        """Preferences (episode, agent, 9): cosine between the velocity and each move."""
        task = self._task
        _swarm(
            observation.active,
            observation.keys,
            observation.step,
            observation.agent_node,
            observation.belief,
            observation.last_seen,
            observation.known,
            observation.n_known,
            task.graph.rows,
            task.graph.cols,
            task.views.start,
            task.views.nodes,
            self._radius_number,
            task.fleet.collects,
            int(np.ceil(1.0 / task.forgetting)),
            self._velocity,
            self._best_node,
            self._best_items,
            self._preferences,
        )
        return self._preferences
